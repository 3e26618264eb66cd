// Simulated drives on maps that lack or outlived something, with a MapChangeDetector.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "map_changes/map_change_detector.h"
#include "offline/fault_injection.h"
#include "offline/wrong_course.h"
#include "racecar_mcl/map/distance_field.h"

namespace racecar_mcl {

struct MapChangeDrive {
  std::string map;                 ///< path of the YAML; the drive starts at the map's start pose
  int boxes = 0;                   ///< static obstacles that the map lacks
  double erased_walls = 0.0;       ///< fraction of the map's walls that the world lacks
  Fault traffic = Fault::kNone;    ///< kCrowd or kOpponent
  std::string map_fault = "none";  ///< of the localizer's map, see sim::mapFaults
  double range_noise = 0.01;       ///< m, standard deviation
  double speed = 3.0;              ///< m/s
  double seconds = 25.0;
  std::uint64_t seed = 1;
};

/// The scene of a drive: the localizer's map, and the world with what changed.
struct ChangedCourse {
  Course course;
  Pose2 start;
  std::vector<sim::Obstacle> boxes;
  OccupancyGrid truth;  ///< the map of the world with the boxes
};

/// A changed cell is found if one of its kind is reported within this distance (m); others are
/// false.
constexpr double kMaxChangeError = 0.1;
/// The scans at the true pose that make a changed cell visible.
constexpr std::uint32_t kVisibleFrom = 40;
constexpr int kTrueBeams = 400;  // of each of these scans

struct MapChangeScore {
  int visible_new = 0, found_new = 0;        ///< cells
  int visible_gone = 0, found_gone = 0;      ///< cells
  int regions = 0, false_regions = 0;        ///< a false region has no cell at a changed one
  double mean_error = 0.0, max_error = 0.0;  ///< m, of the pose

  /// Sums of several drives; the greatest of their greatest errors.
  MapChangeScore& operator+=(const MapChangeScore& drive) {
    visible_new += drive.visible_new;
    found_new += drive.found_new;
    visible_gone += drive.visible_gone;
    found_gone += drive.found_gone;
    regions += drive.regions;
    false_regions += drive.false_regions;
    mean_error += drive.mean_error;
    max_error = std::max(max_error, drive.max_error);
    return *this;
  }
};

/// Throws as loadWrongCourse.
inline ChangedCourse changedCourse(const MapChangeDrive& settings) {
  const LocalizerParameters parameters;
  Random random(settings.seed);
  auto [course, start, wrong] =
      loadWrongCourse(settings.map, settings.map_fault, parameters, random);
  OccupancyGrid truth = course.map->grid;
  if (settings.erased_walls > 0.0) {
    truth = sim::eraseWalls(truth, settings.erased_walls, random);
    course.world = std::make_shared<const sim::World>(truth);
  }
  std::vector<sim::Obstacle> boxes = wrong.boxes;
  if (settings.boxes > 0) {
    const std::vector<sim::Obstacle> more =
        sim::scatterObstacles(*course.world, settings.boxes, 0, start, random, boxes);
    boxes.insert(boxes.end(), more.begin(), more.end());
  }
  truth = sim::withObstacles(truth, boxes, 0.0);
  course.map = makeLocalizationMap(std::move(wrong.map), parameters);
  return {std::move(course), start, std::move(boxes), std::move(truth)};
}

/// Runs a MapChangeDetector on a drive. The scene must outlive it.
class MapChangeEvaluation {
 public:
  MapChangeEvaluation(const MapChangeDrive& settings, const ChangedCourse& scene)
      : scene_(scene), detector_(scene.course.map->grid), seen_(scene.course.map->grid) {
    sim::SimulatorParameters simulator;
    simulator.lidar.range_noise = settings.range_noise;
    SimulatedDrive drive(scene.course, {}, simulator, scene.start, settings.speed, settings.seed);
    drive.localizer().initialize(startAt(scene.start));
    Random random(settings.seed);
    placeObstacles(settings.traffic, scene.course, scene.boxes, settings.seed, random, &drive);
    Scan scan;
    drive.on_scan = [&](Scan* next) {
      scan = *next;
      return true;
    };
    int scans = 0;
    drive.drive(settings.seconds, [&](const Observation& observation) {
      if (!hasEstimate(observation.result.outcome)) return;
      detector_.add(drive.localizer(), scan, observation.result);
      const PoseEstimate truth{observation.base_in_map, Eigen::Matrix3d::Zero()};
      seen_.add(viewOf(truth, drive.localizer().correctedScan(scan, kTrueBeams)));
      score_.mean_error += observation.error;
      score_.max_error = std::max(score_.max_error, observation.error);
      ++scans;
    });
    score_.mean_error /= std::max(1, scans);
    changes_ = detector_.finish();
    judge();
  }

  const MapChanges& changes() const { return changes_; }
  const MapChangeScore& score() const { return score_; }
  std::uint32_t views() const { return detector_.views(); }

 private:
  void judge() {
    const OccupancyGrid& map = scene_.course.map->grid;
    const std::vector<std::uint8_t> before = obstacleMask(map, UnknownIs::kFree);
    const std::vector<std::uint8_t> after = obstacleMask(scene_.truth, UnknownIs::kFree);
    for (const CellChange kind : {CellChange::kNew, CellChange::kGone}) {
      const bool is_new = kind == CellChange::kNew;
      std::vector<std::uint8_t> truth(before.size()), found(before.size());
      for (std::size_t i = 0; i < truth.size(); ++i) {
        truth[i] = before[i] != after[i] && (after[i] != 0) == is_new ? 1 : 0;
        found[i] = changes_.cells[i] == kind ? 1 : 0;
      }
      count(kind, truth, found);
    }
  }

  void count(CellChange kind, const std::vector<std::uint8_t>& truth,
             const std::vector<std::uint8_t>& found) {
    const bool is_new = kind == CellChange::kNew;
    const GridGeometry& geometry = scene_.truth.geometry();
    const std::vector<float> to_found = obstacleDistances(found, geometry.width, geometry.height);
    const std::vector<float> to_truth = obstacleDistances(truth, geometry.width, geometry.height);
    const double reach = kMaxChangeError / geometry.resolution;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const CellViews& views = seen_.cells()[i];
      const bool is_visible = (is_new ? views.ended : views.passed) >= kVisibleFrom;
      if (truth[i] == 0 || !is_visible) continue;
      ++(is_new ? score_.visible_new : score_.visible_gone);
      if (to_found[i] <= reach) ++(is_new ? score_.found_new : score_.found_gone);
    }
    for (const ChangedRegion& region : changes_.regions) {
      if (region.kind != kind) continue;
      ++score_.regions;
      const Cell at = cellAt(geometry, region.centre_in_map);
      const double radius = kMaxChangeError + 0.5 * region.size.norm();
      const double away = to_truth[CellIndex(geometry)(at)] * geometry.resolution;
      score_.false_regions += away > radius ? 1 : 0;
    }
  }

  const ChangedCourse& scene_;
  MapChangeDetector detector_;
  CellEvidence seen_;  ///< at the true poses
  MapChanges changes_;
  MapChangeScore score_;
};

}  // namespace racecar_mcl
