#include "racecar_mcl/relocalization/recovery_policy.h"

#include <gtest/gtest.h>

namespace racecar_mcl {
namespace {

constexpr double kHighConflict = 0.5;  // fraction of the beams
constexpr double kLowConflict = 0.05;  // fraction of the beams

/// A policy with forty scans per second of a converged filter.
class RecoveryPolicyTest : public ::testing::Test {
 protected:
  bool update(double conflict) {
    stamp_ += period_;
    policy_.update({stamp_, converged_, conflict});
    return policy_.searchIsDue();
  }

  /// s of conflict until a search is due; -1 if none is within `most` s.
  double secondsUntilSearch(double most = 40.0) {
    const double begin = stamp_;
    while (stamp_ - begin < most) {
      if (update(kHighConflict)) return stamp_ - begin;
    }
    return -1.0;
  }

  RecoveryPolicy policy_;
  double stamp_ = 100.0;
  double period_ = 0.025;  // s
  bool converged_ = true;
};

TEST_F(RecoveryPolicyTest, IsIdleWithoutAConflict) {
  for (int i = 0; i < 400; ++i) ASSERT_FALSE(update(kLowConflict));
  EXPECT_FALSE(policy_.inConflict());
}

TEST_F(RecoveryPolicyTest, SearchesAfterAFifthOfASecondInConflict) {
  update(kLowConflict);
  EXPECT_NEAR(secondsUntilSearch(), 0.2 + period_, period_ + 1e-9);
  EXPECT_TRUE(policy_.inConflict());
  EXPECT_TRUE(update(kHighConflict)) << "until a search has ended";
}

TEST_F(RecoveryPolicyTest, WaitsForSixScansOfASlowLidar) {
  period_ = 0.1;
  for (int scan = 1; scan < 6; ++scan) ASSERT_FALSE(update(kHighConflict)) << scan;
  EXPECT_TRUE(update(kHighConflict));
}

TEST_F(RecoveryPolicyTest, RestartsAfterAScanWithoutConflict) {
  for (int turn = 0; turn < 20; ++turn) {
    for (int scan = 0; scan < 5; ++scan) ASSERT_FALSE(update(kHighConflict));
    ASSERT_FALSE(update(kLowConflict));
    ASSERT_FALSE(policy_.inConflict());
  }
  period_ = 0.05;
  for (int scan = 1; scan < 6; ++scan) ASSERT_FALSE(update(kHighConflict)) << scan;
  EXPECT_TRUE(update(kHighConflict));
}

TEST_F(RecoveryPolicyTest, DoesNotSearchBeforeConvergence) {
  converged_ = false;
  EXPECT_EQ(secondsUntilSearch(5.0), -1.0);
  EXPECT_FALSE(policy_.inConflict());
  converged_ = true;
  EXPECT_GT(secondsUntilSearch(), 0.19) << "earlier conflict is not counted";
}

TEST_F(RecoveryPolicyTest, WaitsTwiceAsLongAfterEachRejectionUpToALimit) {
  ASSERT_GT(secondsUntilSearch(), 0.0);
  for (const double pause : {0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 16.0}) {
    policy_.onRejected(stamp_);
    EXPECT_NEAR(secondsUntilSearch(), pause, 1.5 * period_);
  }
}

TEST_F(RecoveryPolicyTest, WaitsAlsoIfTheConflictRestarts) {
  ASSERT_GT(secondsUntilSearch(), 0.0);
  policy_.onRejected(stamp_);
  update(kLowConflict);
  EXPECT_NEAR(secondsUntilSearch(), 0.5 - period_, 1.5 * period_);
  policy_.onRejected(stamp_);
  const double rejected = stamp_;
  while (stamp_ < rejected + 5.0) update(kLowConflict);
  EXPECT_NEAR(secondsUntilSearch(), 0.2 + period_, period_ + 1e-9) << "the pause is over";
}

TEST_F(RecoveryPolicyTest, ContinuesAfterAClockJump) {
  update(kHighConflict);
  stamp_ -= 90.0;
  EXPECT_NEAR(secondsUntilSearch(), 0.2 + period_, period_ + 1e-9);
}

TEST_F(RecoveryPolicyTest, IgnoresARejectionFromBeforeAClockJump) {
  ASSERT_GT(secondsUntilSearch(), 0.0);
  policy_.onRejected(stamp_);
  stamp_ -= 90.0;
  EXPECT_NEAR(secondsUntilSearch(), 0.2 + period_, period_ + 1e-9);
}

TEST_F(RecoveryPolicyTest, ResetClearsConflictAndPause) {
  ASSERT_GT(secondsUntilSearch(), 0.0);
  for (int i = 0; i < 5; ++i) policy_.onRejected(stamp_);
  policy_.reset();
  EXPECT_FALSE(policy_.inConflict());
  EXPECT_NEAR(secondsUntilSearch(), 0.2 + period_, period_ + 1e-9);
  policy_.onRejected(stamp_);
  EXPECT_NEAR(secondsUntilSearch(), 0.5, 1.5 * period_) << "the minimum pause again";
}

}  // namespace
}  // namespace racecar_mcl
