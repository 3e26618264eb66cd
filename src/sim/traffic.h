// Moving traffic: a crowd of pedestrians, and an opponent car.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/car.h"
#include "sim/world.h"

namespace racecar_mcl::sim {

/// Pedestrians (discs): one per 8 m^2 of free space, 5 to 80. Each walks back and forth along a
/// straight path of 1.5 to 6 m and turns around in front of the car.
class Crowd {
 public:
  /// All paths keep 1.5 m from `keep_clear`. Throws MapError if there is no room.
  Crowd(const World& world, const Pose2& keep_clear, Random& random);

  /// Their positions at `time` (s) with the car at `base_in_map`. Times must not decrease.
  std::vector<Obstacle> walk(const Pose2& base_in_map, double time);

 private:
  struct Walker {
    Eigen::Vector2d from;
    Eigen::Vector2d direction;
    double length;  ///< m, of the path
    double along;   ///< m, position on the path
    double speed;   ///< m/s, negative on the way back
    double radius;  ///< m

    Eigen::Vector2d at(double way) const { return from + way * direction; }
  };

  std::vector<Walker> walkers_;
  std::optional<double> last_time_;  ///< s
};

/// A car that moves beside and ahead of ours, from side to side, where there is room. It avoids our
/// car.
class Opponent {
 public:
  explicit Opponent(std::uint64_t seed);

  /// Its pose at `time` (s) with our car at `base_in_map`. Times must not decrease.
  Obstacle follow(const Pose2& base_in_map, double time, const World& world);

 private:
  double phase_;                     ///< rad, of the lateral oscillation
  double angle_ = 0.0;               ///< rad, bearing from our car: 0 ahead, positive to the left
  std::optional<double> last_time_;  ///< s
};

}  // namespace racecar_mcl::sim
