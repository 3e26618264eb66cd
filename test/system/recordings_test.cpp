// Recordings of real robots, if available: replay stays localized. The folder is RACECAR_MCL_DATA,
// else shared/data next to the repository.
#include <cstdlib>
#include <filesystem>

#include "support/replay_run.h"

namespace racecar_mcl {
namespace {

namespace fs = std::filesystem;

struct Recording {
  std::string name;
  std::string bag, map, truth;  ///< below the data folder
};
std::ostream& operator<<(std::ostream& stream, const Recording& recording) {
  return stream << recording.name;
}

fs::path dataFolder() {
  const char* named = std::getenv("RACECAR_MCL_DATA");
  return named ? fs::path(named) : fs::path(RACECAR_MCL_SOURCE_DIR).parent_path() / "shared/data";
}

/// The longest interval, s, during which the error exceeds a limit.
double longestAbove(const Trajectory& estimate, const Trajectory& truth, double limit,
                    double max_gap) {
  double longest = 0.0;
  std::optional<Nanoseconds> since;
  for (const StampedPose& sample : truth) {
    const std::optional<Pose2> pose = poseAt(estimate, sample.stamp, max_gap);
    if (!pose) continue;
    if (distance(*pose, sample.pose) <= limit) {
      since.reset();
      continue;
    }
    if (!since) since = sample.stamp;
    longest = std::max(longest, toSeconds(sample.stamp - *since));
  }
  return longest;
}

class RecordingsTest : public ::testing::TestWithParam<Recording> {};

TEST_P(RecordingsTest, StaysLocalizedToTheEnd) {
  const fs::path data = dataFolder();
  if (!fs::exists(data / GetParam().bag)) {
    GTEST_SKIP() << "no recording " << GetParam().bag << " in " << data
                 << "; RACECAR_MCL_DATA names the folder that holds it";
  }
  const std::string truth = (data / GetParam().truth).string();
  const ReplayedRun run = runReplay(
      {"--bag", (data / GetParam().bag).string(), "--map", (data / GetParam().map).string(),
       "--truth", truth, "--odom-topic", "/odom", "--config",
       RACECAR_MCL_SOURCE_DIR "/config/default.yaml", "--initial-pose-from-truth", "--seed", "1"});
  ASSERT_FALSE(run.estimate.empty());
  EXPECT_LT(longestAbove(run.estimate, readTum(truth), 2.0, 0.5), 3.0)
      << "s with an error of more than 2 m";
  EXPECT_LT(run.summary["position_error_m"]["final"], 2.0);
  RecordProperty("rmse_mm",
                 static_cast<int>(1000.0 * run.summary["position_error_m"]["rmse"].get<double>()));
}

INSTANTIATE_TEST_SUITE_P(
    , RecordingsTest,
    ::testing::Values(
        Recording{"intel", "intel/intel_full.bag", "intel/intel_full.yaml",
                  "intel/intel_full_gt.tum"},
        Recording{"csail", "csail/csail.bag", "csail/csail_full.yaml", "csail/csail_gt.tum"},
        Recording{"aces", "aces/aces.bag", "aces/aces_full.yaml", "aces/aces_gt.tum"},
        Recording{"fr101", "fr101/fr101.bag", "fr101/fr101_full.yaml", "fr101/fr101_gt.tum"},
        Recording{"wean1", "wean/wean1.bag", "wean/wean.yaml", "wean/wean1_ref.tum"},
        Recording{"wean3", "wean/wean3.bag", "wean/wean.yaml", "wean/wean3_ref.tum"},
        Recording{"wean4", "wean/wean4.bag", "wean/wean.yaml", "wean/wean4_ref.tum"},
        Recording{"olin", "olin/olin_take2.bag", "olin/mac_1st_floor_final.yaml",
                  "olin/olin_take2_ref.tum"}),
    [](const auto& recording) { return recording.param.name; });

}  // namespace
}  // namespace racecar_mcl
