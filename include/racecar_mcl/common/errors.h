// Exceptions of the core. Each message states what is wrong, where, and what was expected.
#pragma once

#include <stdexcept>

namespace racecar_mcl {

/// A parameter is out of range or inconsistent with another one.
struct ParameterError : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// A map cannot be read or is unusable.
struct MapError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace racecar_mcl
