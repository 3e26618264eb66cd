// Several lidars of one car.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "racecar_mcl/localizer/localizer.h"
#include "support/localizer_fixture.h"

namespace racecar_mcl {
namespace {

/// A second lidar of 180 degrees at the rear of the car, and the first one with 180 degrees too.
class LidarsTest : public LocalizerTest {
 protected:
  struct Rear {
    double offset = 0.010;  ///< s after the scans of the front lidar
    double bias = 0.0;      ///< m
    double delay = 0.0;     ///< s from the stamp to the arrival, beyond that of the front lidar
  };

  Sweep front_{120, kPi, 0.0, {0.27, 0.0, 0.0}};
  Sweep rear_sweep_{120, kPi, 0.0, {-0.1, 0.0, kPi}};

  Scan scanOf(int lidar, double stamp, double bias = 0.0) const {
    Scan scan = takeScan(room_, lidar == 0 ? front_ : rear_sweep_, stamp,
                         [&](double t) { return truthAt(t); });
    scan.lidar = lidar;
    scan.ranges += static_cast<float>(bias);
    return scan;
  }

  static LocalizerParameters byField() {
    LocalizerParameters parameters;
    parameters.calibration.calibration_distance = 0.0;
    parameters.stationary_updates = 5;
    return parameters;
  }

