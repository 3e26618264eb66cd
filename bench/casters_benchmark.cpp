// Time per ray, error with respect to exact traversal, and memory of all casters on all maps and
// pose patterns. Prints a table; accepts Google Benchmark options such as --benchmark_filter=simd.
#include <benchmark/benchmark.h>

#include <filesystem>
#include <functional>
#include <map>

#include "basement_map.h"
#include "cpu_time.h"
#include "markdown_table.h"
#include "pose_patterns.h"
#include "racecar_mcl/map/map_io.h"
#include "racecar_mcl/raycasting/range_caster.h"
#include "raycasting/simd_caster.h"

namespace racecar_mcl::bench {
namespace {

constexpr double kMaxRangeCells = 200.0;

const Eigen::ArrayXf& bearings() {
  static const Eigen::ArrayXf fan = Eigen::ArrayXf::LinSpaced(100, -2.3562F, 2.3562F);  // 270 deg
  return fan;
}

struct NamedCaster {
  std::string name;
  std::function<std::unique_ptr<RangeCaster>(const OccupancyGrid&, RangeCasterParameters)> make;
};

/// All casters by name, and the vectorised one with each instruction set.
std::vector<NamedCaster> casters() {
  std::vector<NamedCaster> all;
  for (const std::string& name : rangeCasterNames()) {
    all.push_back({name, [name](const OccupancyGrid& grid, RangeCasterParameters parameters) {
                     parameters.range_method = name;
                     return makeRangeCaster(grid, parameters);
                   }});
  }
  for (const InstructionSet set : availableInstructionSets()) {
    all.push_back({std::string("simd (") + nameOf(set) + ")",
                   [set](const OccupancyGrid& grid, const RangeCasterParameters& parameters) {
                     return std::make_unique<SimdCaster>(grid, parameters, set);
                   }});
  }
  return all;
}

RangeCasterParameters parametersFor(const OccupancyGrid& grid) {
  RangeCasterParameters parameters;
  parameters.max_range = kMaxRangeCells * grid.geometry().resolution;
  return parameters;
}

/// Errors with respect to `bresenham`, in cells, as counters.
class Errors {
 public:
  explicit Errors(const OccupancyGrid& grid) : resolution_(grid.geometry().resolution) {
    RangeCasterParameters parameters = parametersFor(grid);
    parameters.range_method = "bresenham";
    reference_ = makeRangeCaster(grid, parameters);
  }

  void add(const PoseBatch& poses, const RangeCaster& caster) {
    Eigen::ArrayXXf expected(bearings().size(), poses.size);
    Eigen::ArrayXXf got(bearings().size(), poses.size);
    reference_->cast(poses, bearings(), expected);
    caster.cast(poses, bearings(), got);
    const Eigen::ArrayXXd cells = (got - expected).abs().cast<double>() / resolution_;
    values_.insert(values_.end(), cells.data(), cells.data() + cells.size());
  }

  void report(benchmark::State& state) {
    std::sort(values_.begin(), values_.end());
    const auto quantile = [&](double fraction) {
      return values_[static_cast<std::size_t>(fraction * static_cast<double>(values_.size() - 1))];
    };
    state.counters["median"] = quantile(0.5);
    state.counters["p95"] = quantile(0.95);
    state.counters["p99.9"] = quantile(0.999);
    const auto over = values_.end() - std::upper_bound(values_.begin(), values_.end(), 3.0);
    state.counters["over3"] =
        100.0 * static_cast<double>(over) / static_cast<double>(values_.size());
  }

