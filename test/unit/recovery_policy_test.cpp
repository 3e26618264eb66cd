#include "racecar_mcl/recovery_policy.h"

#include <gtest/gtest.h>

namespace racecar_mcl {
namespace {

constexpr double kMuch = 0.5;     // of the beams
constexpr double kLittle = 0.05;  // of the beams

/// A policy that is told of forty settled scans a second.
class RecoveryPolicyTest : public ::testing::Test {
 protected:
  bool hear(double conflict) {
    stamp_ += period_;
    return policy_.update({stamp_, settled_, conflict});
  }

  /// s of conflict until a search is to begin; -1 where none is within `most` s.
  double secondsUntilSearch(double most = 40.0) {
    const double begin = stamp_;
    while (stamp_ - begin < most) {
      if (hear(kMuch)) return stamp_ - begin;
    }
    return -1.0;
  }

  RecoveryPolicy policy_;
  double stamp_ = 100.0;
  double period_ = 0.025;  // s
  bool settled_ = true;
};

TEST_F(RecoveryPolicyTest, IsContentWhereScansDoNotContradictTheMap) {
  for (int i = 0; i < 400; ++i) ASSERT_FALSE(hear(kLittle));
  EXPECT_FALSE(policy_.inConflict());
}

TEST_F(RecoveryPolicyTest, SearchesAfterAFifthOfASecondInConflict) {
  hear(kLittle);
  EXPECT_NEAR(secondsUntilSearch(), 0.2 + period_, period_ + 1e-9);
  EXPECT_TRUE(policy_.inConflict());
  EXPECT_TRUE(hear(kMuch)) << "until a search has come to something";
}

TEST_F(RecoveryPolicyTest, WaitsForSixScansOfASlowLidar) {
  period_ = 0.1;
  for (int scan = 1; scan < 6; ++scan) ASSERT_FALSE(hear(kMuch)) << scan;
  EXPECT_TRUE(hear(kMuch));
}

TEST_F(RecoveryPolicyTest, BeginsToCountAnewAfterAScanWithoutConflict) {
  for (int turn = 0; turn < 20; ++turn) {
    for (int scan = 0; scan < 5; ++scan) ASSERT_FALSE(hear(kMuch));
    ASSERT_FALSE(hear(kLittle));
    ASSERT_FALSE(policy_.inConflict());
  }
  period_ = 0.05;
  for (int scan = 1; scan < 6; ++scan) ASSERT_FALSE(hear(kMuch)) << scan;
  EXPECT_TRUE(hear(kMuch));
}

TEST_F(RecoveryPolicyTest, DoesNotSearchWhileUnsettled) {
  settled_ = false;
  EXPECT_EQ(secondsUntilSearch(5.0), -1.0);
  EXPECT_FALSE(policy_.inConflict());
  settled_ = true;
  EXPECT_GT(secondsUntilSearch(), 0.19) << "what was seen before is not counted";
}

TEST_F(RecoveryPolicyTest, WaitsTwiceAsLongAfterEachRejectionUpToALimit) {
  ASSERT_GT(secondsUntilSearch(), 0.0);
  for (const double pause : {0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 16.0}) {
    policy_.onRejected(stamp_);
    EXPECT_NEAR(secondsUntilSearch(), pause, 1.5 * period_);
  }
}

TEST_F(RecoveryPolicyTest, WaitsAlsoWhereTheConflictBeginsAnew) {
  ASSERT_GT(secondsUntilSearch(), 0.0);
  policy_.onRejected(stamp_);
  hear(kLittle);
  EXPECT_NEAR(secondsUntilSearch(), 0.5 - period_, 1.5 * period_);
  policy_.onRejected(stamp_);
  const double rejected = stamp_;
  while (stamp_ < rejected + 5.0) hear(kLittle);
  EXPECT_NEAR(secondsUntilSearch(), 0.2 + period_, period_ + 1e-9) << "the pause is over";
}

TEST_F(RecoveryPolicyTest, CountsOnWhereTheClockJumpsBack) {
  hear(kMuch);
  stamp_ -= 90.0;
  EXPECT_NEAR(secondsUntilSearch(), 0.2 + period_, period_ + 1e-9);
}

TEST_F(RecoveryPolicyTest, ARejectionInATimeThatTheClockHasLeftIsNotWaitedFor) {
  ASSERT_GT(secondsUntilSearch(), 0.0);
  policy_.onRejected(stamp_);
  stamp_ -= 90.0;
  EXPECT_NEAR(secondsUntilSearch(), 0.2 + period_, period_ + 1e-9);
}

TEST_F(RecoveryPolicyTest, ForgetsConflictAndPausesWithAReset) {
  ASSERT_GT(secondsUntilSearch(), 0.0);
  for (int i = 0; i < 5; ++i) policy_.onRejected(stamp_);
  policy_.reset();
  EXPECT_FALSE(policy_.inConflict());
  EXPECT_NEAR(secondsUntilSearch(), 0.2 + period_, period_ + 1e-9);
  policy_.onRejected(stamp_);
  EXPECT_NEAR(secondsUntilSearch(), 0.5, 1.5 * period_) << "the shortest pause again";
}

}  // namespace
}  // namespace racecar_mcl
