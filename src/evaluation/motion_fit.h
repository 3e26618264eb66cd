// The noise of the motion models, learned from odometry against a trajectory.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "evaluation/trajectory.h"
#include "racecar_mcl/motion_model.h"

namespace racecar_mcl {

/// A motion as odometry tells it, and what was wrong with it.
struct MotionSample {
  Motion motion;
  double seconds = 0.0;   ///< s, from its start to its end
  Eigen::Vector3d error;  ///< true minus odometry's (x, y, yaw), in the car's frame at its start
};

/// Cuts a drive into motions of one length each after the other.
class MotionSampler {
 public:
  /// `max_gap`: s, that trajectory poses may lie apart.
  MotionSampler(Trajectory base_in_map, const OdometryParameters& odometry, double max_gap);

  /// Odometry in the order in which it came. Returns what became of it.
  OdometryOutcome add(const OdometrySample& sample, Nanoseconds stamp);

  /// Motions of so many seconds, as many as fit one after the other; those during which the car
  /// stood, and those across a gap of odometry or trajectory, are left out. `seconds` is rounded to
  /// a multiple of kStep.
  std::vector<MotionSample> samples(double seconds) const;

  static constexpr double kStep = 0.05;  ///< s

 private:
  /// Both at the same time.
  struct Node {
    OdometryState odometry;
    Pose2 base_in_map;
  };

  Trajectory base_in_map_;
  OdometryHistory odometry_;
  double max_gap_;
  Nanoseconds next_;                        ///< the next node's time
  std::vector<std::optional<Node>> nodes_;  ///< one every kStep; none inside gaps
};

/// How well the trajectory's own poses are known, as sigmas.
struct TrajectoryNoise {
  double position = 0.0005;  ///< m
  double yaw = 0.0005;       ///< rad

  /// Of the error of a motion between two such poses.
  Eigen::Matrix3d motionCovariance() const {
    return Eigen::Vector3d(2.0 * position * position, 2.0 * position * position, 2.0 * yaw * yaw)
        .asDiagonal();
  }
};

struct MotionFit {
  MotionModelParameters parameters;
  int iterations = 0;
  double log_likelihood = 0.0;  ///< mean per motion
};

/// The noise terms of a motion model by name, as the parameters have them.
std::vector<std::string> noiseTerms(MotionNoise model);

/// The values of the named terms under which the errors are most likely, each error a zero-mean
/// Gaussian of motionCovariance plus the trajectory's; all other terms of the model are zero.
/// Variances are sums of squared terms times what each does alone, so that
///
///   term^2 <- term^2 sqrt(sum(e' C^-1 A C^-1 e) / sum(trace(C^-1 A)))
///
/// with A the covariance of the term alone climbs the likelihood (Zhou et al., MM algorithms for
/// variance components models, 2019). Throws ParameterError on a name the model does not have and
/// on a trajectory noise that is not positive, std::invalid_argument where there is no motion.
MotionFit fitMotionNoise(const std::vector<MotionSample>& samples, MotionNoise model,
                         const std::vector<std::string>& terms,
                         const TrajectoryNoise& trajectory = {});

}  // namespace racecar_mcl
