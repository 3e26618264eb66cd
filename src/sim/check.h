// How the simulator's parameter structs refuse a value: with its name, the value, and what is
// allowed.
#pragma once

#include <cmath>
#include <sstream>
#include <string>

#include "racecar_mcl/errors.h"

namespace racecar_mcl::sim {

/// Throws ParameterError unless `holds`.
inline void require(bool holds, const std::string& name, double value,
                    const std::string& expected) {
  if (holds) return;
  std::ostringstream message;
  message << name << " is " << value << "; it must be " << expected;
  throw ParameterError(message.str());
}

inline void requirePositive(const std::string& name, double value) {
  require(std::isfinite(value) && value > 0.0, name, value, "positive and finite");
}

inline void requireNotNegative(const std::string& name, double value) {
  require(std::isfinite(value) && value >= 0.0, name, value, "at least 0 and finite");
}

inline void requireFinite(const std::string& name, double value) {
  require(std::isfinite(value), name, value, "finite");
}

inline void requireShare(const std::string& name, double value) {
  require(value >= 0.0 && value <= 1.0, name, value, "between 0 and 1");
}

}  // namespace racecar_mcl::sim
