#include "ros/conversions/map_conversions.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <sstream>

#include "racecar_mcl/common/errors.h"
#include "ros/conversions/message_conversions.h"

namespace racecar_mcl {
namespace {

// Above the rounding error of a planar quaternion; shortens 100 m by 50 um only.
constexpr double kMaxMapTilt = 1e-3;  // rad

Pose2 originOf(const geometry_msgs::Pose& pose) {
  Pose2 origin;
  try {
    origin = toPose2(pose);
  } catch (const MessageError& e) {
    throw MapError(std::string("the map's origin: ") + e.what());
  }
  // The sine of half the angle between the map's z axis and its frame's.
  const geometry_msgs::Quaternion& q = pose.orientation;
  const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (std::hypot(q.x, q.y) / length > std::sin(kMaxMapTilt / 2.0)) {
    std::ostringstream problem;
    problem << "the map's origin has the quaternion (" << q.x << ", " << q.y << ", " << q.z << ", "
            << q.w << "), which tilts the map; expected a rotation about z";
    throw MapError(problem.str());
  }
  return origin;
}

/// The double whose shortest decimal is that of the float: 0.05, not 0.0500000007.
double shortestDecimal(float value) {
  char text[32] = {};
  for (int digits = 6; digits <= std::numeric_limits<float>::max_digits10; ++digits) {
    std::snprintf(text, sizeof(text), "%.*g", digits, static_cast<double>(value));
    if (std::strtof(text, nullptr) == value) break;
  }
  return std::strtod(text, nullptr);
}

}  // namespace

OccupancyGrid toOccupancyGrid(const nav_msgs::OccupancyGrid& message) {
  const nav_msgs::MapMetaData& info = message.info;
  constexpr auto kMaxSize = static_cast<std::uint32_t>(std::numeric_limits<int>::max());
  if (info.width > kMaxSize || info.height > kMaxSize) {
    throw MapError("the map is " + std::to_string(info.width) + " x " +
                   std::to_string(info.height) + " cells; the maximum is 2147483647 on each side");
  }
  GridGeometry geometry;
  geometry.width = static_cast<int>(info.width);
  geometry.height = static_cast<int>(info.height);
  geometry.resolution = shortestDecimal(info.resolution);
  geometry.origin = originOf(info.origin);

  std::vector<std::int8_t> cells(message.data.begin(), message.data.end());
  for (std::int8_t& cell : cells) {
    if (cell < OccupancyGrid::kFree || cell > OccupancyGrid::kOccupied) {
      cell = OccupancyGrid::kUnknown;
    }
  }
  return OccupancyGrid(geometry, std::move(cells));
}

nav_msgs::OccupancyGrid toMessage(const OccupancyGrid& grid, const std::string& frame_id,
                                  const ros::Time& stamp) {
  const GridGeometry& geometry = grid.geometry();
  nav_msgs::OccupancyGrid message;
  message.header.frame_id = frame_id;
  message.header.stamp = stamp;
  message.info.map_load_time = stamp;
  message.info.width = static_cast<std::uint32_t>(geometry.width);
  message.info.height = static_cast<std::uint32_t>(geometry.height);
  message.info.resolution = static_cast<float>(geometry.resolution);
  message.info.origin = toMessage(geometry.origin);
  message.data.assign(grid.cells().begin(), grid.cells().end());
  return message;
}

}  // namespace racecar_mcl
