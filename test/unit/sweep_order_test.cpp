#include "racecar_mcl/sweep_order.h"

#include <gtest/gtest.h>

#include "support/localizer_fixture.h"

namespace racecar_mcl {
namespace {

Scan threeBeams() {
  Scan scan;
  scan.stamp = 7.0;
  scan.bearings = Eigen::ArrayXf::LinSpaced(3, -1.0f, 1.0f);
  scan.ranges = Eigen::ArrayXf::LinSpaced(3, 1.0f, 3.0f);
  scan.seconds_after_stamp = Eigen::ArrayXf::Zero(3);
  scan.seconds_after_stamp[1] = 0.02f;
  scan.seconds_after_stamp[2] = 0.1f;
  return scan;
}

TEST(SweepOrder, ReversedBeamsWereTakenBeforeTheStamp) {
  const Scan scan = threeBeams();
  const Scan listed = SweepOrder(SweepOrderFrom::kListed).inOrderTaken(scan);
  EXPECT_TRUE((listed.seconds_after_stamp == scan.seconds_after_stamp).all());
  const Scan reversed = SweepOrder(SweepOrderFrom::kReversed).inOrderTaken(scan);
  EXPECT_TRUE((reversed.seconds_after_stamp == -scan.seconds_after_stamp).all());
  EXPECT_EQ(reversed.stamp, scan.stamp);
  EXPECT_TRUE((reversed.bearings == scan.bearings).all());
}

TEST(SweepOrder, AMirroredSweepLastsAsLong) {
  const Scan mirrored = mirroredInTime(threeBeams());
  EXPECT_FLOAT_EQ(mirrored.seconds_after_stamp[0], 0.1f);
  EXPECT_FLOAT_EQ(mirrored.seconds_after_stamp[1], 0.08f);
  EXPECT_FLOAT_EQ(mirrored.seconds_after_stamp[2], 0.0f);
  EXPECT_EQ(mirroredInTime(Scan{}).size(), 0);
}

TEST(SweepOrder, ChangesItsMindByManyScansAndNotByOne) {
  SweepOrder order;
  order.learn(-1e9, 0.2);
  order.learn(std::numeric_limits<double>::quiet_NaN(), 0.2);
  EXPECT_FALSE(order.reversed());
  EXPECT_STREQ(order.word(), "listed");
  for (int i = 0; i < 10 && !order.reversed(); ++i) order.learn(-0.9, 0.2);
  EXPECT_TRUE(order.reversed());
  EXPECT_STREQ(order.word(), "reversed");
  for (int i = 0; i < 10 && order.reversed(); ++i) order.learn(-0.9, 0.2);
  EXPECT_FALSE(order.reversed());
}

TEST(SweepOrder, SharpTurnsSayMoreThanSlightOnes) {
  const auto scansUntilChanged = [](double turned) {
    SweepOrder order;
    int scans = 1;
    while (!order.learn(-100.0, turned)) ++scans;
    return scans;
  };
  EXPECT_GT(scansUntilChanged(0.03), 30);
  EXPECT_LT(scansUntilChanged(0.3), 8);
}

TEST(SweepOrder, AsksInTurnsUntilItIsCertain) {
  SweepOrder order;
  EXPECT_FALSE(order.wantsToCompare(0.01)) << "a way straight on bends no sweep";
  for (int i = 0; i < 15; ++i) {
    EXPECT_TRUE(order.wantsToCompare(0.1));
    order.learn(1.0, 0.2);
  }
  for (int i = 0; i < 15; ++i) order.learn(1.0, 0.2);
  EXPECT_FALSE(order.wantsToCompare(0.1));
  order.startAgain();
  EXPECT_TRUE(order.wantsToCompare(0.1));
  EXPECT_FALSE(SweepOrder(SweepOrderFrom::kListed).wantsToCompare(0.1));
  EXPECT_FALSE(SweepOrder(SweepOrderFrom::kReversed).wantsToCompare(0.1));
}

/// A lidar that takes 0.1 s for a sweep, on a car that turns by 6 degrees meanwhile. Its list runs
/// against the time, as that of a lidar that turns clockwise does.
class ClockwiseLidarTest : public LocalizerTest {
 protected:
  ClockwiseLidarTest() { sweep_.seconds = 0.1; }

  Scan clockwise(double stamp) const {
    Sweep backwards = sweep_;
    backwards.seconds = -sweep_.seconds;
    Scan scan = takeScan(room_, backwards, stamp, [&](double t) { return truthAt(t); });
    scan.seconds_after_stamp = -scan.seconds_after_stamp;  // so says the driver
    return scan;
  }

  /// The mean error (m) over the last of three seconds.
  double drive(Localizer* localizer, bool clockwise_lidar) const {
    double sum = 0.0;
    int scans = 0;
    for (int i = 1; i <= 150; ++i) {
      const double stamp = start_ + i * kOdometryPeriod;
      localizer->addOdometry(odometryAt(stamp));
      if (i % 5 != 0) continue;
      const ScanResult result =
          localizer->addScan(clockwise_lidar ? clockwise(stamp) : scanAt(stamp));
      if (i <= 100) continue;
      sum += distance(result.update.estimate.base_in_map, truthAt(stamp));
      ++scans;
    }
    return sum / scans;
  }

  static LocalizerParameters by(SweepOrderFrom order) {
    LocalizerParameters parameters;
    parameters.sweep_order = order;
    return parameters;
  }
};

TEST_F(ClockwiseLidarTest, IsFoundOut) {
  Localizer learned = started(by(SweepOrderFrom::kLearned));
  const double error = drive(&learned, true);
  EXPECT_TRUE(learned.sweepOrder().reversed());
  Localizer told = started(by(SweepOrderFrom::kReversed));
  EXPECT_NEAR(error, drive(&told, true), 0.01);
  Localizer misled = started(by(SweepOrderFrom::kListed));
  EXPECT_GT(drive(&misled, true), 3.0 * error);
}

TEST_F(ClockwiseLidarTest, AnOrdinaryOneIsNotSuspected) {
  Localizer localizer = started(by(SweepOrderFrom::kLearned));
  EXPECT_LT(drive(&localizer, false), 0.03);
  EXPECT_FALSE(localizer.sweepOrder().reversed());
}

TEST_F(ClockwiseLidarTest, TimesThatRunBackwardsAreBelieved) {
  Localizer localizer = started(by(SweepOrderFrom::kListed));
  for (int i = 1; i <= 100; ++i) {
    const double stamp = start_ + i * kOdometryPeriod;
    localizer.addOdometry(odometryAt(stamp));
    if (i % 5 != 0) continue;
    Scan scan = clockwise(stamp);
    scan.seconds_after_stamp = -scan.seconds_after_stamp;  // with the right sign
    const ScanResult result = localizer.addScan(scan);
    EXPECT_LT(distance(result.update.estimate.base_in_map, truthAt(stamp)), 0.08);
  }
}

TEST_F(ClockwiseLidarTest, OrderIsNothingWithoutDeskewing) {
  LocalizerParameters parameters = by(SweepOrderFrom::kLearned);
  parameters.deskew = false;
  Localizer localizer = started(parameters);
  drive(&localizer, true);
  EXPECT_FALSE(localizer.sweepOrder().reversed());
}

}  // namespace
}  // namespace racecar_mcl
