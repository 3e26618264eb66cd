// Wall follower with recovery from collisions.
#pragma once

#include "sim/wall_follower.h"

namespace racecar_mcl::sim {

/// Follows the wall. After a collision of more than 1 s it backs off, turning towards the side with
/// more room, drives forward to that side, and continues with the wall follower.
class Driver {
 public:
  /// Throws ParameterError.
  explicit Driver(const WallFollowerParameters& parameters) : follower_(parameters) {}

  /// Throws ParameterError without changing anything.
  void setParameters(const WallFollowerParameters& parameters) {
    follower_.setParameters(parameters);
  }

  /// The command after a sweep, at `speed` m/s; `collided`: the car is in contact with an obstacle.
  Command drive(const LidarScan& sweep, double speed, bool collided);

 private:
  enum class Phase { kFollow, kBackOff, kTurnAway };

  void begin(Phase phase, double stamp);
  void choosePhase(const LidarScan& sweep, double speed, bool collided);

  WallFollower follower_;
  Phase phase_ = Phase::kFollow;
  double since_ = 0.0;            ///< s, start of the phase, or of the contact while following
  double last_contact_ = -1e300;  ///< s, while following
  double turn_ = 1.0;             ///< side: 1 left, -1 right
  int attempts_ = 0;              ///< consecutive attempts
  double last_attempt_ = -1e300;  ///< s
};

}  // namespace racecar_mcl::sim
