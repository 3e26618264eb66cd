#pragma once

#include <algorithm>

namespace racecar_mcl {

/// The nearest value within ±limit.
inline double bounded(double value, double limit) { return std::clamp(value, -limit, limit); }

inline double square(double value) { return value * value; }

}  // namespace racecar_mcl
