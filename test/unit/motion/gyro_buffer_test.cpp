#include "racecar_mcl/motion/gyro_buffer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace racecar_mcl {
namespace {

constexpr double kPeriod = 0.01;  // s
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// Samples in [from, to).
template <typename Rate>
void feed(GyroBuffer* gyro, double from, double to, Rate rate, bool at_rest = false) {
  const int count = static_cast<int>(std::lround((to - from) / kPeriod));
  for (int i = 0; i < count; ++i) {
    const double stamp = from + i * kPeriod;
    EXPECT_EQ(gyro->add({stamp, rate(stamp)}, at_rest), GyroOutcome::kUsed) << stamp;
  }
}

TEST(GyroBuffer, IntegratesTheRate) {
  GyroBuffer gyro;
  feed(&gyro, 10.0, 13.0, [](double t) { return std::sin(t); });
  for (const auto& [from, to] : {std::pair{10.0, 12.0}, {10.5033, 10.5088}, {12.0, 11.0}}) {
    EXPECT_NEAR(gyro.at(to)->turn - gyro.at(from)->turn, std::cos(from) - std::cos(to), 1e-4);
    EXPECT_NEAR(gyro.at(to)->rate, std::sin(to), 1e-4);
  }
}

TEST(GyroBuffer, ExtrapolatesForAShortTime) {
  GyroBuffer gyro;
  EXPECT_FALSE(gyro.at(10.0));
  feed(&gyro, 10.0, 11.0, [](double) { return 2.0; });
  EXPECT_FALSE(gyro.at(9.99)) << "before the first sample";
  EXPECT_NEAR(gyro.at(11.05)->turn - gyro.at(10.9)->turn, 0.3, 1e-9);
  EXPECT_FALSE(gyro.at(11.2));
  EXPECT_FALSE(gyro.at(kNaN));
}

TEST(GyroBuffer, KnowsNothingBeforeAGap) {
  GyroBuffer gyro;
  feed(&gyro, 10.0, 11.0, [](double) { return 2.0; });
  EXPECT_EQ(gyro.add({12.0, 2.0}, false), GyroOutcome::kGap);
  EXPECT_FALSE(gyro.at(10.5));
  EXPECT_TRUE(gyro.at(12.0));
}

TEST(GyroBuffer, DropsInvalidSamples) {
  GyroBuffer gyro;
  feed(&gyro, 10.0, 11.0, [](double) { return 0.5; });
  EXPECT_EQ(gyro.add({11.0, kNaN}, false), GyroOutcome::kNotFinite);
  EXPECT_EQ(gyro.add({kInf, 0.5}, false), GyroOutcome::kNotFinite);
  EXPECT_EQ(gyro.add({11.0, 1e4}, false), GyroOutcome::kImplausible);
  EXPECT_EQ(gyro.add({10.5, 0.5}, false), GyroOutcome::kOutOfOrder);
  EXPECT_NEAR(gyro.at(11.0)->turn, 0.5, 1e-9);
}

TEST(GyroBuffer, RestartsIfTheTimeJumpsBack) {
  GyroBuffer gyro;
  feed(&gyro, 10.0, 11.0, [](double) { return 0.5; });
  EXPECT_EQ(gyro.add({3.0, 0.5}, false), GyroOutcome::kTimeJumpedBack);
  feed(&gyro, 3.01, 4.0, [](double) { return 0.5; });
  EXPECT_NEAR(gyro.at(3.5)->turn - gyro.at(3.1)->turn, 0.2, 1e-9);
}

TEST(GyroBuffer, SubtractsTheMeanRateAtRest) {
  GyroBuffer gyro;
  feed(
      &gyro, 10.0, 12.0, [](double t) { return 0.03 + 0.01 * std::sin(100.0 * t); }, true);
  EXPECT_NEAR(gyro.bias(), 0.03, 1e-3);
  feed(&gyro, 12.0, 14.0, [](double) { return 1.03; });
  EXPECT_NEAR(gyro.at(13.9)->turn - gyro.at(12.9)->turn, 1.0, 1e-3);
}

TEST(GyroBuffer, TakesNoTurnForABias) {
  GyroBuffer gyro;
  feed(
      &gyro, 10.0, 12.0, [](double) { return 0.5; }, false);
  EXPECT_EQ(gyro.bias(), 0.0) << "the car moves";
  feed(
      &gyro, 12.0, 14.0, [](double) { return 100.0; }, true);
  EXPECT_EQ(gyro.bias(), 0.0) << "no gyro has this bias";
}

TEST(GyroBuffer, APartHasTheSameTurns) {
  GyroBuffer gyro;
  feed(&gyro, 10.0, 13.0, [](double t) { return std::sin(t); });
  const GyroBuffer part = gyro.since(12.505);
  EXPECT_EQ(part.at(12.505)->turn, gyro.at(12.505)->turn);
  EXPECT_EQ(part.at(12.9)->turn, gyro.at(12.9)->turn);
  EXPECT_FALSE(part.at(12.4));
}

}  // namespace
}  // namespace racecar_mcl
