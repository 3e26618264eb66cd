// The last pose and calibration of the localization node in a file, for its next start.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "racecar_mcl/filter/pose_estimate.h"
#include "racecar_mcl/localizer/sensor_calibration.h"
#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl {

/// The pose in the odometry's message, by which the motion while the node was down is known.
struct OdometryPose {
  double stamp = 0.0;  ///< s
  Pose2 base_in_odom;
};

struct SavedPose {
  std::string map;  ///< mapIdentity of the map
  Pose2 base_in_map;
  std::optional<OdometryPose> odometry;  ///< at that pose
  std::optional<SensorCalibration> sensors;
  /// Of sensors->lidars; a lidar with no or an empty frame is not saved. None in files of earlier
  /// versions, which have the calibration of one lidar.
  std::vector<std::string> lidar_frames = {};
  std::string calibration_problem = {};  ///< why the file's calibration cannot be read; else empty
};

/// Size, resolution and origin, to recognize the map of a saved pose.
std::string mapIdentity(const GridGeometry& geometry);

/// Replaces the file in one step: a reader finds the old or the new content. Throws
/// std::runtime_error with the path if it cannot be written.
void writePoseFile(const std::string& path, const SavedPose& pose);

/// None if there is no file. A calibration that cannot be read is left out, with its problem.
/// Throws std::runtime_error with path and reason if the pose cannot be read.
std::optional<SavedPose> readPoseFile(const std::string& path);

/// The start pose from a saved one: moved by the odometry since, if its pose has continued, with a
/// covariance that grows with the distance. Else the saved pose, with a covariance of zero, so that
/// expert/initial_sigma is used.
PoseEstimate resumedPose(const SavedPose& saved, const std::optional<OdometryPose>& now);

}  // namespace racecar_mcl
