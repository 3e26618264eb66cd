// The bound on the error of an estimate.
#include "racecar_mcl/monitoring/protection_level.h"

#include <gtest/gtest.h>

#include <cmath>

#include "racecar_mcl/common/errors.h"

namespace racecar_mcl {
namespace {

constexpr double kQuantile = 3.2905;  // exceeded in magnitude with a probability of 1e-3
constexpr double kSigmaFactor = 1.5;
constexpr double kTolerance = 1e-3;

class ProtectionLevelTest : public ::testing::Test {
 protected:
  ProtectionLevelTest() { estimate_.covariance = Eigen::Vector3d(0.09, 0.01, 0.0004).asDiagonal(); }

  ProtectionLevel level(double carried = 0.0) const {
    return protectionLevel(parameters_, estimate_, fit_, carried);
  }

  ProtectionLevelParameters parameters_;
  PoseEstimate estimate_;
  ScanMatch fit_;
};

TEST_F(ProtectionLevelTest, IsTheQuantileOfTheCovarianceOnAnExactMap) {
  EXPECT_NEAR(level().along, kQuantile * kSigmaFactor * 0.3, kTolerance);
  EXPECT_NEAR(level().across, kQuantile * kSigmaFactor * 0.1, kTolerance);
  EXPECT_NEAR(level().heading, kQuantile * kSigmaFactor * 0.02, kTolerance);
}

TEST_F(ProtectionLevelTest, IsAlongAndAcrossTheCar) {
  estimate_.base_in_map.yaw = kPi / 2.0;
  EXPECT_NEAR(level().along, kQuantile * kSigmaFactor * 0.1, kTolerance);
  EXPECT_NEAR(level().across, kQuantile * kSigmaFactor * 0.3, kTolerance);
}

TEST_F(ProtectionLevelTest, GrowsByTheErrorOfTheMap) {
  fit_.map_error = 0.4;
  EXPECT_NEAR(level().along, kQuantile * std::hypot(kSigmaFactor * 0.3, 0.4), 2.0 * kTolerance);
  EXPECT_NEAR(level().across, kQuantile * std::hypot(kSigmaFactor * 0.1, 0.4), 2.0 * kTolerance);
  EXPECT_GT(level().heading, kQuantile * 0.05);
}

TEST_F(ProtectionLevelTest, GrowsWithTheDistanceDrivenWithoutTheMap) {
  EXPECT_NEAR(level(10.0).along - level().along, 0.5, kTolerance);
  EXPECT_NEAR(level(10.0).across - level().across, 0.5, kTolerance);
  EXPECT_NEAR(level(10.0).heading - level().heading, 0.03, kTolerance);
}

TEST_F(ProtectionLevelTest, DecreasesWithTheIntegrityRisk) {
  parameters_.integrity_risk = 0.05;
  EXPECT_NEAR(level().along, 1.96 * kSigmaFactor * 0.3, kTolerance);
}

TEST_F(ProtectionLevelTest, IsAtMostHalfATurnForTheHeading) {
  estimate_.covariance(2, 2) = 100.0;
  EXPECT_EQ(level().heading, kPi);
  EXPECT_EQ(unboundedLevel().heading, kPi);
}

TEST_F(ProtectionLevelTest, IsFiniteIfRoundingMakesAVarianceNegative) {
  estimate_.covariance.setZero();
  estimate_.covariance(0, 0) = -1e-18;
  EXPECT_EQ(level().along, 0.0);
}

TEST(ProtectionLevelParameters, OutOfRangeIsRejected) {
  for (const double risk : {0.0, -0.1, 0.6, std::nan("")}) {
    ProtectionLevelParameters parameters;
    parameters.integrity_risk = risk;
    EXPECT_THROW(validate(parameters), ParameterError) << risk;
  }
}

}  // namespace
}  // namespace racecar_mcl
