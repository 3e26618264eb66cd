#include "evaluation/trajectory.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "racecar_mcl/common/printable.h"

namespace racecar_mcl {
namespace {

constexpr Nanoseconds kNanosecondsPerSecond = 1000000000;

/// Parses a decimal number of seconds without rounding. Throws std::invalid_argument or
/// std::out_of_range.
Nanoseconds parseStamp(const std::string& text) {
  const bool plain = text.find_first_not_of("0123456789.") == std::string::npos;
  const std::size_t point = std::min(text.find('.'), text.size());
  if (!plain || point == 0) {
    std::size_t used = 0;
    const double seconds = std::stod(text, &used);
    if (used != text.size() || !(std::abs(seconds) < 9e9)) throw std::out_of_range(text);
    return toNanoseconds(seconds);
  }
  std::string fraction = point < text.size() ? text.substr(point + 1) : "";
  if (fraction.find('.') != std::string::npos || point > 10) throw std::invalid_argument(text);
  fraction.resize(9, '0');
  const Nanoseconds seconds = std::stoll(text.substr(0, point));
  if (seconds > 9000000000) throw std::out_of_range(text);
  return seconds * kNanosecondsPerSecond + std::stoll(fraction);
}

/// Throws std::logic_error if the line is not a stamped pose.
StampedPose parseLine(const std::string& line) {
  std::istringstream fields(line);
  std::string stamp;
  double x, y, z, qx, qy, qz, qw;
  if (!(fields >> stamp >> x >> y >> z >> qx >> qy >> qz >> qw)) {
    throw std::invalid_argument(line);
  }
  const double yaw = std::atan2(2.0 * (qw * qz + qx * qy), qw * qw + qx * qx - qy * qy - qz * qz);
  const Pose2 pose{x, y, yaw};
  if (!isWithin(pose, kMaxCoordinate) || qx * qx + qy * qy + qz * qz + qw * qw < 1e-6) {
    throw std::invalid_argument(line);
  }
  return {parseStamp(stamp), pose};
}

}  // namespace

std::string formatStamp(Nanoseconds stamp) {
  char text[32];
  const Nanoseconds magnitude = std::abs(stamp);
  std::snprintf(text, sizeof(text), "%s%lld.%09lld", stamp < 0 ? "-" : "",
                static_cast<long long>(magnitude / kNanosecondsPerSecond),
                static_cast<long long>(magnitude % kNanosecondsPerSecond));
  return text;
}

std::string spanOf(const Trajectory& trajectory) {
  return "[" + formatStamp(trajectory.front().stamp) + ", " + formatStamp(trajectory.back().stamp) +
         "]";
}

Trajectory inOrder(std::vector<StampedPose> poses) {
  std::stable_sort(poses.begin(), poses.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.stamp < b.stamp; });
  const auto end =
      std::unique(poses.begin(), poses.end(),
                  [](const StampedPose& a, const StampedPose& b) { return a.stamp == b.stamp; });
  poses.erase(end, poses.end());
  return poses;
}

Trajectory readTum(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw TrajectoryError(path + ": the trajectory cannot be read");
  std::vector<StampedPose> poses;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    try {
      poses.push_back(parseLine(line));
    } catch (const std::logic_error&) {
      throw TrajectoryError(path + ", line " + std::to_string(number) + ": '" + printable(line) +
                            "' is not a pose; expected 't x y z qx qy qz qw' in s and m");
    }
  }
  if (poses.empty()) {
    throw TrajectoryError(path + ": contains no poses; expected lines of 't x y z qx qy qz qw'");
  }
  return inOrder(std::move(poses));
}

std::string tumLine(const StampedPose& pose) {
  char line[128];
  const double half_yaw = 0.5 * pose.pose.yaw;
  std::snprintf(line, sizeof(line), " %.9f %.9f 0 0 0 %.12f %.12f\n", pose.pose.x, pose.pose.y,
                std::sin(half_yaw), std::cos(half_yaw));
  return formatStamp(pose.stamp) + line;
}

void writeTum(const Trajectory& trajectory, std::ostream& out) {
  for (const StampedPose& pose : trajectory) out << tumLine(pose);
}

std::optional<Pose2> poseAt(const Trajectory& trajectory, Nanoseconds stamp, double max_gap) {
  const auto after =
      std::lower_bound(trajectory.begin(), trajectory.end(), stamp,
                       [](const StampedPose& row, Nanoseconds value) { return row.stamp < value; });
  if (after == trajectory.end()) return std::nullopt;
  if (after->stamp == stamp) return after->pose;
  if (after == trajectory.begin()) return std::nullopt;
  const StampedPose& before = *(after - 1);
  const double gap = toSeconds(after->stamp - before.stamp);
  if (gap > max_gap) return std::nullopt;
  return interpolate(before.pose, after->pose, toSeconds(stamp - before.stamp) / gap);
}

}  // namespace racecar_mcl
