// Time and memory from the grid to all that the localizer derives from it, on large maps. Prints a
// table.
#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cpu_time.h"
#include "racecar_mcl/common/random.h"
#include "racecar_mcl/localizer/localization_map.h"
#include "racecar_mcl/map/map_summary.h"

namespace racecar_mcl::bench {
namespace {

constexpr double kResolution = 0.05;  // m per cell
constexpr int kCellsPerWall = 8;      // of a side
constexpr int kMaxWallLength = 400;   // cells

/// A hall of `known` cells a side with random walls, in the middle of an unknown map of `size`.
OccupancyGrid hall(int size, int known) {
  Random random(1);
  GridGeometry geometry;
  geometry.width = geometry.height = size;
  geometry.resolution = kResolution;
  std::vector<std::int8_t> cells(static_cast<std::size_t>(size) * static_cast<std::size_t>(size),
                                 OccupancyGrid::kUnknown);
  const CellIndex index(geometry);
  const int first = (size - known) / 2;
  const auto fill = [&](int left, int bottom, int right, int top, std::int8_t value) {
    for (int row = std::max(bottom, first); row < std::min(top, first + known); ++row) {
      for (int column = std::max(left, first); column < std::min(right, first + known); ++column) {
        cells[index({column, row})] = value;
      }
    }
  };
  const int last = first + known;
  fill(first, first, last, last, OccupancyGrid::kOccupied);
  fill(first + 2, first + 2, last - 2, last - 2, OccupancyGrid::kFree);
  for (int i = 0; i < known / kCellsPerWall; ++i) {
    const int left = first + static_cast<int>(random.index(static_cast<std::size_t>(known)));
    const int bottom = first + static_cast<int>(random.index(static_cast<std::size_t>(known)));
    const int length = static_cast<int>(random.index(kMaxWallLength));
    const bool along_row = i % 2 == 0;
    fill(left, bottom, left + (along_row ? length : 2), bottom + (along_row ? 2 : length),
         OccupancyGrid::kOccupied);
  }
  return {geometry, std::move(cells)};
}

/// MB that the process has now.
double residentMegabytes() {
  std::ifstream file("/proc/self/statm");
  long pages = 0, resident = 0;
  file >> pages >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

double peakMegabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024.0 / 1e6;
}

/// Prints a row. The map is made and the summary follows, as in the node.
void measure(int size, int known) {
  const double before = residentMegabytes();
  OccupancyGrid grid = hall(size, known);
  const double cpu_start = cpuSeconds();
  const auto start = std::chrono::steady_clock::now();
  const auto map = makeLocalizationMap(std::move(grid), SensorParameters{});
  const auto made = std::chrono::steady_clock::now();
  const double peak = peakMegabytes();
  summarize(map->grid);
  const std::chrono::duration<double> map_wall = made - start;
  const std::chrono::duration<double> summary_wall = std::chrono::steady_clock::now() - made;
  const double cpu = cpuSeconds() - cpu_start;
  malloc_trim(0);
  const double memory = residentMegabytes() - before;
  const double cells = static_cast<double>(size) * static_cast<double>(size);
  std::printf("| %d x %d | %d x %d | %.2f | %.2f | %.2f | %.0f | %.1f | %.0f | %.0f |\n", size,
              size, known, known, map_wall.count(), summary_wall.count(), cpu, memory,
              memory * 1e6 / cells, peak, peakMegabytes());
  std::fflush(stdout);
}

/// In a process of its own, since peaks are those of a process.
void measureApart(int size, int known) {
  const pid_t child = fork();
  if (child == 0) {
    measure(size, known);
    _exit(0);
  }
  waitpid(child, nullptr, 0);
}

}  // namespace
}  // namespace racecar_mcl::bench

int main() {
  std::printf(
      "| map, cells | known | map, wall s | summary, wall s | both, CPU s | MB with it | bytes per "
      "cell | peak MB, map | peak MB, summary |\n"
      "|---|---|---:|---:|---:|---:|---:|---:|---:|\n");
  std::fflush(stdout);
  for (const auto& [size, known] :
       {std::pair{640, 640}, std::pair{4000, 800}, std::pair{4000, 4000}, std::pair{10000, 1000},
        std::pair{10000, 10000}}) {
    racecar_mcl::bench::measureApart(size, known);
  }
  return 0;
}
