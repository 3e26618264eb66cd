// A car that drives circles in the test room, and its messages.
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/LaserScan.h>

#include <limits>
#include <string>
#include <vector>

#include "racecar_mcl/geometry/pose2.h"
#include "ros/conversions/message_conversions.h"
#include "sim/world.h"
#include "support/test_room.h"

namespace racecar_mcl {

class SyntheticCar {
 public:
  std::string laser_frame = "laser";
  std::string base_frame = "base_link";
  std::string odom_frame = "odom";
  LidarExtrinsics extrinsics{{0.25, 0.05, 0.1}, false};
  Twist2 twist{1.0, 0.0, 1.0};  ///< a circle of 1 m around the centre of the room
  double range_max = 10.0;
  std::vector<sim::Obstacle> obstacles;  ///< unmapped, in the map frame

  explicit SyntheticCar(double stamp) : stamp_(stamp) {}

  double stamp() const { return stamp_; }
  void setStamp(double stamp) { stamp_ = stamp; }
  const Pose2& baseInMap() const { return base_in_map_; }
  void place(const Pose2& base_in_map) { base_in_map_ = base_in_map; }

  void advance(double seconds) {
    stamp_ += seconds;
    base_in_map_ = compose(base_in_map_, integrate(twist, seconds));
    base_in_odom_ = compose(base_in_odom_, integrate(twist, seconds));
  }

  nav_msgs::Odometry odometry() const {
    nav_msgs::Odometry message;
    message.header.stamp = ros::Time(stamp_);
    message.header.frame_id = odom_frame;
    message.child_frame_id = base_frame;
    message.pose.pose = toMessage(base_in_odom_);
    message.twist.twist.linear.x = twist.vx;
    message.twist.twist.linear.y = twist.vy;
    message.twist.twist.angular.z = twist.wz;
    return message;
  }

  geometry_msgs::TransformStamped baseInOdom() const {
    geometry_msgs::TransformStamped transform;
    transform.header.stamp = ros::Time(stamp_);
    transform.header.frame_id = odom_frame;
    transform.child_frame_id = base_frame;
    transform.transform = toTransform(base_in_odom_);
    return transform;
  }

  geometry_msgs::TransformStamped laserInBase() const {
    geometry_msgs::TransformStamped transform;
    transform.header.frame_id = base_frame;
    transform.child_frame_id = laser_frame;
    transform.transform = toTransform(extrinsics.laser_in_base);
    if (extrinsics.upside_down) {  // rotated by its yaw, then by pi about its x axis
      const geometry_msgs::Quaternion yaw = transform.transform.rotation;
      transform.transform.rotation.x = yaw.w;
      transform.transform.rotation.y = yaw.z;
      transform.transform.rotation.z = 0.0;
      transform.transform.rotation.w = 0.0;
    }
    return transform;
  }

  /// All beams at once, from the exact ray casting of the simulated world.
  sensor_msgs::LaserScan scan(int beams = 271) const {
    sensor_msgs::LaserScan message;
    message.header.stamp = ros::Time(stamp_);
    message.header.frame_id = laser_frame;
    message.angle_min = -2.35f;
    message.angle_max = 2.35f;
    message.angle_increment = 4.7f / static_cast<float>(beams - 1);
    message.range_min = 0.05f;
    message.range_max = static_cast<float>(range_max);
    const Pose2 laser = compose(base_in_map_, extrinsics.laser_in_base);
    for (int i = 0; i < beams; ++i) {
      const double bearing =
          static_cast<double>(message.angle_min) + i * static_cast<double>(message.angle_increment);
      const double yaw = laser.yaw + (extrinsics.upside_down ? -bearing : bearing);
      message.ranges.push_back(static_cast<float>(
          world_.cast({laser.x, laser.y}, yaw, range_max, obstacles, stamp_).range));
    }
    return message;
  }

 private:
  sim::World world_{testRoom()};
  double stamp_;
  Pose2 base_in_map_ = compose(roomInMap(), {4.0, 2.0, 0.0});
  Pose2 base_in_odom_{10.0, -3.0, 2.0};
};

}  // namespace racecar_mcl
