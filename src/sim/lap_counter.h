// Counts laps of a closed course.
#pragma once

#include "racecar_mcl/geometry/pose2.h"

namespace racecar_mcl::sim {

/// The finish line crosses the start pose, 3 m to either side. A lap is complete when the car
/// crosses it in the start direction after having been more than 4 m away.
class LapCounter {
 public:
  explicit LapCounter(const Pose2& start_in_map) : start_in_map_(start_in_map) {}

  void update(const Pose2& base_in_map) {
    const Pose2 base_in_start = between(start_in_map_, base_in_map);
    was_away_ |= distance(start_in_map_, base_in_map) > 4.0;
    const bool ahead = base_in_start.x >= 0.0;
    if (was_away_ && ahead && !was_ahead_ && std::abs(base_in_start.y) < 3.0 &&
        std::abs(base_in_start.x) < 1.0) {
      ++laps_;
      was_away_ = false;
    }
    was_ahead_ = ahead;
  }

  int laps() const { return laps_; }

 private:
  Pose2 start_in_map_;
  bool was_ahead_ = true;
  bool was_away_ = false;
  int laps_ = 0;
};

}  // namespace racecar_mcl::sim
