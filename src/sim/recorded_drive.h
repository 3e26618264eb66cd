// Simulates whole drives, for tests, benchmarks and racelines.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sim/driver.h"
#include "sim/racing_path.h"
#include "sim/simulator.h"

namespace racecar_mcl::sim {

/// The events of a wall-following drive of `seconds` from `start_in_map`, oldest first. Throws
/// ParameterError.
std::vector<Event> recordDrive(const std::shared_ptr<const World>& world,
                               const SimulatorParameters& simulator,
                               const WallFollowerParameters& follower, const Pose2& start_in_map,
                               double seconds, std::uint64_t seed);

/// The path of base_link on one lap of a wall follower from `start_in_map`. Throws MapError if no
/// lap is complete within two minutes.
Path recordLap(const std::shared_ptr<const World>& world, const Pose2& start_in_map);

}  // namespace racecar_mcl::sim
