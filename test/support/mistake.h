// Invalid messages for parameterized tests.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <ostream>
#include <string>

namespace racecar_mcl {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInfF = std::numeric_limits<float>::infinity();

/// An invalid message, its diagnostics counter, and the expected log text.
template <typename Message>
struct Mistake {
  std::string name;
  std::function<void(Message&)> spoil;
  std::string counter;
  std::string words;
};

template <typename Message>
std::ostream& operator<<(std::ostream& stream, const Mistake<Message>& mistake) {
  return stream << mistake.name;
}

template <typename Param>
std::string nameOf(const ::testing::TestParamInfo<Param>& info) {
  return info.param.name;
}

}  // namespace racecar_mcl
