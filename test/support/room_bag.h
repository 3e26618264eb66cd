// A bag of a drive through a room, generated for every test, without noise.
#pragma once

#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_msgs/TFMessage.h>

#include <cmath>
#include <limits>
#include <string>

#include "racecar_mcl/geometry/pose2.h"
#include "ros/conversions/message_conversions.h"

namespace racecar_mcl {

/// A room of 6 x 4 m whose lower-left inner corner is the map's origin, with a step in one wall so
/// that the map is unambiguous. The car drives along x at 1 m/s and turns slightly.
struct RoomDrive {
  double start_time = 1500000000.0;  ///< s
  double seconds = 4.0;
  double begin = 0.0;  ///< s of the drive, from where the bag records
  Pose2 laser_in_base{0.25, 0.0, 0.0};
  std::string frame_prefix;  ///< "/" for the frame names of old drivers
  bool transforms = true;
  bool truth = true;
  bool odometry_as_tf = false;  ///< not as a topic
};

constexpr double kRoomResolution = 0.05;  // m

/// Distance from a point inside the room along a direction to its wall, m.
inline double rangeInRoom(double x, double y, double yaw) {
  const double c = std::cos(yaw), s = std::sin(yaw);
  double range = std::numeric_limits<double>::infinity();
  const auto wall = [&](double t, double low, double high, double across) {
    if (t > 1e-9 && across >= low && across <= high) range = std::min(range, t);
  };
  wall((6.0 - x) / c, 0.0, 3.0, y + s * (6.0 - x) / c);
  wall((4.5 - x) / c, 3.0, 4.0, y + s * (4.5 - x) / c);
  wall((0.0 - x) / c, 0.0, 4.0, y + s * (0.0 - x) / c);
  wall((0.0 - y) / s, 0.0, 6.0, x + c * (0.0 - y) / s);
  wall((4.0 - y) / s, 0.0, 4.5, x + c * (4.0 - y) / s);
  wall((3.0 - y) / s, 4.5, 6.0, x + c * (3.0 - y) / s);
  return range;
}

/// The room as a PGM of map_server; the outermost ring of cells is the wall.
inline std::string roomPgm() {
  const int width = 122, height = 82;
  std::string image = "P5 122 82 255\n";
  for (int row = height - 1; row >= 0; --row) {
    for (int column = 0; column < width; ++column) {
      const double x = (column - 0.5) * kRoomResolution;
      const double y = (row - 0.5) * kRoomResolution;
      const bool inside = x > 0.0 && x < 6.0 && y > 0.0 && y < 4.0 && !(x > 4.5 && y > 3.0);
      image += inside ? static_cast<char>(254) : static_cast<char>(0);
    }
  }
  return image;
}

inline std::string roomYaml() {
  return "image: room.pgm\nresolution: 0.05\norigin: [-0.05, -0.05, 0.0]\nnegate: 0\n"
         "occupied_thresh: 0.65\nfree_thresh: 0.196\n";
}

/// The true pose of the car after `seconds`.
inline Pose2 poseInRoom(double seconds) {
  return compose({0.8, 1.0, 0.1}, integrate({1.0, 0.0, 0.1}, seconds));
}

inline void writeRoomBag(const std::string& path, const RoomDrive& drive) {
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  const auto timeOf = [&](double seconds) { return ros::Time(drive.start_time + seconds); };
  if (drive.transforms) {
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    message.transforms[0].header.stamp = timeOf(drive.begin);
    message.transforms[0].header.frame_id = drive.frame_prefix + "base_link";
    message.transforms[0].child_frame_id = drive.frame_prefix + "laser";
    message.transforms[0].transform = toTransform(drive.laser_in_base);
    bag.write("/tf_static", timeOf(drive.begin), message);
  }
  for (int tick = static_cast<int>(std::lround(drive.begin * 50.0));
       tick <= std::lround(drive.seconds * 50.0); ++tick) {
    const double seconds = tick / 50.0;
    const ros::Time now = timeOf(seconds);
    const Pose2 base_in_map = poseInRoom(seconds);
    if (tick % 5 == 0) {  // written before the odometry of the same time, on purpose
      sensor_msgs::LaserScan scan;
      scan.header.stamp = now;
      scan.header.frame_id = drive.frame_prefix + "laser";
      scan.angle_min = -2.3f;
      scan.angle_increment = 0.02f;
      scan.range_min = 0.05f;
      scan.range_max = 10.0f;
      const Pose2 laser_in_map = compose(base_in_map, drive.laser_in_base);
      for (int beam = 0; beam < 231; ++beam) {
        const double bearing = -2.3 + 0.02 * beam;
        scan.ranges.push_back(static_cast<float>(
            rangeInRoom(laser_in_map.x, laser_in_map.y, laser_in_map.yaw + bearing)));
      }
      scan.angle_max = scan.angle_min + 230 * scan.angle_increment;
      bag.write("/scan", now, scan);
    }
    nav_msgs::Odometry odometry;
    odometry.header.stamp = now;
    odometry.header.frame_id = drive.frame_prefix + "odom";
    odometry.child_frame_id = drive.frame_prefix + "base_link";
    odometry.pose.pose = toMessage(integrate({1.0, 0.0, 0.1}, seconds));
    odometry.twist.twist.linear.x = 1.0;
    odometry.twist.twist.angular.z = 0.1;
    if (drive.odometry_as_tf) {
      tf2_msgs::TFMessage message;
      message.transforms.resize(1);
      message.transforms[0].header = odometry.header;
      message.transforms[0].child_frame_id = odometry.child_frame_id;
      message.transforms[0].transform = toTransform(integrate({1.0, 0.0, 0.1}, seconds));
      bag.write("/tf", now, message);
    } else {
      bag.write("/vesc/odom", now, odometry);
    }
    if (drive.truth) {
      odometry.header.frame_id = drive.frame_prefix + "map";
      odometry.pose.pose = toMessage(base_in_map);
      bag.write("/ground_truth/odom", now, odometry);
    }
  }
}

}  // namespace racecar_mcl
