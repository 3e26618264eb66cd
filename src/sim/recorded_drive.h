// A whole drive at once, for those who measure the localizer on it.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sim/driver.h"
#include "sim/simulator.h"

namespace racecar_mcl::sim {

/// Everything that arrives while the car follows a wall for `seconds` from `start_in_map`, oldest
/// first. Throws ParameterError.
std::vector<Event> recordDrive(const std::shared_ptr<const World>& world,
                               const SimulatorParameters& simulator,
                               const WallFollowerParameters& driver, const Pose2& start_in_map,
                               double seconds, std::uint64_t seed);

}  // namespace racecar_mcl::sim