  /// Drives for `seconds` with scans of both lidars; returns the largest position error after 1 s.
  double driveWithBoth(Localizer* localizer, double seconds, const Rear& rear) const {
    std::vector<std::pair<double, Scan>> scans;  // with their arrivals
    for (double after = kScanPeriod; after < seconds; after += kScanPeriod) {
      scans.emplace_back(after, scanOf(0, start_ + after));
      const double of_rear = after + rear.offset;
      scans.emplace_back(of_rear + rear.delay, scanOf(1, start_ + of_rear, rear.bias));
    }
    std::stable_sort(scans.begin(), scans.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    double worst = 0.0;
    double odometry = 0.0;
    for (const auto& [arrival, scan] : scans) {
      for (; odometry < arrival + kOdometryPeriod; odometry += kOdometryPeriod) {
        localizer->addOdometry(odometryAt(start_ + odometry));
      }
      const ScanResult result = localizer->update(scan);
      EXPECT_TRUE(hasEstimate(result.outcome)) << toString(result.outcome);
      EXPECT_GE(result.stamp, scan.stamp);
      if (arrival < 1.0) continue;
      const Pose2 truth = truthAt(result.stamp);
      worst = std::max(worst, distance(result.update.estimate.base_in_map, truth));
    }
    return worst;
  }
};

TEST_F(LidarsTest, BothCorrectThePose) {
  Localizer localizer = started(byField());
  EXPECT_LT(driveWithBoth(&localizer, 6.0, {}), 0.03);
  EXPECT_EQ(localizer.lidars().size(), 2u);
}

TEST_F(LidarsTest, TheBiasOfOneIsNotLearnedByTheOther) {
  Localizer unbiased = started(byField());
  Localizer biased = started(byField());
  driveWithBoth(&unbiased, 20.0, {});
  EXPECT_LT(driveWithBoth(&biased, 20.0, {0.010, 0.03, 0.0}), 0.05);
  const auto biasOf = [](const Localizer& localizer, std::size_t lidar) {
    return localizer.lidars().at(lidar).range_bias.bias();
  };
  EXPECT_NEAR(biasOf(biased, 0), biasOf(unbiased, 0), 0.003);
  EXPECT_NEAR(biasOf(biased, 1) - biasOf(unbiased, 1), 0.03, 0.005);
}

TEST_F(LidarsTest, ABiasIsLearnedOverTheSameDistanceAsWithOneLidar) {
  Localizer alone = started(byField());
  for (double after = 0.0; after < 6.0; after += kScanPeriod) {
    alone.addOdometry(odometryAt(start_ + after + kOdometryPeriod));
    alone.update(scanOf(0, start_ + after + kScanPeriod, 0.03));
  }
  Localizer both = started(byField());
  driveWithBoth(&both, 6.0, {0.010, 0.03, 0.0});
  EXPECT_NEAR(both.lidars().at(1).range_bias.bias(), alone.lidars().at(0).range_bias.bias(), 0.006);
}

TEST_F(LidarsTest, ScansThatArriveLateAreMovedToTheNewestByOdometry) {
  // Those of the rear lidar, which are 5 to 30 ms older, are all used.
  for (const bool deskew : {true, false}) {
    LocalizerParameters parameters = byField();
    parameters.scan.deskew = deskew;
    Localizer localizer = started(parameters);
    EXPECT_LT(driveWithBoth(&localizer, 6.0, {0.010, 0.0, 0.040}), 0.03) << deskew;
    EXPECT_EQ(localizer.counters().scans_dropped, 0u);
  }
}

TEST_F(LidarsTest, SynchronousScansAreBothUsed) {
  Localizer localizer = started(byField());
  EXPECT_LT(driveWithBoth(&localizer, 6.0, {0.0, 0.0, 0.0}), 0.03);
}

TEST_F(LidarsTest, AScanIsNotUsedTwice) {
  Localizer localizer = started(byField());
  driveWithBoth(&localizer, 1.0, {});
  const double stamp = start_ + 1.1;
  localizer.addOdometry(odometryAt(stamp));
  EXPECT_EQ(localizer.update(scanOf(1, stamp)).outcome, ScanOutcome::kUsed);
  EXPECT_EQ(localizer.update(scanOf(1, stamp)).outcome, ScanOutcome::kRepeatedStamp);
  EXPECT_EQ(localizer.update(scanOf(1, stamp - 0.05)).outcome, ScanOutcome::kOutOfOrder);
  EXPECT_EQ(localizer.update(scanOf(0, stamp - 0.05)).outcome, ScanOutcome::kUsed);
}

TEST_F(LidarsTest, ANinthLidarIsRefusedWithAReason) {
  Localizer localizer = started(byField());
  localizer.addOdometry(odometryAt(start_ + 0.1));
  for (const int lidar : {-1, kMaxLidars}) {
    Scan scan = scanOf(0, start_ + 0.05);
    scan.lidar = lidar;
    const ScanOutcome outcome = localizer.update(scan).outcome;
    EXPECT_EQ(outcome, ScanOutcome::kTooManyLidars);
    EXPECT_NE(toString(outcome).find("at most 8"), std::string::npos);
  }
  EXPECT_EQ(localizer.lidars().size(), 1u);
}

TEST_F(LidarsTest, ACreepingCarIsNotTakenAsStationary) {
  twist_ = {0.06, 0.0, 0.0};  // less than a millimetre between two scans
  Localizer localizer = started(byField());
  EXPECT_LT(driveWithBoth(&localizer, 8.0, {}), 0.03);
  expectNear(localizer.estimateAt(start_ + 8.0)->base_in_map, truthAt(start_ + 8.0), 0.03, 0.02);
}

TEST_F(LidarsTest, CalibrationIsResumedForEachLidar) {
  Localizer localizer = started(byField());
  localizer.resumeCalibration({{}, {{0.01, false}, {0.04, true}}});
  const SensorCalibration sensors = localizer.sensorCalibration();
  ASSERT_EQ(sensors.lidars.size(), 2u);
  EXPECT_EQ(sensors.lidars[0].range_bias, 0.01);
  EXPECT_FALSE(sensors.lidars[0].scan_reversed);
  EXPECT_EQ(sensors.lidars[1].range_bias, 0.04);
  EXPECT_TRUE(sensors.lidars[1].scan_reversed);
  localizer.resumeCalibration({{}, std::vector<LidarCalibration>(kMaxLidars + 1)});
  EXPECT_EQ(localizer.sensorCalibration().lidars.size(), static_cast<std::size_t>(kMaxLidars));
}

}  // namespace
}  // namespace racecar_mcl
