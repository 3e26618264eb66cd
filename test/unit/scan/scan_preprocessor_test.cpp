#include "racecar_mcl/scan/scan_preprocessor.h"

#include <gtest/gtest.h>

#include <limits>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/scan/beam_selection.h"
#include "support/scans.h"

namespace racecar_mcl {
namespace {

ScanPreprocessor preprocessor(bool deskew = true) {
  ScanParameters parameters;
  parameters.min_beams = 3;
  parameters.deskew = deskew;
  return ScanPreprocessor(parameters);
}

/// A car that turns in place at 2 rad/s to the left.
Pose2 turning(double seconds) { return {0.0, 0.0, 2.0 * seconds}; }

TEST(ScanPreprocessor, RotatesEachBeamByTheTurnSinceTheStamp) {
  const PreprocessedScan scan = preprocessor().correct(threeBeams(), {}, turning);
  EXPECT_NEAR(scan.turned, 0.2, 1e-6);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(scan.beams.bearings[k], threeBeams().bearings[k] + 0.1f * static_cast<float>(k),
                1e-6f);
  }
  EXPECT_TRUE((scan.beams.seconds_after_stamp == 0.0f).all());
  EXPECT_TRUE((scan.sweep.bearings == threeBeams().bearings).all()) << "the sweep is unchanged";
}

TEST(ScanPreprocessor, ReversedBeamsWereTakenBeforeTheStamp) {
  const PreprocessedScan scan = preprocessor().correct(threeBeams(), {0.0, true}, turning);
  EXPECT_NEAR(scan.turned, 0.2, 1e-6);
  EXPECT_TRUE((scan.sweep.seconds_after_stamp == -threeBeams().seconds_after_stamp).all());
  EXPECT_NEAR(scan.beams.bearings[2], threeBeams().bearings[2] - 0.2f, 1e-6f);
  EXPECT_EQ(scan.beams.stamp, 7.0);
}

TEST(ScanPreprocessor, SubtractsTheRangeBiasButLeavesRangesPositive) {
  Scan scan = threeBeams();
  scan.ranges[0] = 0.02f;
  scan.ranges[2] = std::numeric_limits<float>::infinity();
  const Eigen::ArrayXf ranges =
      preprocessor(false).correct(scan, {0.05, false}, turning).beams.ranges;
  EXPECT_GT(ranges[0], 0.0f);
  EXPECT_NEAR(ranges[1], 1.95f, 1e-6f);
  EXPECT_EQ(ranges[2], std::numeric_limits<float>::infinity());
}

TEST(ScanPreprocessor, DoesNotChangeTheSweepWithoutDeskewing) {
  const PreprocessedScan scan = preprocessor(false).correct(threeBeams(), {0.0, true}, turning);
  EXPECT_EQ(scan.turned, 0.0);
  EXPECT_TRUE((scan.beams.bearings == threeBeams().bearings).all());
}

TEST(ScanPreprocessor, RequiresTheMinimumNumberOfBeams) {
  Scan scan = threeBeams();
  EXPECT_TRUE(preprocessor().isEnough(preprocessor().select(scan)));
  scan.ranges[1] = -1.0f;
  EXPECT_FALSE(preprocessor().isEnough(preprocessor().select(scan)));
}

TEST(ScanPreprocessor, RejectsParametersOutOfRange) {
  ScanParameters parameters;
  parameters.num_beams_per_particle = 0;
  EXPECT_THROW(ScanPreprocessor{parameters}, ParameterError);
}

TEST(ScanPreprocessor, SelectsBeamsByItsParameters) {
  const Scan scan = fan(200);
  ScanParameters parameters;
  parameters.num_beams_per_particle = 21;
  parameters.scan_field_of_view = 2.0;
  parameters.beam_box_aspect = 5.0;
  const Scan boxed = ScanPreprocessor(parameters).select(scan);
  EXPECT_TRUE((boxed.bearings == selectBeamsBoxed(scan, 21, 2.0, 5.0).bearings).all());
  parameters.beam_layout = BeamLayout::kEven;
  const Scan even = ScanPreprocessor(parameters).select(scan);
  EXPECT_TRUE((even.bearings == selectBeams(scan, 21, 2.0).bearings).all());
  EXPECT_FALSE((even.bearings == boxed.bearings).all());
}

}  // namespace
}  // namespace racecar_mcl
