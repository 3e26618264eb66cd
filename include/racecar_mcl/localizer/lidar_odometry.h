// Lidar odometry: the car's motion by matching each scan with a local map of the last scans.
//
// Used where the global map does not show what the lidar sees: wheel odometry alone can drift by a
// tenth of the distance driven.
#pragma once

#include <Eigen/Core>
#include <array>
#include <deque>
#include <optional>

#include "racecar_mcl/filter/particle_filter.h"
#include "racecar_mcl/motion/motion_model.h"
#include "racecar_mcl/scan/scan.h"
#include "racecar_mcl/sensor/likelihood_field.h"

namespace racecar_mcl {

/// Scan-to-local-map matching by a particle filter. The local map holds the end points of the last
/// keyframes of each lidar. Odometry is the prior, so that a direction which the scans do not
/// observe (along a corridor) keeps the odometry's motion and noise.
class LidarOdometry {
 public:
  LidarOdometry(const ParticleFilterParameters& filter, const MotionModelParameters& motion,
                const LikelihoodFieldParameters& field, std::uint64_t seed);

  /// The keyframes are kept. Throws ParameterError, and then changes nothing.
  void setParameters(const ParticleFilterParameters& filter, const MotionModelParameters& motion,
                     const LikelihoodFieldParameters& field);

  /// Stores a scan taken from a pose that was localized on the global map, as an initial keyframe.
  void remember(const Scan& beams, const Pose2& base_in_map);
  /// Removes all keyframes, as after a relocalization.
  void reset();

  /// The motion since the last scan, refined by matching this scan: `motion` with a new `delta` and
  /// its covariance. Returns `motion` unchanged if there is no keyframe yet.
  Motion refine(const Motion& motion, const Scan& beams);

 private:
  struct Keyframe {
    int lidar;
    Pose2 base;
    Eigen::Matrix2Xd ends;  ///< m, in the frame of the keyframes' poses
  };

  void addTravelled(double travelled);
  double& sinceKeyframe(const Scan& beams);
  void addKeyframe(const Scan& beams, const Pose2& base);
  void buildField();
  void restart(const Pose2& base);

  ParticleFilter filter_;
  MotionModelParameters motion_parameters_;
  LikelihoodFieldParameters field_parameters_;
  int num_threads_;
  std::deque<Keyframe> keyframes_;
  std::optional<LikelihoodField> field_;  ///< of the keyframes; built by the first `refine`
  Pose2 base_;                            ///< at the last scan, in the frame of the keyframes
  /// m driven since the last keyframe of each lidar; infinite before the first.
  std::array<double, kMaxLidars> since_keyframe_;
  /// Sum of the covariances returned since the last keyframe.
  Eigen::Matrix3d reported_ = Eigen::Matrix3d::Zero();
};

}  // namespace racecar_mcl
