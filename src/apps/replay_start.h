// Where a localizer of ReplayOptions starts, and the ground truth.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/trajectory.h"
#include "offline/bag_reader.h"
#include "offline/offline_driver.h"
#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/localizer/localizer.h"
#include "replay_options.h"
#include "ros/localization/node_parameters.h"

namespace racecar_mcl {

// Initial standard deviations with --initial-pose-from-truth.
constexpr double kTruthSigma = 0.1;      // m
constexpr double kTruthYawSigma = 0.05;  // rad

/// The ground truth from the file, else from the bag, if present.
inline std::optional<Trajectory> readTruth(const ReplayOptions& o, const BagReader& bags) {
  if (!o.truth.empty()) return readTum(o.truth);
  if (bags.hasTopic(kTruthTopic, "nav_msgs/Odometry")) return bags.readPoses(kTruthTopic);
  return std::nullopt;
}

/// The first pose of the truth at `begin` or later.
inline std::optional<TimedStart> startFromTruth(const std::optional<Trajectory>& truth,
                                                Nanoseconds begin) {
  if (!truth) {
    throw ParameterError(std::string("--initial-pose-from-truth requires --truth or ") +
                         kTruthTopic + " in the bag");
  }
  const auto first = std::find_if(truth->begin(), truth->end(),
                                  [&](const StampedPose& pose) { return pose.stamp >= begin; });
  if (first == truth->end()) {
    throw TrajectoryError("the truth covers " + spanOf(*truth) +
                          " s, which has no pose after --start (" + formatStamp(begin) + " s)");
  }
  TimedStart start{first->stamp, {first->pose, Eigen::Matrix3d::Zero()}};
  start.estimate.covariance.diagonal() << kTruthSigma * kTruthSigma, kTruthSigma * kTruthSigma,
      kTruthYawSigma * kTruthYawSigma;
  return start;
}

inline Nanoseconds firstScanStamp(const ReplayOptions& o, const BagReader& bags) {
  std::vector<Nanoseconds> stamps;
  for (const std::string& topic : o.scan_topics) stamps.push_back(bags.firstScanStamp(topic));
  return *std::min_element(stamps.begin(), stamps.end());
}

/// Initializes the localizer, or returns a start at a later time.
inline std::optional<TimedStart> start(const ReplayOptions& o, const BagReader& bags,
                                       const std::optional<Trajectory>& truth,
                                       Localizer* localizer) {
  if (o.initial_pose_from_truth) {
    const bool at_beginning = o.span.start == 0.0;
    return startFromTruth(
        truth, at_beginning ? std::numeric_limits<Nanoseconds>::min() : firstScanStamp(o, bags));
  }
  if (!o.initial_pose.empty()) {
    localizer->initialize({parsePose("--initial-pose", o.initial_pose), Eigen::Matrix3d::Zero()});
  } else {
    localizer->initializeGlobally();
  }
  return std::nullopt;
}

}  // namespace racecar_mcl
