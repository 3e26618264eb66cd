// Scanning lidar; beams are measured one after another while the car moves.
#pragma once

#include <optional>
#include <vector>

#include "racecar_mcl/common/random.h"
#include "racecar_mcl/scan/scan.h"
#include "sim/car.h"
#include "sim/periodic_timer.h"
#include "sim/world.h"

namespace racecar_mcl::sim {

/// Defaults of a Hokuyo UST-10LX.
struct LidarParameters {
  double rate = 40.0;                ///< Hz, sweeps
  int beams = 1081;                  ///< per sweep
  double field_of_view = 1.5 * kPi;  ///< rad, first to last beam, symmetric about the x axis
  double sweep_time = 0.01875;       ///< s, first to last beam: 3/4 of a rotation at 40 Hz
  bool instant = false;              ///< all beams at once
  bool clockwise = false;            ///< beams in reverse acquisition order, stamped with the first
                                     ///< of the list, as by RPLIDAR drivers
  double range_noise = 0.01;         ///< m, standard deviation
  double range_bias = 0.0;           ///< m, added to every range
  double missing_rate = 0.005;       ///< fraction of beams without return
  double dropout_rate = 0.0;         ///< fraction of lost sweeps
  double range_min = 0.06;           ///< m
  double range_max = 10.0;           ///< m
  Pose2 laser_in_base{0.27, 0.0, 0.0};
  Ends ends = Ends::kAtWalls;  ///< what beams end at
  Glass glass;

  /// Throws ParameterError, naming the field.
  void validate() const;
};

/// One sweep, as in sensor_msgs/LaserScan. +infinity: no return; -infinity: too close to measure.
struct LidarScan {
  int lidar = 0;         ///< 0: in front; 1: the rear lidar
  double stamp = 0.0;    ///< s, of the first beam of the list
  double arrival = 0.0;  ///< s, time of the last beam
  double angle_min = 0.0;
  double angle_increment = 0.0;
  double time_increment = 0.0;
  double scan_time = 0.0;  ///< s, between sweeps
  double range_min = 0.0;
  double range_max = 0.0;
  Pose2 laser_in_base;
  std::vector<float> ranges;
};

/// Converts a sweep for the localizer; drops beams that were too close.
Scan toScan(const LidarScan& sweep);

class Lidar {
 public:
  Lidar(const LidarParameters& parameters, std::uint64_t seed, double start);

  /// Takes effect with the next sweep.
  void setParameters(const LidarParameters& parameters) { parameters_ = parameters; }

  /// Measures the beams in [arc.begin, arc.end), each from the car's pose at its time. Returns the
  /// sweep if this includes its last beam.
  std::optional<LidarScan> measure(const Arc& arc, const World& world,
                                   const std::vector<Obstacle>& obstacles);

 private:
  void beginSweep();
  float measureBeam(const Pose2& laser_in_map, double bearing, double time, const World& world,
                    const std::vector<Obstacle>& obstacles);

  LidarParameters parameters_;
  LidarParameters current_;  ///< of the current sweep
  Random random_;
  PeriodicTimer sweeps_;
  LidarScan sweep_;  ///< incomplete while `sweeping_`
  bool sweeping_ = false;
};

}  // namespace racecar_mcl::sim
