// Obstacles found on simulated drives (obstacle_distance: --distance): recall, false clusters and
// velocity errors, on correct and on wrong maps. Prints a table; --seed selects the first of three
// drives.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "offline/obstacle_drive.h"

namespace racecar_mcl::bench {
namespace {

constexpr std::uint64_t kDrives = 3;   // per row
constexpr double kLapSeconds = 25.0;   // of both maps at 3 m/s: 24.5 and 25 s
constexpr double kAmongOthers = 20.0;  // s

struct Row {
  std::string name;
  ObstacleDrive drive;
};

std::vector<Row> rows(const ObstacleDrive& common) {
  std::vector<Row> all;
  const auto add = [&](const std::string& name, double seconds) {
    all.push_back({name, common});
    all.back().drive.seconds = seconds;
    return &all.back().drive;
  };
  add("none", kLapSeconds);
  add("none, range noise 3 cm", kLapSeconds)->range_noise = 0.03;
  add("boxes and discs", kAmongOthers)->traffic = Fault::kObstacles;
  add("crowd", kAmongOthers)->traffic = Fault::kCrowd;
  add("car ahead", kAmongOthers)->has_car_ahead = true;
  add("opponent", kAmongOthers)->traffic = Fault::kOpponent;
  for (const double displacement : {0.05, 0.1}) {
    const std::string name =
        "none, walls " + std::to_string(std::lround(100.0 * displacement)) + " cm off";
    add(name, kLapSeconds)->wall_displacement = displacement;
  }
  for (const char* fault : {"distorted", "erased_wing", "doors", "erased_walls"}) {
    add(std::string("none, map fault ") + fault, kLapSeconds)->map_fault = fault;
  }
  return all;
}

void print(const std::string& map, const Row& row) {
  ObstacleDrive drive = row.drive;
  drive.map = RACECAR_MCL_SOURCE_DIR "/maps/" + map + ".yaml";
  const std::uint64_t first = drive.seed;
  ObstacleScore score;
  for (; drive.seed < first + kDrives; ++drive.seed) score += driveOnce(drive);
  std::printf("| %s | %s | %d | %d | ", map.c_str(), row.name.c_str(), score.scans, score.visible);
  if (score.visible > 0) std::printf("%.1f %%", 100.0 * score.recall());
  std::printf(" | %d | %.1f | ", score.clusters,
              score.false_clusters * drive.seconds / kLapSeconds / double(kDrives));
  if (score.settled > 0) {
    std::printf("%.1f %% | %.2f m/s |\n", 100.0 * score.velocities / score.settled,
                score.velocityRms());
  } else {
    std::printf(" | |\n");
  }
  std::fflush(stdout);
}

}  // namespace
}  // namespace racecar_mcl::bench

int main(int argc, char** argv) {
  using namespace racecar_mcl;
  ObstacleDrive common;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string option = argv[i];
    if (option == "--distance") common.detection.obstacle_distance = std::atof(argv[i + 1]);
    if (option == "--seed") common.seed = static_cast<std::uint64_t>(std::atoi(argv[i + 1]));
  }
  std::printf(
      "| map | obstacles | scans | in view | recall | clusters | false per lap | tracked | "
      "velocity "
      "error, rms |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const char* map : {"corridor", "track"}) {
    for (const bench::Row& row : bench::rows(common)) bench::print(map, row);
  }
  return 0;
}
