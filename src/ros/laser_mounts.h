// Where lidars sit on the car, from tf.
#pragma once

#include <ros/node_handle.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <string>
#include <vector>

#include "racecar_mcl/scan.h"
#include "ros/conversions.h"
#include "ros/node_parameters.h"

namespace racecar_mcl {

class LaserMounts {
 public:
  /// Hears tf through `tf_node`, whenever somebody calls what waits in its callback queue.
  LaserMounts(const ros::NodeHandle& tf_node, const NodeParameters& parameters);

  /// The mount of the lidar whose scans come in `laser_frame`, as tf has it now; it does not wait.
  ///
  /// A mount is measured from particle_filter_frame. Where that is only a name for the estimate
  /// (base_link_pf beside a simulator's base_link), it is measured from `odometry_frame`, the
  /// odometry's child frame. A way through the map or odometry frame is no mount: it would hold the
  /// car's own motion. Throws MessageError where tf knows no mount or it is none in the plane.
  LaserMount find(const std::string& laser_frame, const std::string& odometry_frame) const;

 private:
  std::vector<std::string> carriersOf(std::string frame) const;
  bool isRigid(const std::string& base_frame, const std::string& laser_frame) const;

  std::string base_frame_;
  std::vector<std::string> world_frames_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
};

}  // namespace racecar_mcl
