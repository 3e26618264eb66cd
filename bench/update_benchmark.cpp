// Time of a filter update (predict, reweight, resample, estimate) during a drive, by sensor model,
// caster, particles, beams and threads. Prints a table; accepts Google Benchmark options such as
// --benchmark_filter=lut.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <map>

#include "basement_map.h"
#include "cpu_time.h"
#include "markdown_table.h"
#include "pose_patterns.h"
#include "racecar_mcl/filter/particle_filter.h"
#include "racecar_mcl/localizer/localization_map.h"
#include "racecar_mcl/raycasting/range_caster.h"

namespace racecar_mcl::bench {
namespace {

constexpr double kSeconds = 10.0;
constexpr std::size_t kWarmUp = 80;         // scans before the measurement
constexpr float kSensorRange = 10.0F;       // m
constexpr double kRangeNoise = 0.02;        // m
constexpr double kScanPeriod = 1.0 / 40.0;  // s
constexpr double kBresenhamRays = 3e7;      // maximum number of rays for the slow caster

double wallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The poses, motions and scans of a drive.
struct Drive {
  std::vector<Pose2> poses;
  std::vector<Motion> motions;  ///< from the previous scan
  std::vector<Scan> scans;
};

Drive makeDrive(const OccupancyGrid& grid, int beams) {
  Drive drive;
  drive.poses = basementDrive(grid, kSeconds);
  RangeCasterParameters parameters;
  parameters.range_method = "distance_transform";
  parameters.max_range = static_cast<double>(kSensorRange);
  const auto caster = makeRangeCaster(grid, parameters);
  Random random(7);
  for (std::size_t i = 0; i < drive.poses.size(); ++i) {
    const Pose2& pose = drive.poses[i];
    Scan scan;
    scan.bearings = Eigen::ArrayXf::LinSpaced(beams, -2.3562F, 2.3562F);  // 270 degrees
    scan.seconds_after_stamp = Eigen::ArrayXf::Zero(beams);
    Eigen::ArrayXXf ranges(beams, 1);
    caster->cast({&pose.x, &pose.y, &pose.yaw, 1}, scan.bearings, ranges);
    scan.ranges = ranges.col(0).unaryExpr([&random](float range) {
      return range >= kSensorRange ? std::numeric_limits<float>::infinity()
                                   : range + static_cast<float>(kRangeNoise * random.gaussian());
    });
    drive.scans.push_back(std::move(scan));
    Motion motion;
    if (i > 0) motion.delta = between(drive.poses[i - 1], pose);
    motion.distance = std::hypot(motion.delta.x, motion.delta.y);
    motion.rotation = std::abs(motion.delta.yaw);
    motion.seconds = kScanPeriod;
    drive.motions.push_back(motion);
  }
  return drive;
}

struct Case {
  std::string model;  ///< field, or a range method
  int particles;
  int beams;
  int threads;

  std::string name() const {
    return (model == "field" ? "likelihood_field/" : "beam/") +
           (model == "field" ? std::string("-") : model) + "/" + std::to_string(particles) + "/" +
           std::to_string(beams) + "/" + std::to_string(threads);
  }
};

void measure(benchmark::State& state, const Case& c, const OccupancyGrid& grid,
             const Drive& drive) {
  SensorParameters sensor;
  sensor.sensor_model =
      c.model == "field" ? SensorModelType::kLikelihoodField : SensorModelType::kBeam;
  if (c.model != "field") sensor.caster.range_method = c.model;
  const auto map = makeLocalizationMap(grid, sensor);
  const MapView view = map->view();
  ParticleFilterParameters parameters;
  parameters.num_particles = parameters.max_particles = c.particles;
  parameters.num_threads = c.threads;
  parameters.resample_threshold = 1.0;  // resample at every scan
  const double rays = static_cast<double>(c.particles) * c.beams;
  const bool slow = c.model == "bresenham";
  for (auto _ : state) {
    ParticleFilter filter(parameters, MotionModelParameters(), 1);
    const auto model = makeSensorModel(*map, sensor, c.threads);
    const std::size_t warm_up = slow && rays > 1e6 ? 0 : kWarmUp;
    PoseEstimate start{drive.poses[0], Eigen::Matrix3d::Zero()};
    start.covariance.diagonal() << 0.01, 0.01, 0.0025;
    filter.initialize(start);
    std::vector<double> cpu, wall;
    double error = 0.0;
    for (std::size_t i = 0; i < drive.scans.size(); ++i) {
      const double cpu_start = cpuSeconds();
      const double wall_start = wallSeconds();
      filter.predict(drive.motions[i]);
      const UpdateResult& result = filter.update(drive.scans[i], model.get(), &view);
      const double wall_end = wallSeconds();
      const double cpu_end = cpuSeconds();
      if (i < warm_up) continue;
      cpu.push_back(cpu_end - cpu_start);
      wall.push_back(wall_end - wall_start);
      error = std::max(error, distance(result.estimate.base_in_map, drive.poses[i]));
      if (slow && static_cast<double>(cpu.size()) * rays > kBresenhamRays) break;
    }
    const double typical = median(cpu);
    state.SetIterationTime(typical);
    state.counters["cpu_ms"] = 1e3 * typical;
    state.counters["worst_ms"] = 1e3 * *std::max_element(cpu.begin(), cpu.end());
    state.counters["wall_ms"] = 1e3 * median(wall);
    state.counters["best_ms"] = 1e3 * *std::min_element(wall.begin(), wall.end());
    state.counters["ns"] = 1e9 * typical / rays;
    state.counters["error"] = error;
  }
}

void registerAll() {
  static const OccupancyGrid grid = basementMap();
  static std::map<int, Drive> drives;
  std::vector<Case> cases;
  for (const char* model : {"lut", "simd", "field", "bresenham"}) {
    for (const int particles : {200, 2000, 10000, 100000}) {
      cases.push_back({model, particles, 100, 1});
      if (model == std::string("bresenham")) continue;
      cases.push_back({model, particles, 100, 2});
    }
  }
  for (const char* model : {"lut", "simd", "field"}) {
    for (const int beams : {50, 1081}) cases.push_back({model, 2000, beams, 1});
  }
  for (const Case& c : cases) {
    if (drives.count(c.beams) == 0) drives[c.beams] = makeDrive(grid, c.beams);
    benchmark::RegisterBenchmark(
        c.name().c_str(),
        [c](benchmark::State& state) { measure(state, c, grid, drives.at(c.beams)); })
        ->UseManualTime()
        ->Iterations(1);
  }
}

}  // namespace
}  // namespace racecar_mcl::bench

int main(int argc, char** argv) {
  return racecar_mcl::bench::printTable(argc, argv, racecar_mcl::bench::registerAll,
                                        {"model", "caster", "particles", "beams", "threads"},
                                        {{"cpu_ms", "CPU ms, median", 3},
                                         {"worst_ms", "CPU ms, worst", 2},
                                         {"wall_ms", "wall ms, median", 3},
                                         {"best_ms", "wall ms, best", 3},
                                         {"ns", "CPU ns per beam", 2},
                                         {"error", "worst error, m", 3}});
}
