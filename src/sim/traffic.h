// What else is on the way: people who walk about, and another car.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/car.h"
#include "sim/world.h"

namespace racecar_mcl::sim {

/// People, as discs: one for each 8 m^2 of free space, at least 5 and at most 80. Each walks to and
/// fro along a straight way of 1.5 to 6 m, and turns back before the car.
class Crowd {
 public:
  /// No way comes within 1.5 m of `keep_clear`. Throws MapError where the world has no room for
  /// them.
  Crowd(const World& world, const Pose2& keep_clear, Random& random);

  /// Where they are at `time` (s), the car being at `base_in_map`. Times must not run backwards.
  std::vector<Obstacle> walk(const Pose2& base_in_map, double time);

 private:
  struct Walker {
    Eigen::Vector2d from;
    Eigen::Vector2d direction;
    double length;  ///< m, of the way
    double along;   ///< m, on it
    double speed;   ///< m/s, negative on the way back
    double radius;  ///< m

    Eigen::Vector2d at(double way) const { return from + way * direction; }
  };

  std::vector<Walker> walkers_;
  std::optional<double> last_time_;  ///< s
};

/// A car that stays beside or just ahead of ours, swaying from one side past its front to the
/// other, where walls leave room for it. It keeps clear of ours by itself.
class Opponent {
 public:
  explicit Opponent(std::uint64_t seed);

  /// Where it is at `time` (s), ours being at `base_in_map`. Times must not run backwards.
  Obstacle follow(const Pose2& base_in_map, double time, const World& world);

 private:
  double phase_;        ///< rad, of its swaying
  double angle_ = 0.0;  ///< rad, to where it is about our car: 0 ahead, positive to the left
  std::optional<double> last_time_;  ///< s
};

}  // namespace racecar_mcl::sim
