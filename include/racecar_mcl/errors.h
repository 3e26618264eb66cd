// The errors the core throws. Each message says what is wrong, where, and what was expected.
#pragma once

#include <stdexcept>

namespace racecar_mcl {

/// A parameter that is out of range or does not fit another.
struct ParameterError : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// A map that cannot be read or cannot be used.
struct MapError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace racecar_mcl
