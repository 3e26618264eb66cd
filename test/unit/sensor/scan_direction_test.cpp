#include "racecar_mcl/sensor/scan_direction.h"

#include <gtest/gtest.h>

#include "support/localizer_fixture.h"
#include "support/scans.h"

namespace racecar_mcl {
namespace {

TEST(ScanDirection, AMirroredSweepCoversTheSameInterval) {
  Scan scan = threeBeams();
  scan.seconds_after_stamp[1] = 0.02f;
  const Scan mirrored = mirroredInTime(scan);
  EXPECT_FLOAT_EQ(mirrored.seconds_after_stamp[0], 0.1f);
  EXPECT_FLOAT_EQ(mirrored.seconds_after_stamp[1], 0.08f);
  EXPECT_FLOAT_EQ(mirrored.seconds_after_stamp[2], 0.0f);
  EXPECT_EQ(mirroredInTime(Scan{}).size(), 0);
}

TEST(ScanDirection, ChangesByManyScansAndNotByOne) {
  ScanDirection order;
  order.learn(-1e9, 0.2);
  order.learn(std::numeric_limits<double>::quiet_NaN(), 0.2);
  EXPECT_FALSE(order.isReversed());
  EXPECT_STREQ(scanDirectionName(order.isReversed()), "listed");
  for (int i = 0; i < 10 && !order.isReversed(); ++i) order.learn(-0.9, 0.2);
  EXPECT_TRUE(order.isReversed());
  EXPECT_STREQ(scanDirectionName(order.isReversed()), "reversed");
  for (int i = 0; i < 10 && order.isReversed(); ++i) order.learn(-0.9, 0.2);
  EXPECT_FALSE(order.isReversed());
}

TEST(ScanDirection, SharpTurnsGiveMoreEvidenceThanSlightOnes) {
  const auto scansUntilChanged = [](double turned) {
    ScanDirection order;
    int scans = 1;
    while (!order.learn(-100.0, turned)) ++scans;
    return scans;
  };
  EXPECT_GT(scansUntilChanged(0.03), 30);
  EXPECT_LT(scansUntilChanged(0.3), 8);
}

TEST(ScanDirection, ComparesDuringTurnsUntilItIsCertain) {
  ScanDirection order;
  EXPECT_FALSE(order.needsComparison(0.01)) << "driving straight does not distort sweeps";
  for (int i = 0; i < 15; ++i) {
    EXPECT_TRUE(order.needsComparison(0.1));
    order.learn(1.0, 0.2);
  }
  for (int i = 0; i < 15; ++i) order.learn(1.0, 0.2);
  EXPECT_FALSE(order.needsComparison(0.1));
  order.reset();
  EXPECT_TRUE(order.needsComparison(0.1));
  EXPECT_FALSE(ScanDirection(ScanDirectionFrom::kListed).needsComparison(0.1));
  EXPECT_FALSE(ScanDirection(ScanDirectionFrom::kReversed).needsComparison(0.1));
}

/// A lidar that rotates clockwise, with sweeps of 0.1 s on a car that turns by 6 degrees in that
/// time: beams are listed in reverse acquisition order.
class ClockwiseLidarTest : public LocalizerTest {
 protected:
  ClockwiseLidarTest() { sweep_.seconds = 0.1; }

  Scan clockwise(double stamp) const {
    Sweep backwards = sweep_;
    backwards.seconds = -sweep_.seconds;
    Scan scan = takeScan(room_, backwards, stamp, [&](double t) { return truthAt(t); });
    scan.seconds_after_stamp = -scan.seconds_after_stamp;  // wrong times from the driver
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
          localizer->update(clockwise_lidar ? clockwise(stamp) : scanAt(stamp));
      if (i <= 100) continue;
      sum += distance(result.update.estimate.base_in_map, truthAt(stamp));
      ++scans;
    }
    return sum / scans;
  }

  static LocalizerParameters by(ScanDirectionFrom order) {
    LocalizerParameters parameters;
    parameters.scan_direction = order;
    return parameters;
  }
};

TEST_F(ClockwiseLidarTest, IsDetected) {
  Localizer learned = started(by(ScanDirectionFrom::kAuto));
  const double error = drive(&learned, true);
  EXPECT_TRUE(learned.lidars().front().direction.isReversed());
  Localizer told = started(by(ScanDirectionFrom::kReversed));
  EXPECT_NEAR(error, drive(&told, true), 0.01);
  Localizer resumed = started(by(ScanDirectionFrom::kAuto));
  resumed.resumeCalibration(learned.sensorCalibration());
  EXPECT_TRUE(resumed.lidars().front().direction.isReversed());
  Localizer misled = started(by(ScanDirectionFrom::kListed));
  EXPECT_GT(drive(&misled, true), 3.0 * error);
  misled.resumeCalibration(learned.sensorCalibration());
  EXPECT_FALSE(misled.lidars().front().direction.isReversed());
}

TEST_F(ClockwiseLidarTest, ACounterClockwiseOneIsNotChanged) {
  Localizer localizer = started(by(ScanDirectionFrom::kAuto));
  EXPECT_LT(drive(&localizer, false), 0.03);
  EXPECT_FALSE(localizer.lidars().front().direction.isReversed());
}

TEST_F(ClockwiseLidarTest, NegativeTimesAreAccepted) {
  Localizer localizer = started(by(ScanDirectionFrom::kListed));
  for (int i = 1; i <= 100; ++i) {
    const double stamp = start_ + i * kOdometryPeriod;
    localizer.addOdometry(odometryAt(stamp));
    if (i % 5 != 0) continue;
    Scan scan = clockwise(stamp);
    scan.seconds_after_stamp = -scan.seconds_after_stamp;  // with the right sign
    const ScanResult result = localizer.update(scan);
    EXPECT_LT(distance(result.update.estimate.base_in_map, truthAt(stamp)), 0.08);
  }
}

TEST_F(ClockwiseLidarTest, OrderIsNotEstimatedWithoutDeskewing) {
  LocalizerParameters parameters = by(ScanDirectionFrom::kAuto);
  parameters.scan.deskew = false;
  Localizer localizer = started(parameters);
  drive(&localizer, true);
  EXPECT_FALSE(localizer.lidars().front().direction.isReversed());
}

}  // namespace
}  // namespace racecar_mcl
