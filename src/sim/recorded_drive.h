// Simulates a whole drive, for tests and benchmarks.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sim/driver.h"
#include "sim/simulator.h"

namespace racecar_mcl::sim {

/// The events of a wall-following drive of `seconds` from `start_in_map`, oldest first. Throws
/// ParameterError.
std::vector<Event> recordDrive(const std::shared_ptr<const World>& world,
                               const SimulatorParameters& simulator,
                               const WallFollowerParameters& follower, const Pose2& start_in_map,
                               double seconds, std::uint64_t seed);

}  // namespace racecar_mcl::sim
