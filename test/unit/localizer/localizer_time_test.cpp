#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cstdint>

#include "racecar_mcl/localizer/localizer.h"
#include "support/localizer_fixture.h"

namespace racecar_mcl {
namespace {

TEST_F(LocalizerTest, ExtrapolatesThePoseToAnyTime) {
  Localizer localizer = started();
  PoseEstimate last;
  double stamp = 0.0;
  drive(&localizer, 0.0, 2.0, [&](const ScanResult& result) {
    last = result.update.estimate;
    stamp = result.stamp;
  });
  expectSame(*localizer.estimateAt(stamp), last);
  for (int i = 1; i <= 10; ++i) {
    localizer.addOdometry(odometryAt(start_ + 2.0 + i * kOdometryPeriod));
  }
  double before = last.covariance.determinant();
  for (const double ahead : {0.03, 0.1, 0.2, 0.27}) {
    const PoseEstimate then = *localizer.estimateAt(stamp + ahead);
    expectNear(then.base_in_map, compose(last.base_in_map, integrate(twist_, ahead)), 1e-9, 1e-9);
    EXPECT_GT(then.covariance.determinant(), before);
    before = then.covariance.determinant();
  }
  for (const double back : {0.01, 0.5}) {
    expectNear(localizer.estimateAt(stamp - back)->base_in_map,
               compose(last.base_in_map, integrate(twist_, -back)), 1e-9, 1e-9);
  }
  EXPECT_TRUE(isFinite(localizer.estimateAt(kNan)->base_in_map));
  EXPECT_TRUE(isFinite(localizer.estimateAt(1e18)->base_in_map));
}

struct Round {
  const char* name;
  bool scan_first;
  double odometry_delay;  // s, between the jumps of scans and odometry
};

class LoopingBag : public LocalizerTest, public testing::WithParamInterface<Round> {};

TEST_P(LoopingBag, KeepsThePoseAndContinues) {
  // The car drives a full circle per loop, so that the loop ends at its start.
  twist_ = {1.5, 0.0, kPi / 2};
  const double seconds = 4.0;
  Localizer localizer = started();
  drive(&localizer, 0.0, seconds);
  for (int round = 0; round < 3; ++round) {
    const PoseEstimate before = *localizer.estimateAt(start_ + seconds);
    if (GetParam().scan_first) {
      EXPECT_EQ(localizer.update(scanAt(start_ - kScanPeriod)).outcome, ScanOutcome::kStampOutlier);
      EXPECT_EQ(localizer.update(scanAt(start_)).outcome, ScanOutcome::kTimeJumpedBack);
      // Scans have the new time, odometry the old one.
      for (double late = kScanPeriod; late < GetParam().odometry_delay; late += kScanPeriod) {
        EXPECT_EQ(localizer.update(scanAt(start_ + late)).outcome, ScanOutcome::kUsed);
      }
    } else {
      EXPECT_EQ(localizer.addOdometry(odometryAt(start_ - kOdometryPeriod)),
                OdometryOutcome::kStampOutlier);
      EXPECT_EQ(localizer.addOdometry(odometryAt(start_)), OdometryOutcome::kTimeJumpedBack);
    }
    EXPECT_EQ(localizer.counters().time_jumps, static_cast<std::uint64_t>(round) + 1);
    EXPECT_LT(distance(localizer.estimateAt(start_)->base_in_map, before.base_in_map), 0.2);
    double worst = 0.0;
    drive(&localizer, GetParam().odometry_delay, seconds, [&](const ScanResult& result) {
      EXPECT_EQ(result.outcome, ScanOutcome::kUsed);
      if (result.stamp < start_ + 1.0) return;
      worst = std::max(worst, distance(result.update.estimate.base_in_map, truthAt(result.stamp)));
    });
    EXPECT_LT(worst, 0.08);
  }
}

INSTANTIATE_TEST_SUITE_P(Jumps, LoopingBag,
                         testing::Values(Round{"odometry_first", false, 0.0},
                                         Round{"scan_first", true, 0.0},
                                         Round{"odometry_late", true, 0.1}),
                         [](const auto& instance) { return instance.param.name; });

TEST_F(LocalizerTest, NamesClocksThatDiffer) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 1.0,
        [](const ScanResult& result) { EXPECT_EQ(clockProblem(result), ""); });
  for (const double offset : {-37.0, 37.0}) {
    Localizer other = started();
    ScanResult result;
    for (int i = 1; i <= 5; ++i) {
      other.addOdometry(odometryAt(start_ + i * kScanPeriod));
      Scan scan = scanAt(start_ + i * kScanPeriod);
      scan.stamp += offset;
      result = other.update(scan);
    }
    EXPECT_EQ(result.outcome, ScanOutcome::kUsed);
    EXPECT_NE(clockProblem(result).find(offset < 0.0 ? "37.0 s behind" : "37.0 s ahead of"),
              std::string::npos)
        << clockProblem(result);
  }
}

TEST_F(LocalizerTest, OneScanFromTheFutureCostsOneScan) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 1.0);
  EXPECT_EQ(localizer.update(scanAt(start_ + 1e9)).outcome, ScanOutcome::kStampOutlier);
  drive(&localizer, 1.0, 3.0,
        [&](const ScanResult& result) { EXPECT_EQ(result.outcome, ScanOutcome::kUsed); });
  expectNear(localizer.estimateAt(start_ + 3.0)->base_in_map, truthAt(start_ + 3.0), 0.06, 0.03);
}

TEST_F(LocalizerTest, ReportsWhetherOdometryCoversAStamp) {
  Localizer localizer(fewBeams(), 1);
  EXPECT_FALSE(localizer.odometryCovers(start_));
  EXPECT_EQ(localizer.twist().vx, 0.0);
  localizer.addOdometry(odometryAt(start_));
  EXPECT_TRUE(localizer.odometryCovers(start_));
  EXPECT_FALSE(localizer.odometryCovers(start_ + 0.001));
  EXPECT_EQ(*localizer.newestStamp(), start_);
  EXPECT_EQ(localizer.twist().vx, twist_.vx);
}

}  // namespace
}  // namespace racecar_mcl
