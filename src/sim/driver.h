// The wall follower, and what it lacks: a way on after it has driven against something.
#pragma once

#include "sim/wall_follower.h"

namespace racecar_mcl::sim {

/// Follows the wall. A car that has stood against something for over a second is backed off, its
/// nose turning to the side where there is more room, and driven ahead to that side; then the wall
/// follower has it again. A drive that meets nothing is the wall follower's alone.
class Driver {
 public:
  /// Throws ParameterError.
  explicit Driver(const WallFollowerParameters& parameters) : follower_(parameters) {}

  /// Throws ParameterError and changes nothing.
  void setParameters(const WallFollowerParameters& parameters) {
    follower_.setParameters(parameters);
  }

  /// What to do after a sweep, driving at `speed` m/s; `collided`: the car stands against
  /// something.
  Command drive(const LidarScan& sweep, double speed, bool collided);

 private:
  enum class Phase { kFollow, kBackOff, kTurnAway };

  void begin(Phase phase, double stamp);
  void choosePhase(const LidarScan& sweep, double speed, bool collided);

  WallFollower follower_;
  Phase phase_ = Phase::kFollow;
  double since_ = 0.0;  ///< s, of the phase; following, since the car stands against something
  double last_contact_ = -1e300;  ///< s, while following
  double turn_ = 1.0;             ///< to which side: 1 left, -1 right
  int tries_ = 0;                 ///< one soon after the other
  double last_try_ = -1e300;      ///< s
};

}  // namespace racecar_mcl::sim
