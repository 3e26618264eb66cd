#pragma once

#include <algorithm>

namespace racecar_mcl {

/// The nearest value within ±limit.
inline double bounded(double value, double limit) { return std::clamp(value, -limit, limit); }

}  // namespace racecar_mcl
