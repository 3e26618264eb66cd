#include "ros/localization/lidar_extrinsics.h"

#include <algorithm>

#include "racecar_mcl/common/printable.h"
#include "ros/util/tf_ancestors.h"

namespace racecar_mcl {
namespace {

constexpr std::size_t kMaxTfError = 200;  // characters of an error of tf2, which names frames

}  // namespace

LidarExtrinsicsLookup::LidarExtrinsicsLookup(const ros::NodeHandle& tf_node,
                                             const NodeParameters& parameters)
    : base_frame_(parameters.particle_filter_frame),
      world_frames_{parameters.map_frame, parameters.odom_frame},
      listener_(buffer_, tf_node, false) {}

bool LidarExtrinsicsLookup::isRigid(const std::string& base_frame,
                                    const std::string& sensor_frame) const {
  const auto base_chain = ancestorsBelow(world_frames_, buffer_, base_frame);
  const auto sensor_chain = ancestorsBelow(world_frames_, buffer_, sensor_frame);
  return std::find_first_of(base_chain.begin(), base_chain.end(), sensor_chain.begin(),
                            sensor_chain.end()) != base_chain.end();
}

geometry_msgs::Transform LidarExtrinsicsLookup::transform(const std::string& sensor_frame,
                                                          const std::string& odometry_frame) const {
  if (sensor_frame == base_frame_) return toTransform(Pose2{});
  std::string base_frame = base_frame_;
  if (!isRigid(base_frame, sensor_frame)) base_frame = odometry_frame;
  if (base_frame.empty() || !isRigid(base_frame, sensor_frame)) {
    throw MessageError("tf has no rigid transform from '" + base_frame_ +
                       "' to the sensor's frame '" + printable(sensor_frame) +
                       "'; expected one from a URDF or a " + "static_transform_publisher");
  }
  try {
    return buffer_.lookupTransform(base_frame, sensor_frame, ros::Time(0)).transform;
  } catch (const tf2::TransformException& error) {
    throw MessageError("the sensor's frame '" + printable(sensor_frame) +
                       "': " + printable(error.what(), kMaxTfError));
  }
}

LidarExtrinsics LidarExtrinsicsLookup::find(const std::string& laser_frame,
                                            const std::string& odometry_frame) const {
  if (laser_frame.empty()) {
    throw MessageError("the scan has no frame_id; expected the frame of the lidar");
  }
  return toLidarExtrinsics(transform(laser_frame, odometry_frame));
}

}  // namespace racecar_mcl
