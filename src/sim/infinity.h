#pragma once

#include <limits>

namespace racecar_mcl::sim {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace racecar_mcl::sim
