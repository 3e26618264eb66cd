// Laps along a raceline: lap times, lateral and localization errors, and scans at the map's bounds.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "evaluation/drive_evaluation.h"
#include "racecar_mcl/map/occupancy_grid.h"
#include "racecar_mcl/scan/scan.h"

namespace racecar_mcl {

struct RaceScore {
  PositionErrors lateral;         ///< m, distances of the true pose from the raceline
  PositionErrors along;           ///< m, of the estimates that the car was driven on, in the
  PositionErrors across;          ///< direction of the true heading and across it
  std::vector<double> lap_times;  ///< s
  double max_speed = 0.0;         ///< m/s
  long returns = 0;               ///< of all scans, without those from opponents
  long returns_at_bounds = 0;     ///< of these, see BoundsMatch
  long scans = 0;
  long scans_localized = 0;     ///< of these, with the status `localized`
  long scans_beyond_level = 0;  ///< of these, with an error beyond the protection level
  int collisions = 0;

  /// Adds the error of an estimate on which the car is driven.
  void addEstimate(const Pose2& estimate, const Pose2& true_pose);
  /// Adds the status of a scan, whose estimate has this error.
  void addStatus(const LocalizationStatus& status, const Pose2& estimate, const Pose2& true_pose);

  /// s; 0 without laps.
  double meanLapTime() const;
  /// s, standard deviation; 0 without laps.
  double lapTimeDeviation() const;
  /// 0 without returns.
  double shareAtBounds() const;
  /// 0 without scans.
  double shareLocalized() const;
  /// 0 without scans that are localized.
  double shareBeyondLevel() const;
  RaceScore& operator+=(const RaceScore& other);
};

/// Times laps by the distance along a closed course.
class LapTimer {
 public:
  /// `length`: m, of the course.
  explicit LapTimer(double length) : length_(length) {}

  /// The car's place on the course, m from the finish line, at increasing stamps (s). The car moves
  /// less than half a lap between updates.
  void update(double along, double stamp);

  /// Complete laps.
  int laps() const;
  /// s, without the first lap, which is from standing.
  const std::vector<double>& lapTimes() const { return lap_times_; }

 private:
  double length_;
  double driven_ = 0.0;      ///< m
  double last_stamp_ = 0.0;  ///< s
  double lap_began_ = 0.0;   ///< s
  std::vector<double> lap_times_;
};

/// Whether scans fit the bounds of the track: the returns within 0.1 m of an obstacle of the map.
class BoundsMatch {
 public:
  explicit BoundsMatch(const OccupancyGrid& map);

  /// Adds a deskewed scan taken at `base_in_map` to the score, without the returns at points of the
  /// map for which `is_ignored`.
  void add(const Scan& scan, const Pose2& base_in_map,
           const std::function<bool(const Eigen::Vector2d&)>& is_ignored, RaceScore* score) const;

  static constexpr double kMaxDistance = 0.1;  ///< m

 private:
  double distanceAt(const Eigen::Vector2d& point_in_map) const;

  GridGeometry geometry_;
  std::vector<float> distances_;  ///< cells, between the centres of a cell and the nearest obstacle
};

}  // namespace racecar_mcl
