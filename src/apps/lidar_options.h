// The option --laser-pose of the programs that read bags.
#pragma once

#include <string>

#include "offline/bag_reader.h"
#include "ros/localization/node_parameters.h"

namespace racecar_mcl {

/// The lidar's pose from --laser-pose ("x y yaw"), or from the bag's tf if that is empty. Throws
/// ParameterError, BagError, or MessageError if it is not on a car.
inline LidarExtrinsics lidarExtrinsics(const std::string& laser_pose, const BagReader& bags,
                                       const std::string& scan_topic,
                                       const std::string& base_frame) {
  if (laser_pose.empty()) return bags.lidarExtrinsics(scan_topic, base_frame);
  const Pose2 laser_in_base = parsePose("--laser-pose", laser_pose);
  requireOnCar(laser_in_base);
  return {laser_in_base, false};
}

}  // namespace racecar_mcl
