// Changes of maps found on simulated drives, as in bench/map_changes_benchmark.cpp.
#include <gtest/gtest.h>

#include <string>

#include "offline/map_change_drive.h"

namespace racecar_mcl {
namespace {

class MapChangesTest : public ::testing::TestWithParam<const char*> {
 protected:
  static MapChangeDrive drive() {
    MapChangeDrive settings;
    settings.map = std::string(RACECAR_MCL_SOURCE_DIR "/maps/") + GetParam() + ".yaml";
    settings.seconds = 12.0;
    return settings;
  }

  static MapChangeDrive withChanges() {
    MapChangeDrive settings = drive();
    settings.boxes = 6;
    settings.erased_walls = 0.1;
    return settings;
  }
};

TEST_P(MapChangesTest, FindsBoxesAndErasedWalls) {
  const MapChangeDrive settings = withChanges();
  const ChangedCourse scene = changedCourse(settings);
  const MapChangeEvaluation evaluation(settings, scene);
  const MapChangeScore& score = evaluation.score();
  EXPECT_GT(score.visible_new, 10);
  EXPECT_GT(score.visible_gone, 50);
  EXPECT_GT(score.found_new, 0.8 * score.visible_new);
  EXPECT_GT(score.found_gone, 0.8 * score.visible_gone);
  EXPECT_EQ(score.false_regions, 0);
}

TEST_P(MapChangesTest, LocalizesNoWorseOnTheProposedMap) {
  constexpr int kDrives = 32;  // the mean over 8 varies by 2 mm
  MapChangeScore sum, sum_on_proposed;
  MapChangeDrive settings = withChanges();
  for (settings.seed = 1; settings.seed <= kDrives; ++settings.seed) {
    ChangedCourse scene = changedCourse(settings);
    const MapChangeEvaluation evaluation(settings, scene);
    sum += evaluation.score();
    scene.course.map = makeLocalizationMap(
        applyChanges(scene.course.map->grid, evaluation.changes()), LocalizerParameters());
    sum_on_proposed += MapChangeEvaluation(settings, scene).score();
  }
  EXPECT_LT(sum_on_proposed.mean_error, sum.mean_error + 0.003 * kDrives);
}

TEST_P(MapChangesTest, FindsNoneOnACorrectMap) {
  const MapChangeDrive settings = drive();
  const ChangedCourse scene = changedCourse(settings);
  const MapChangeEvaluation evaluation(settings, scene);
  EXPECT_GT(evaluation.views(), 100u);
  EXPECT_EQ(evaluation.score().regions, 0);
}

TEST_P(MapChangesTest, AnOpponentIsNoChange) {
  MapChangeDrive settings = drive();
  settings.traffic = Fault::kOpponent;
  const ChangedCourse scene = changedCourse(settings);
  const MapChangeEvaluation evaluation(settings, scene);
  EXPECT_GT(evaluation.views(), 100u);
  EXPECT_EQ(evaluation.score().regions, 0);
}

INSTANTIATE_TEST_SUITE_P(Maps, MapChangesTest, ::testing::Values("corridor", "track"),
                         [](const auto& map) { return std::string(map.param); });

}  // namespace
}  // namespace racecar_mcl
