#include "evaluation/race_evaluation.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "racecar_mcl/map/distance_field.h"

namespace racecar_mcl {
namespace {

double share(long part, long all) {
  return all > 0 ? static_cast<double>(part) / static_cast<double>(all) : 0.0;
}

}  // namespace

double RaceScore::meanLapTime() const {
  if (lap_times.empty()) return 0.0;
  return std::accumulate(lap_times.begin(), lap_times.end(), 0.0) /
         static_cast<double>(lap_times.size());
}

double RaceScore::lapTimeDeviation() const {
  if (lap_times.empty()) return 0.0;
  const double mean = meanLapTime();
  double squared = 0.0;
  for (const double time : lap_times) squared += (time - mean) * (time - mean);
  return std::sqrt(squared / static_cast<double>(lap_times.size()));
}

double RaceScore::shareAtBounds() const { return share(returns_at_bounds, returns); }
double RaceScore::shareLocalized() const { return share(scans_localized, scans); }
double RaceScore::shareBeyondLevel() const { return share(scans_beyond_level, scans_localized); }

void RaceScore::addEstimate(const Pose2& estimate, const Pose2& true_pose) {
  const Pose2 error = between(true_pose, estimate);
  along.add(std::abs(error.x));
  across.add(std::abs(error.y));
}

void RaceScore::addStatus(const LocalizationStatus& status, const Pose2& estimate,
                          const Pose2& true_pose) {
  ++scans;
  if (status.state != LocalizationState::kLocalized) return;
  ++scans_localized;
  const Pose2 error = between(true_pose, estimate);
  if (std::abs(error.x) > status.level.along || std::abs(error.y) > status.level.across ||
      std::abs(error.yaw) > status.level.heading) {
    ++scans_beyond_level;
  }
}

RaceScore& RaceScore::operator+=(const RaceScore& other) {
  lateral.add(other.lateral);
  along.add(other.along);
  across.add(other.across);
  lap_times.insert(lap_times.end(), other.lap_times.begin(), other.lap_times.end());
  max_speed = std::max(max_speed, other.max_speed);
  returns += other.returns;
  returns_at_bounds += other.returns_at_bounds;
  scans += other.scans;
  scans_localized += other.scans_localized;
  scans_beyond_level += other.scans_beyond_level;
  collisions += other.collisions;
  return *this;
}

int LapTimer::laps() const { return static_cast<int>(std::floor(driven_ / length_)); }

void LapTimer::update(double along, double stamp) {
  const int laps_before = laps();
  const double before = driven_;
  driven_ += std::remainder(along - driven_, length_);
  if (laps() > laps_before) {
    const double fraction = (laps() * length_ - before) / (driven_ - before);
    const double crossed = last_stamp_ + fraction * (stamp - last_stamp_);
    if (laps_before > 0) lap_times_.push_back(crossed - lap_began_);
    lap_began_ = crossed;
  }
  last_stamp_ = stamp;
}

BoundsMatch::BoundsMatch(const OccupancyGrid& map)
    : geometry_(map.geometry()),
      distances_(obstacleDistances(obstacleMask(map, UnknownIs::kFree), geometry_.width,
                                   geometry_.height)) {}

void BoundsMatch::add(const Scan& scan, const Pose2& base_in_map,
                      const std::function<bool(const Eigen::Vector2d&)>& is_ignored,
                      RaceScore* score) const {
  const Eigen::Matrix2Xd ends = endPoints(compose(base_in_map, scan.laser_in_base), scan);
  for (Eigen::Index i = 0; i < scan.size(); ++i) {
    if (!std::isfinite(scan.ranges[i])) continue;
    const Eigen::Vector2d point = ends.col(i);
    if (is_ignored(point)) continue;
    ++score->returns;
    score->returns_at_bounds += distanceAt(point) <= kMaxDistance ? 1 : 0;
  }
}

double BoundsMatch::distanceAt(const Eigen::Vector2d& point_in_map) const {
  const Cell cell = cellAt(geometry_, point_in_map);
  if (!contains(geometry_, cell)) return HUGE_VAL;
  return geometry_.resolution * static_cast<double>(distances_[CellIndex(geometry_)(cell)]);
}

}  // namespace racecar_mcl
