// Maximum-likelihood estimation of motion noise from odometry and a reference trajectory.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "evaluation/trajectory.h"
#include "racecar_mcl/motion/motion_model.h"

namespace racecar_mcl {

/// A motion measured by odometry, and its error.
struct MotionSample {
  Motion motion;
  double seconds = 0.0;   ///< duration, s
  Eigen::Vector3d error;  ///< true minus odometry's (x, y, yaw), in the car's frame at its start
};

/// Splits a drive into consecutive motions of equal duration.
class MotionSampler {
 public:
  /// `max_gap`: maximum interval between trajectory poses, s.
  MotionSampler(Trajectory base_in_map, const OdometryParameters& odometry, double max_gap);

  /// Adds odometry in order of arrival. Returns its outcome.
  OdometryOutcome add(const OdometrySample& sample, Nanoseconds stamp);

  /// Consecutive motions of the given duration, rounded to a multiple of kStep. Motions of a
  /// stationary car and motions across gaps in odometry or trajectory are left out.
  std::vector<MotionSample> samples(double seconds) const;

  static constexpr double kStep = 0.05;  ///< s

 private:
  /// Odometry and reference pose at the same time.
  struct Node {
    OdometryState odometry;
    Pose2 base_in_map;
  };

  Trajectory base_in_map_;
  OdometryBuffer odometry_;
  double max_gap_;
  Nanoseconds next_;                        ///< the next node's time
  std::vector<std::optional<Node>> nodes_;  ///< one every kStep; none inside gaps
};

/// Standard deviations of the reference trajectory's poses.
struct TrajectoryNoise {
  double position = 0.0005;  ///< m
  double yaw = 0.0005;       ///< rad

  /// Covariance of a motion between two such poses.
  Eigen::Matrix3d motionCovariance() const {
    return Eigen::Vector3d(2.0 * position * position, 2.0 * position * position, 2.0 * yaw * yaw)
        .asDiagonal();
  }
};

struct MotionNoiseEstimate {
  MotionModelParameters parameters;
  int iterations = 0;
  double log_likelihood = 0.0;  ///< mean per motion
};

/// The parameter names of a motion model's noise terms.
std::vector<std::string> noiseTerms(MotionNoise model);

/// The maximum-likelihood values of the named terms, with each error a zero-mean Gaussian of
/// motionCovariance plus the trajectory's covariance. All other terms of the model are zero. The
/// covariance is the sum of squared terms times their unit covariances, so that
///
///   term^2 <- term^2 sqrt(sum(e' C^-1 A C^-1 e) / sum(trace(C^-1 A)))
///
/// with A the unit covariance of the term increases the likelihood (Zhou et al., MM algorithms for
/// variance components models, 2019). Throws ParameterError if the model has no such term or a
/// trajectory noise is not positive, and std::invalid_argument if there are no samples.
MotionNoiseEstimate estimateMotionNoise(const std::vector<MotionSample>& samples, MotionNoise model,
                                        const std::vector<std::string>& names,
                                        const TrajectoryNoise& trajectory = {});

}  // namespace racecar_mcl
