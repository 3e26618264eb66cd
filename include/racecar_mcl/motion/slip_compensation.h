// The car's motion while the odometry's speed is not the car's: locked or spinning wheels, a failed
// encoder.
#pragma once

#include <optional>

#include "racecar_mcl/motion/motion_model.h"

namespace racecar_mcl {

/// Detects changes of the odometry's speed that tyres do not allow. From then on the car's speed is
/// estimated from the estimates by scans and from the changes that tyres do allow, and motions
/// continue at it until it agrees with the odometry's. Their covariance includes the odometry's
/// motion (docs/maths.md).
///
/// Scans alone start nothing: on a map that shows little of the way along a course, the estimate's
/// speed may differ from the car's for seconds.
class SlipCompensation {
 public:
  /// The motion since the last scan: the odometry's, or one at the estimated speed and turn rate,
  /// with its `compensation` and covariance. A motion over no time gets only the `compensation`.
  Motion correct(const Motion& odometry, const MotionModelParameters& parameters) const;

  /// Learns from one scan. `odometry`: the odometry's motion since the last scan; `moved`: the
  /// motion from the last estimate to this one.
  void learn(const Motion& odometry, const Pose2& moved);

  /// The estimated twist, if the motion to the last scan was compensated.
  std::optional<Twist2> twist() const;

  void reset() { *this = SlipCompensation(); }

 private:
  /// Sums over a time.
  struct Path {
    double seconds = 0.0;
    double odometry = 0.0;  ///< m along the car, by the odometry
    double moved = 0.0;     ///< m along the car, by the estimates
    double turned = 0.0;    ///< rad, by the estimates
  };
  struct State {
    double speed = 0.0;           ///< m/s, of the car
    double turn_rate = 0.0;       ///< rad/s, of the car
    double odometry_speed = 0.0;  ///< m/s
    double change = 0.0;          ///< m/s, of the odometry's speed from the update before
    double noise = 0.0;           ///< m/s, mean difference of two successive changes
  };

  Path pathWith(const Motion& odometry) const;
  /// m/s: the last estimate plus the odometry's change since then, as far as tyres allow it.
  double expectedSpeed(const Path& path) const;
  /// m/s: the expected speed, corrected by a measured one.
  double correctedSpeed(const Path& path, double measured) const;
  /// The car's speed (m/s) if the odometry's is not; else none.
  std::optional<double> replacedSpeed(const Motion& odometry) const;

  std::optional<State> state_;  ///< at the last update; none before the first and after a long gap
  Path path_;                   ///< since then
  bool is_active_ = false;
};

}  // namespace racecar_mcl
