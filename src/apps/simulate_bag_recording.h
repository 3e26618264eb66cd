// What a simulated drive leaves behind: the bag a car would have recorded, and the truth as a TUM
// file.
#pragma once

#include <rosbag/bag.h>
#include <tf2_msgs/TFMessage.h>

#include <boost/make_shared.hpp>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>

#include "ros/simulator_messages.h"
#include "sim/simulator.h"

namespace racecar_mcl {

/// Files under their names with ".part" until `commit`: an interrupted run leaves nothing that
/// looks whole.
class Recording {
 public:
  /// Throws std::runtime_error where a file cannot be written. `truth_path` may be empty: no truth
  /// then.
  Recording(const std::string& bag_path, const std::string& truth_path,
            const sim::SimulatorParameters& parameters, double start_time)
      : bag_path_(bag_path),
        truth_path_(truth_path),
        parameters_(parameters),
        start_time_(start_time) {
    try {
      bag_.open(part(bag_path_), rosbag::bagmode::Write);
    } catch (const rosbag::BagException&) {
      throw std::runtime_error("cannot write the bag to " + bag_path_ +
                               "; expected a path in a folder that exists and can be written");
    }
    if (!truth_path_.empty()) {
      truth_ = std::fopen(part(truth_path_).c_str(), "w");
      if (truth_ == nullptr) {
        abandon();
        throw std::runtime_error("cannot write the truth to " + truth_path_ +
                                 "; expected a path in a folder that exists and can be written");
      }
    }
    writeLaserMount();
  }
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;
  ~Recording() {
    if (!committed_) abandon();
  }

  void write(const sim::Event& event) {
    const ros::Time arrival(event.arrival);
    if (const auto* sweep = std::get_if<sim::LidarScan>(&event.data)) {
      bag_.write("/scan", arrival, toMessage(*sweep, "laser"));
    } else if (const auto* sample = std::get_if<OdometrySample>(&event.data)) {
      bag_.write("/vesc/odom", arrival,
                 toMessage(*sample, parameters_.odometry, "odom", "base_link"));
      tf2_msgs::TFMessage transforms;
      transforms.transforms = {
          toTransformMessage(sample->stamp, sample->base_in_odom, "odom", "base_link")};
      bag_.write("/tf", arrival, transforms);
    } else {
      writeTruth(std::get<sim::Truth>(event.data));
    }
  }

  void commit() {
    bag_.close();
    bool written = true;
    if (truth_ != nullptr) {
      written = std::ferror(truth_) == 0;
      written &= std::fclose(std::exchange(truth_, nullptr)) == 0;
      written = written && std::rename(part(truth_path_).c_str(), truth_path_.c_str()) == 0;
    }
    written = written && std::rename(part(bag_path_).c_str(), bag_path_.c_str()) == 0;
    if (!written) throw std::runtime_error("cannot finish " + bag_path_ + ": the disk is full?");
    committed_ = true;
  }

 private:
  static std::string part(const std::string& path) { return path + ".part"; }

  void writeLaserMount() {
    tf2_msgs::TFMessage transforms;
    transforms.transforms = {
        toTransformMessage(start_time_, parameters_.lidar.laser_in_base, "base_link", "laser")};
    const auto header = boost::make_shared<ros::M_string>();
    (*header)["callerid"] = "/simulate_bag";
    (*header)["latching"] = "1";
    (*header)["topic"] = "/tf_static";
    (*header)["type"] = ros::message_traits::datatype(transforms);
    (*header)["md5sum"] = ros::message_traits::md5sum(transforms);
    (*header)["message_definition"] = ros::message_traits::definition(transforms);
    bag_.write("/tf_static", ros::Time(start_time_), transforms, header);
  }

  void writeTruth(const sim::Truth& truth) {
    bag_.write("/ground_truth/odom", ros::Time(truth.stamp),
               toOdometryMessage(truth.stamp, truth.base_in_map, truth.twist, "map", "base_link"));
    if (truth_ == nullptr) return;
    const Pose2& pose = truth.base_in_map;
    std::fprintf(truth_, "%.9f %.9f %.9f 0 0 0 %.12f %.12f\n", truth.stamp, pose.x, pose.y,
                 std::sin(pose.yaw / 2.0), std::cos(pose.yaw / 2.0));
  }

  void abandon() noexcept {
    try {
      bag_.close();
    } catch (const rosbag::BagException&) {
      // What could not be written is removed below.
    }
    if (truth_ != nullptr) std::fclose(std::exchange(truth_, nullptr));
    std::remove(part(bag_path_).c_str());
    if (!truth_path_.empty()) std::remove(part(truth_path_).c_str());
  }

  std::string bag_path_;
  std::string truth_path_;
  sim::SimulatorParameters parameters_;
  double start_time_;
  rosbag::Bag bag_;
  std::FILE* truth_ = nullptr;
  bool committed_ = false;
};

}  // namespace racecar_mcl
