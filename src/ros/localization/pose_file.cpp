#include "ros/localization/pose_file.h"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <limits>
#include <set>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "racecar_mcl/common/printable.h"
#include "racecar_mcl/scan/scan.h"

namespace racecar_mcl {
namespace {

// An odometry pose that has moved faster was reset, or belongs to another time.
constexpr double kMaxSpeed = 15.0;  // m/s, above that of a 1/10-scale car
// After a restart of the odometry its pose is about zero.
constexpr double kResetDistance = 0.5;  // m
// Standard deviations of the resumed pose, and their growth per metre driven.
constexpr double kPositionSigma = 0.1;           // m
constexpr double kPositionSigmaPerMetre = 0.05;  // m/m
constexpr double kYawSigma = 0.05;               // rad
constexpr double kYawSigmaPerMetre = 0.02;       // rad/m

void writePose(const char* name, const Pose2& pose, std::ostream* out) {
  *out << name << ": [" << pose.x << ", " << pose.y << ", " << pose.yaw << "]\n";
}

Pose2 readPose(const YAML::Node& node) {
  if (!node.IsSequence() || node.size() != 3) throw std::runtime_error("a pose has 3 numbers");
  const Pose2 pose{node[0].as<double>(), node[1].as<double>(), node[2].as<double>()};
  if (!isFinite(pose)) throw std::runtime_error("a pose is not finite");
  return pose;
}

/// Calls visit(key, number) for each number of the calibration, except those of lidars.
template <typename Calibration, typename Visitor>
void visitNumbers(Calibration& sensors, const Visitor& visit) {
  visit("distance_scale", sensors.odometry.distance_scale);
  visit("odometry_delay", sensors.odometry.delay);
  visit("turn_scale", sensors.odometry.turn.scale);
  visit("turn_offset", sensors.odometry.turn.offset);
  visit("turn_delay", sensors.odometry.turn.delay);
}

std::string quoted(const std::string& text) {
  YAML::Emitter emitter;
  emitter << YAML::DoubleQuoted << text;
  return emitter.c_str();
}

void writeCalibration(const SavedPose& pose, std::ostream* out) {
  *out << "calibration:\n";
  visitNumbers(*pose.sensors, [&](const char* key, double number) {
    *out << "  " << key << ": " << number << '\n';
  });
  *out << "  scale_distance: " << pose.sensors->odometry.scale_distance << '\n';
  *out << "  lidars:\n";
  for (std::size_t i = 0; i < pose.lidar_frames.size(); ++i) {
    if (pose.lidar_frames[i].empty()) continue;
    const LidarCalibration& lidar = pose.sensors->lidars.at(i);
    *out << "    - {frame: " << quoted(pose.lidar_frames[i]) << ", range_bias: " << lidar.range_bias
         << ", scan_reversed: " << (lidar.scan_reversed ? "true" : "false") << "}\n";
  }
}

double readNumber(const YAML::Node& node, const char* key) {
  const double number = node[key].as<double>();
  if (!std::isfinite(number)) throw std::runtime_error(std::string(key) + " is not finite");
  return number;
}

LidarCalibration readLidar(const YAML::Node& node) {
  return {readNumber(node, "range_bias"), node["scan_reversed"].as<bool>()};
}

void readSensors(const YAML::Node& node, SavedPose* pose) {
  SensorCalibration& sensors = pose->sensors.emplace();
  visitNumbers(sensors, [&](const char* key, double& number) { number = readNumber(node, key); });
  // Files of earlier versions do not have it.
  if (node["scale_distance"]) {
    sensors.odometry.scale_distance = readNumber(node, "scale_distance");
  }
  if (!node["lidars"]) {
    sensors.lidars.push_back(readLidar(node));
    return;
  }
  std::set<std::string> frames;
  for (const YAML::Node& lidar : node["lidars"]) {
    sensors.lidars.push_back(readLidar(lidar));
    const std::string frame = lidar["frame"].as<std::string>();
    if (frame.empty() || !frames.insert(frame).second ||
        frames.size() > static_cast<std::size_t>(kMaxLidars)) {
      throw std::runtime_error("the frame '" + printable(frame) +
                               "' is empty, there twice, or that of a ninth lidar");
    }
    pose->lidar_frames.push_back(frame);
  }
}

void readCalibration(const YAML::Node& node, SavedPose* pose) {
  try {
    readSensors(node, pose);
  } catch (const std::exception& error) {
    pose->sensors.reset();
    pose->lidar_frames.clear();
    pose->calibration_problem = error.what();
  }
}

}  // namespace

std::string mapIdentity(const GridGeometry& geometry) {
  std::ostringstream text;
  text << geometry.width << " x " << geometry.height << " cells of " << geometry.resolution
       << " m, origin " << geometry.origin.x << " " << geometry.origin.y << " "
       << geometry.origin.yaw;
  return text.str();
}

void writePoseFile(const std::string& path, const SavedPose& pose) {
  const std::string draft = path + ".new";
  std::ofstream file(draft);
  file << "# The last pose of racecar_mcl: x (m), y (m), yaw (rad); the calibration in m, s and "
          "rad.\n"
       << std::setprecision(std::numeric_limits<double>::max_digits10) << "map: " << pose.map
       << '\n';
  writePose("base_in_map", pose.base_in_map, &file);
  if (pose.odometry) {
    writePose("base_in_odom", pose.odometry->base_in_odom, &file);
    file << "odometry_stamp: " << pose.odometry->stamp << '\n';
  }
  if (pose.sensors) writeCalibration(pose, &file);
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(draft, path, error);
  if (!file || error) throw std::runtime_error("the last pose cannot be written to " + path);
}

std::optional<SavedPose> readPoseFile(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return std::nullopt;
  try {
    const YAML::Node file = YAML::LoadFile(path);
    SavedPose pose;
    pose.map = file["map"].as<std::string>();
    pose.base_in_map = readPose(file["base_in_map"]);
    if (file["base_in_odom"]) {
      pose.odometry = {file["odometry_stamp"].as<double>(), readPose(file["base_in_odom"])};
    }
    if (file["calibration"]) readCalibration(file["calibration"], &pose);
    return pose;
  } catch (const std::exception& error) {
    throw std::runtime_error("the last pose cannot be read from " + path + ": " + error.what());
  }
}

PoseEstimate resumedPose(const SavedPose& saved, const std::optional<OdometryPose>& now) {
  PoseEstimate start{saved.base_in_map, Eigen::Matrix3d::Zero()};
  if (!saved.odometry || !now) return start;
  const double elapsed = now->stamp - saved.odometry->stamp;
  const Pose2& before = saved.odometry->base_in_odom;
  const double driven = distance(before, now->base_in_odom);
  const bool is_reset =
      distance(now->base_in_odom, {}) < kResetDistance && driven > 2.0 * kResetDistance;
  if (elapsed < 0.0 || is_reset || driven > kResetDistance + kMaxSpeed * elapsed) return start;
  start.base_in_map = compose(saved.base_in_map, compose(inverse(before), now->base_in_odom));
  const double position = kPositionSigma + kPositionSigmaPerMetre * driven;
  const double yaw = kYawSigma + kYawSigmaPerMetre * driven;
  start.covariance.diagonal() << position * position, position * position, yaw * yaw;
  return start;
}

}  // namespace racecar_mcl
