// Changes of maps found on simulated drives: recall, false regions, and the errors of the pose on
// the map before and after the changes. Prints a table; --seed selects the first drive,
// --drives their number, --only a row by its name, --map the map.
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

/// Of several drives.
struct Total {
  MapChangeScore score;
  std::uint32_t views = 0;

  void add(const MapChangeEvaluation& evaluation) {
    score += evaluation.score();
    views += evaluation.views();
  }
};

std::string recall(int found, int visible) {
  return visible > 0 ? std::to_string(100 * found / visible) + " % of " + std::to_string(visible)
                     : std::string();
}

void print(const std::string& map, const Row& row) {
  MapChangeDrive drive = row.drive;
  drive.map = RACECAR_MCL_SOURCE_DIR "/maps/" + map + ".yaml";
  Total before, after;
  for (const std::uint64_t end = drive.seed + drives; drive.seed < end; ++drive.seed) {
    ChangedCourse scene = changedCourse(drive);
    const MapChangeEvaluation evaluation(drive, scene);
    before.add(evaluation);
    scene.course.map = makeLocalizationMap(
        applyChanges(scene.course.map->grid, evaluation.changes()), LocalizerParameters());
    after.add(MapChangeEvaluation(drive, scene));
  }
  const MapChangeScore& found = before.score;
  const double to_mean = 100.0 / static_cast<double>(drives);
  std::printf("| %s | %s | %u | %s | %s | %d | %d | %.1f (%.1f) | %.1f (%.1f) |\n", map.c_str(),
              row.name.c_str(), before.views, recall(found.found_new, found.visible_new).c_str(),
              recall(found.found_gone, found.visible_gone).c_str(), found.regions,
              found.false_regions, to_mean * found.mean_error, 100.0 * found.max_error,
              to_mean * after.score.mean_error, 100.0 * after.score.max_error);
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
      if (only.empty() || row.name == only) bench::print(map, row);
    }
  }
  return 0;
}
