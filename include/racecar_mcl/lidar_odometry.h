// Lidar odometry: the car's motion by matching each scan with the scans before it.
//
// Where a map does not show what the lidar sees, wheel odometry alone would carry the pose, and it
// drifts by a tenth of the way and more. The surroundings are there to be matched all the same,
// with the last scans taken for a map of their own.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "racecar_mcl/likelihood_field.h"
#include "racecar_mcl/motion_model.h"
#include "racecar_mcl/particle_filter.h"
#include "racecar_mcl/scan.h"

namespace racecar_mcl {

/// Tracks the car through a local map, the end points of the last keyframe scans, by a small
/// particle filter of its own: the odometry is the prior, so that a direction which the scans do
/// not observe (along a corridor) keeps the odometry's motion and its noise.
class LidarOdometry {
 public:
  LidarOdometry(const ParticleFilterParameters& filter, const MotionModelParameters& motion,
                const LikelihoodFieldParameters& field, std::uint64_t seed);

  /// Keeps a scan taken from a pose that the map has confirmed, as a keyframe to begin from.
  void remember(const Scan& beams, const Pose2& base_in_map);
  /// Forgets all keyframes: the car is somewhere else.
  void reset();

  /// The motion since the scan before, refined by this scan: `motion` with another `delta` and with
  /// the covariance of what the match left open. The motion itself where there is nothing to match
  /// with yet.
  Motion refine(const Motion& motion, const Scan& beams);

 private:
  struct Keyframe {
    Pose2 base;
    Eigen::Matrix2Xd ends;  ///< m, in the frame of the keyframes' poses
  };

  void addKeyframe(const Scan& beams, const Pose2& base);
  void buildField();
  void restart(const Pose2& base);

  ParticleFilter filter_;
  LikelihoodFieldParameters field_parameters_;
  std::deque<Keyframe> keyframes_;
  std::optional<LikelihoodField> field_;  ///< of the keyframes; none while only remembering
  Pose2 base_;                            ///< at the last scan, in the frame of the keyframes
  double since_keyframe_ = 0.0;           ///< m driven
  Eigen::Matrix3d reported_ = Eigen::Matrix3d::Zero();  ///< covariance that went with the motions
                                                        ///< since the keyframe
};

}  // namespace racecar_mcl
