#include "racecar_mcl/scan_hold.h"

#include <gtest/gtest.h>

namespace racecar_mcl {
namespace {

/// Odometry that has come up to a stamp.
auto upTo(double newest) {
  return [newest](double stamp) { return newest >= stamp; };
}

TEST(ScanHold, letsAScanGoThatOdometryCovers) {
  ScanHold<int> hold(0.1);
  hold.add(10.0, 20.0, 1);
  EXPECT_FALSE(hold.takeReady(20.0, upTo(9.98)));
  EXPECT_EQ(hold.takeReady(20.02, upTo(10.0)), 1);
  EXPECT_TRUE(hold.empty());
}

TEST(ScanHold, waitsNoLongerThanItsPatience) {
  ScanHold<int> hold(0.1);
  hold.add(10.0, 20.0, 1);
  EXPECT_FALSE(hold.takeReady(20.09, upTo(9.0)));
  EXPECT_EQ(hold.takeReady(20.11, upTo(9.0)), 1);
}

TEST(ScanHold, keepsTheOrderOfArrival) {
  ScanHold<int> hold(0.1);
  hold.add(10.0, 20.0, 1);
  hold.add(10.05, 20.05, 2);
  EXPECT_EQ(hold.takeReady(20.12, upTo(10.0)), 1);
  EXPECT_FALSE(hold.takeReady(20.12, upTo(10.0)));
  EXPECT_EQ(hold.take(), 2);
  EXPECT_FALSE(hold.take());
}

TEST(ScanHold, letsGoWhenTheClockIsSetBack) {
  ScanHold<int> hold(0.1);
  hold.add(10.0, 20.0, 1);
  EXPECT_EQ(hold.takeReady(3.0, upTo(2.0)), 1);
}

}  // namespace
}  // namespace racecar_mcl
