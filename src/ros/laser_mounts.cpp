#include "ros/laser_mounts.h"

#include <algorithm>

namespace racecar_mcl {

LaserMounts::LaserMounts(const ros::NodeHandle& tf_node, const NodeParameters& parameters)
    : base_frame_(parameters.particle_filter_frame),
      world_frames_{parameters.map_frame, parameters.odom_frame},
      listener_(buffer_, tf_node, false) {}

std::vector<std::string> LaserMounts::carriersOf(std::string frame) const {
  const auto is_world = [&](const std::string& name) {
    return std::find(world_frames_.begin(), world_frames_.end(), name) != world_frames_.end();
  };
  std::vector<std::string> carriers;
  while (!is_world(frame) && std::find(carriers.begin(), carriers.end(), frame) == carriers.end()) {
    carriers.push_back(frame);
    std::string parent;
    if (!buffer_._getParent(frame, ros::Time(0), parent)) break;
    frame = parent;
  }
  return carriers;
}

bool LaserMounts::isRigid(const std::string& base_frame, const std::string& laser_frame) const {
  const std::vector<std::string> of_base = carriersOf(base_frame);
  const std::vector<std::string> of_laser = carriersOf(laser_frame);
  return std::find_first_of(of_base.begin(), of_base.end(), of_laser.begin(), of_laser.end()) !=
         of_base.end();
}

LaserMount LaserMounts::find(const std::string& laser_frame,
                             const std::string& odometry_frame) const {
  if (laser_frame == base_frame_) return {};
  std::string base_frame = base_frame_;
  if (!isRigid(base_frame, laser_frame)) base_frame = odometry_frame;
  if (base_frame.empty() || !isRigid(base_frame, laser_frame)) {
    throw MessageError("tf does not say where the scan's frame '" + laser_frame + "' sits on '" +
                       base_frame_ + "'; expected a transform, from a URDF or a " +
                       "static_transform_publisher");
  }
  try {
    return toLaserMount(buffer_.lookupTransform(base_frame, laser_frame, ros::Time(0)).transform);
  } catch (const tf2::TransformException& error) {
    throw MessageError("the scan's frame '" + laser_frame + "': " + error.what());
  }
}

}  // namespace racecar_mcl
