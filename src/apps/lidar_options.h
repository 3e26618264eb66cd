// The option --laser-pose of the programs that read bags.
#pragma once

#include <functional>
#include <map>
#include <optional>
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

/// The pose of each lidar by its frame, from --laser-pose, which is that of one lidar, or from the
/// bag's tf, which is read once for each frame. The bags must outlive the function. Throws as
/// lidarExtrinsics, now or when called.
inline std::function<LidarExtrinsics(const std::string& frame)> lidarExtrinsicsByFrame(
    const std::string& laser_pose, const BagReader& bags, const std::string& base_frame) {
  if (laser_pose.empty()) {
    return [&bags, base_frame,
            known = std::map<std::string, LidarExtrinsics>()](const std::string& frame) mutable {
      const auto found = known.find(frame);
      if (found != known.end()) return found->second;
      return known[frame] = bags.extrinsicsOf(frame, base_frame);
    };
  }
  return [extrinsics = lidarExtrinsics(laser_pose, bags, "", base_frame),
          first = std::optional<std::string>()](const std::string& frame) mutable {
    if (!first) first = frame;
    if (frame == *first) return extrinsics;
    throw BagError("--laser-pose is the pose of one lidar; the scans have the frames '" +
                   printable(*first) + "' and '" + printable(frame) + "'");
  };
}

}  // namespace racecar_mcl
