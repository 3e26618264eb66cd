// A scanning lidar like a Hokuyo: its beams are taken one after another while the car moves.
#pragma once

#include <optional>
#include <vector>

#include "racecar_mcl/random.h"
#include "racecar_mcl/scan.h"
#include "sim/car.h"
#include "sim/metronome.h"
#include "sim/world.h"

namespace racecar_mcl::sim {

/// Defaults as a Hokuyo UST-10LX.
struct LidarParameters {
  double rate = 40.0;                ///< Hz, sweeps
  int beams = 1081;                  ///< per sweep
  double field_of_view = 1.5 * kPi;  ///< rad, first to last beam, centred ahead
  double sweep_time = 0.01875;       ///< s, first to last beam: 3/4 of a turn at 40 Hz
  bool instant = false;              ///< all beams at once, as no such lidar does
  bool clockwise = false;            ///< turns so, and is listed against the time and stamped with
                                     ///< the first of the list, as by drivers of an RPLIDAR
  double range_noise = 0.01;         ///< m, standard deviation
  double missing_rate = 0.005;       ///< share of beams that return nothing
  double dropout_rate = 0.0;         ///< share of sweeps that never arrive
  double range_min = 0.06;           ///< m
  double range_max = 10.0;           ///< m
  Pose2 laser_in_base{0.27, 0.0, 0.0};
  Ends ends = Ends::kAtWalls;  ///< of a beam
  Glass glass;

  /// Throws ParameterError, naming the field.
  void validate() const;
};

/// One sweep, as sensor_msgs/LaserScan has it. +infinity: nothing came back; -infinity: too close
/// to measure.
struct LidarScan {
  double stamp = 0.0;    ///< s, of the first beam of the list
  double arrival = 0.0;  ///< s, of the last beam: before that nobody can have it
  double angle_min = 0.0;
  double angle_increment = 0.0;
  double time_increment = 0.0;
  double scan_time = 0.0;  ///< s, between sweeps
  double range_min = 0.0;
  double range_max = 0.0;
  Pose2 laser_in_base;
  std::vector<float> ranges;
};

/// The sweep as the localizer takes it: beams that were too close are dropped.
Scan toScan(const LidarScan& sweep);

class Lidar {
 public:
  Lidar(const LidarParameters& parameters, std::uint64_t seed, double start);

  /// Holds from the next sweep on.
  void setParameters(const LidarParameters& parameters) { parameters_ = parameters; }

  /// Takes the beams due in [arc.begin, arc.end), each from where the car is at that beam's
  /// time. Returns the sweep when its last beam is among them.
  std::optional<LidarScan> measure(const Arc& arc, const World& world,
                                   const std::vector<Obstacle>& obstacles);

 private:
  void beginSweep();
  float measureBeam(const Pose2& laser_in_map, double bearing, double time, const World& world,
                    const std::vector<Obstacle>& obstacles);

  LidarParameters parameters_;
  LidarParameters current_;  ///< of the sweep under way
  Random random_;
  Metronome sweeps_;
  LidarScan sweep_;  ///< under way while `sweeping_`
  bool sweeping_ = false;
};

}  // namespace racecar_mcl::sim