 private:
  double resolution_;
  std::unique_ptr<RangeCaster> reference_;
  std::vector<double> values_;
};

/// Repeats the same batches of poses, as from a stationary car.
void measureBatches(benchmark::State& state, const NamedCaster& named, const OccupancyGrid& grid,
                    const std::vector<Poses>& batches) {
  const double start = cpuSeconds();
  const auto caster = named.make(grid, parametersFor(grid));
  state.counters["build_ms"] = 1e3 * (cpuSeconds() - start);
  Eigen::ArrayXXf ranges(bearings().size(), batches.front().batch().size);
  double seconds = 0.0;
  double rays = 0.0;
  for (auto _ : state) {
    double this_time = 0.0;
    for (const Poses& poses : batches) {
      const double begin = cpuSeconds();
      caster->prepare(poses.batch(), bearings());
      caster->cast(poses.batch(), bearings(), ranges);
      this_time += cpuSeconds() - begin;
      rays += static_cast<double>(ranges.size());
      benchmark::DoNotOptimize(ranges.data());
    }
    state.SetIterationTime(this_time);
    seconds += this_time;
  }
  state.counters["ns"] = 1e9 * seconds / rays;
  state.counters["MB"] = 1e-6 * static_cast<double>(caster->memoryBytes());
  Errors errors(grid);
  for (const Poses& poses : batches) {
    errors.add(poses.batch().segment(0, std::min<Eigen::Index>(poses.batch().size, 400)), *caster);
  }
  errors.report(state);
}

/// Three minutes at 40 Hz with 4,000 particles; includes the time to build tables.
void measureDrive(benchmark::State& state, const NamedCaster& named, const OccupancyGrid& grid) {
  const std::vector<Pose2> drive = basementDrive(grid, 180.0);
  constexpr int kParticles = 4000;
  Eigen::ArrayXXf ranges(bearings().size(), kParticles);
  for (auto _ : state) {
    const double start = cpuSeconds();
    const auto caster = named.make(grid, parametersFor(grid));
    double seconds = cpuSeconds() - start;
    state.counters["build_ms"] = 1e3 * seconds;
    double longest = 0.0;
    Errors errors(grid);
    for (std::size_t i = 0; i < drive.size(); ++i) {
      const Poses poses = cloud(drive[i], kParticles, 0.1, 0.05, i);
      const double begin = cpuSeconds();
      caster->prepare(poses.batch(), bearings());
      caster->cast(poses.batch(), bearings(), ranges);
      const double this_scan = cpuSeconds() - begin;
      seconds += this_scan;
      longest = std::max(longest, this_scan);
      benchmark::DoNotOptimize(ranges.data());
      if (i % 80 == 79) errors.add(poses.batch().segment(0, 100), *caster);
    }
    state.SetIterationTime(seconds);
    state.counters["ns"] =
        1e9 * seconds / static_cast<double>(ranges.size()) / static_cast<double>(drive.size());
    state.counters["longest_ms"] = 1e3 * longest;
    state.counters["MB"] = 1e-6 * static_cast<double>(caster->memoryBytes());
    errors.report(state);
  }
}

std::map<std::string, OccupancyGrid> maps() {
  std::map<std::string, OccupancyGrid> all;
  all.emplace("basement", basementMap());
  for (const std::string name : {"corridor", "track"}) {
    const std::string path = RACECAR_MCL_SOURCE_DIR "/maps/" + name + ".yaml";
    if (std::filesystem::exists(path)) all.emplace(name, loadMap(path));
  }
  return all;
}

std::map<std::string, std::vector<Poses>> patterns(const OccupancyGrid& grid) {
  std::map<std::string, std::vector<Poses>> all;
  all["scattered 4000"] = {scatteredPoses(grid, 4000, 1)};
  for (const int particles : {200, 4000, 100000}) {
    std::vector<Poses>& batches = all["cloud " + std::to_string(particles)];
    for (std::uint64_t place = 0; place < (particles > 10000 ? 2U : 8U); ++place) {
      batches.push_back(cloud(roomyPose(grid, place), particles, 0.5, 0.3, place));
    }
  }
  return all;
}

void registerAll() {
  static const std::map<std::string, OccupancyGrid> all_maps = maps();
  static std::map<std::string, std::map<std::string, std::vector<Poses>>> all_patterns;
  static const std::vector<NamedCaster> all_casters = casters();
  for (const auto& [map, grid] : all_maps) {
    all_patterns[map] = patterns(grid);
    for (const auto& [pattern, batches] : all_patterns[map]) {
      for (const NamedCaster& caster : all_casters) {
        benchmark::RegisterBenchmark(
            (map + "/" + pattern + "/" + caster.name).c_str(),
            [&caster, &grid = grid, &batches = batches](benchmark::State& state) {
              measureBatches(state, caster, grid, batches);
            })
            ->UseManualTime();
      }
    }
  }
  for (const NamedCaster& caster : all_casters) {
    // The other casters would take up to 15 minutes.
    if (caster.name != "simd" && caster.name != "lut") continue;
    benchmark::RegisterBenchmark(("basement/drive 4000/" + caster.name).c_str(),
                                 [&caster](benchmark::State& state) {
                                   measureDrive(state, caster, all_maps.at("basement"));
                                 })
        ->UseManualTime()
        ->Iterations(1);
  }
}

}  // namespace
}  // namespace racecar_mcl::bench

int main(int argc, char** argv) {
  return racecar_mcl::bench::printTable(argc, argv, racecar_mcl::bench::registerAll,
                                        {"map", "poses", "caster"},
                                        {{"ns", "ns per ray", 1},
                                         {"median", "median error, cells", 4},
                                         {"p95", "p95", 4},
                                         {"p99.9", "p99.9", 4},
                                         {"over3", "% off by > 3 cells", 3},
                                         {"build_ms", "build, ms", 0},
                                         {"longest_ms", "longest scan, ms", 1},
                                         {"MB", "MB", 1}});
}
