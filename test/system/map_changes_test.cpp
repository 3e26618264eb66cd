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
  constexpr int kDrives = 4;
  MapChangeScore sum;
  double mean_error_on_proposed = 0.0;
  for (settings.seed = 1; settings.seed <= kDrives; ++settings.seed) {
    ChangedCourse scene = changedCourse(settings);
    const MapChangeEvaluation evaluation(settings, scene);
    const MapChangeScore& score = evaluation.score();
    sum.visible_new += score.visible_new;
    sum.visible_gone += score.visible_gone;
    sum.found_new += score.found_new;
    sum.found_gone += score.found_gone;
    sum.false_regions += score.false_regions;
    sum.mean_error += score.mean_error / kDrives;
    scene.course.map = makeLocalizationMap(
        applyChanges(scene.course.map->grid, evaluation.changes()), LocalizerParameters());
    mean_error_on_proposed += MapChangeEvaluation(settings, scene).score().mean_error / kDrives;
  }
  EXPECT_GT(sum.visible_new, 40);
  EXPECT_GT(sum.visible_gone, 200);
  EXPECT_GT(sum.found_new, 0.8 * sum.visible_new);
  EXPECT_GT(sum.found_gone, 0.8 * sum.visible_gone);
  EXPECT_EQ(sum.false_regions, 0);
  EXPECT_LT(mean_error_on_proposed, sum.mean_error + 0.004);
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
