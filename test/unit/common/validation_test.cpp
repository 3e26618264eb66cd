// Errors for parameters out of range.
#include "racecar_mcl/common/validation.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "racecar_mcl/common/errors.h"

namespace racecar_mcl {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

std::string messageOf(const std::function<void()>& check) {
  try {
    check();
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "";
}

TEST(Require, StatesTheValueItsUnitAndTheAllowedRange) {
  EXPECT_EQ(messageOf([] { requirePositive("speed", -1.5, "m/s"); }),
            "speed is -1.5 m/s; it must be positive and finite");
  EXPECT_EQ(messageOf([] { requireWithin("particles", 20000000, 1, 10000000); }),
            "particles is 20000000; it must be between 1 and 10000000");
  EXPECT_EQ(messageOf([] { requirePositiveUpTo("range", 0.0, 0.5, "m"); }),
            "range is 0 m; it must be positive and at most 0.5");
  EXPECT_EQ(messageOf([] { requireShare("share", 1.1); }),
            "share is 1.1; it must be between 0 and 1");
  EXPECT_EQ(messageOf([] { require(false, "seed", 3, "even"); }), "seed is 3; it must be even");
}

TEST(Require, AcceptsBothEndsOfARange) {
  EXPECT_EQ(messageOf([] {
              requireWithin("a", 1.0, 1.0, 2.0);
              requireWithin("a", 2.0, 1.0, 2.0);
              requirePositiveUpTo("a", 2.0, 2.0);
              requireNotNegative("a", 0.0);
              requireShare("a", 0.0);
              requireShare("a", 1.0);
            }),
            "");
}

TEST(Require, RejectsNaNAndInfinity) {
  for (const double value : {kNan, kInf, -kInf}) {
    EXPECT_NE(messageOf([&] { requireFinite("a", value); }), "") << value;
    EXPECT_NE(messageOf([&] { requirePositive("a", value); }), "") << value;
    EXPECT_NE(messageOf([&] { requireNotNegative("a", value); }), "") << value;
    EXPECT_NE(messageOf([&] { requireWithin("a", value, -1e9, 1e9); }), "") << value;
    EXPECT_NE(messageOf([&] { requirePositiveUpTo("a", value, 1e9); }), "") << value;
  }
}

}  // namespace
}  // namespace racecar_mcl
