// Lidar extrinsics (pose of the lidar on the car) from tf.
#pragma once

#include <ros/node_handle.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <string>
#include <vector>

#include "racecar_mcl/scan/scan.h"
#include "ros/conversions/message_conversions.h"
#include "ros/localization/node_parameters.h"

namespace racecar_mcl {

class LidarExtrinsicsLookup {
 public:
  /// Subscribes to tf through `tf_node`; its callback queue must be processed by the caller.
  LidarExtrinsicsLookup(const ros::NodeHandle& tf_node, const NodeParameters& parameters);

  /// The newest pose of `laser_frame` on the car; does not wait.
  ///
  /// The reference is particle_filter_frame, or, if that frame is not part of the car's tf tree
  /// (such as base_link_pf beside a simulator's base_link), `odometry_frame`, the odometry's child
  /// frame. Transforms through the map or odometry frame are excluded: they contain the car's
  /// motion. Throws MessageError if there is no such transform or the lidar is tilted out of the
  /// plane.
  LidarExtrinsics find(const std::string& laser_frame, const std::string& odometry_frame) const;

  /// The newest transform from a sensor's frame to the car, as above.
  geometry_msgs::Transform transform(const std::string& sensor_frame,
                                     const std::string& odometry_frame) const;

 private:
  bool isRigid(const std::string& base_frame, const std::string& sensor_frame) const;

  std::string base_frame_;
  std::vector<std::string> world_frames_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
};

}  // namespace racecar_mcl
