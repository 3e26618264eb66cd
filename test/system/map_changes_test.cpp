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
};

TEST_P(MapChangesTest, FindsBoxesAndErasedWallsAndLocalizesNoWorseOnTheProposedMap) {
  MapChangeDrive settings = drive();
  settings.boxes = 6;
  settings.erased_walls = 0.1;
  ChangedCourse scene = changedCourse(settings);
  const MapChangeEvaluation evaluation(settings, scene);
  const MapChangeScore& score = evaluation.score();
  EXPECT_GT(score.visible_new, 10);
  EXPECT_GT(score.visible_gone, 50);
  EXPECT_GT(score.found_new, 0.8 * score.visible_new);
  EXPECT_GT(score.found_gone, 0.8 * score.visible_gone);
  EXPECT_EQ(score.false_regions, 0);
  scene.course.map = makeLocalizationMap(applyChanges(scene.course.map->grid, evaluation.changes()),
                                         LocalizerParameters());
  EXPECT_LT(MapChangeEvaluation(settings, scene).score().mean_error, score.mean_error + 0.003);
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
