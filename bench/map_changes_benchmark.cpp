// Changes of maps found on simulated drives: recall, false regions, and the errors of the pose on
// the map before and after the changes. Prints a table; --seed selects the first drive,
// --drives their number, --only the rows whose name contains a text, --map the map.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "offline/map_change_drive.h"

namespace racecar_mcl::bench {
namespace {

std::uint64_t drives = 3;  // per row

struct Row {
  std::string name;
  MapChangeDrive drive;
};

std::vector<Row> rows(const MapChangeDrive& common) {
  std::vector<Row> all;
  const auto add = [&](const std::string& name) {
    all.push_back({name, common});
    return &all.back().drive;
  };
  add("none");
  add("none, range noise 3 cm")->range_noise = 0.03;
  add("none, two laps")->seconds = 50.0;
  add("crowd")->traffic = Fault::kCrowd;
  add("opponent")->traffic = Fault::kOpponent;
  add("6 boxes")->boxes = 6;
  add("10 % of the walls gone")->erased_walls = 0.1;
  MapChangeDrive* both = add("6 boxes, 10 % of the walls gone, crowd");
  both->boxes = 6;
  both->erased_walls = 0.1;
  both->traffic = Fault::kCrowd;
  for (const char* fault : {"moved_objects", "doors", "erased_walls", "erased_wing", "distorted"}) {
    add(std::string("map fault ") + fault)->map_fault = fault;
  }
  return all;
}

void print(const std::string& map, const Row& row) {
  MapChangeDrive drive = row.drive;
  drive.map = RACECAR_MCL_SOURCE_DIR "/maps/" + map + ".yaml";
  const std::uint64_t first = drive.seed;
  MapChangeScore sum;
  double before = 0.0, after = 0.0, worst_before = 0.0, worst_after = 0.0;
  std::uint32_t views = 0;
  for (; drive.seed < first + drives; ++drive.seed) {
    ChangedCourse scene = changedCourse(drive);
    const MapChangeEvaluation evaluation(drive, scene);
    const MapChangeScore& score = evaluation.score();
    sum.visible_new += score.visible_new;
    sum.found_new += score.found_new;
    sum.visible_gone += score.visible_gone;
    sum.found_gone += score.found_gone;
    sum.regions += score.regions;
    sum.false_regions += score.false_regions;
    views += evaluation.views();
    before += score.mean_error / double(drives);
    worst_before = std::max(worst_before, score.max_error);
    scene.course.map = makeLocalizationMap(
        applyChanges(scene.course.map->grid, evaluation.changes()), LocalizerParameters());
    const MapChangeScore proposed = MapChangeEvaluation(drive, scene).score();
    after += proposed.mean_error / double(drives);
    worst_after = std::max(worst_after, proposed.max_error);
  }
  const auto recall = [](int found, int visible) {
    return visible > 0 ? std::to_string(100 * found / visible) + " % of " + std::to_string(visible)
                       : std::string();
  };
  std::printf("| %s | %s | %u | %s | %s | %d | %d | %.1f (%.1f) | %.1f (%.1f) |\n", map.c_str(),
              row.name.c_str(), views, recall(sum.found_new, sum.visible_new).c_str(),
              recall(sum.found_gone, sum.visible_gone).c_str(), sum.regions, sum.false_regions,
              100.0 * before, 100.0 * worst_before, 100.0 * after, 100.0 * worst_after);
  std::fflush(stdout);
}

}  // namespace
}  // namespace racecar_mcl::bench

int main(int argc, char** argv) {
  using namespace racecar_mcl;
  MapChangeDrive common;
  std::string only;
  std::vector<std::string> maps{"corridor", "track"};
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string option = argv[i];
    if (option == "--seed") common.seed = static_cast<std::uint64_t>(std::atoi(argv[i + 1]));
    if (option == "--drives") bench::drives = static_cast<std::uint64_t>(std::atoi(argv[i + 1]));
    if (option == "--only") only = argv[i + 1];
    if (option == "--map") maps = {argv[i + 1]};
  }
  std::printf(
      "| map | changes | views | new cells found | gone cells found | regions | false | error, cm "
      "| on the proposed map |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& map : maps) {
    for (const bench::Row& row : bench::rows(common)) {
      if (row.name.find(only) != std::string::npos) bench::print(map, row);
    }
  }
  return 0;
}
