// Simulator of a car in its world: turns commands into sensor events in order of arrival.
#pragma once

#include <deque>
#include <memory>
#include <variant>
#include <vector>

#include "sim/car.h"
#include "sim/gyro.h"
#include "sim/lidar.h"
#include "sim/odometry.h"
#include "sim/world.h"

namespace racecar_mcl::sim {

/// A second lidar, which differs from the first one in these values.
struct RearLidarParameters {
  bool enabled = false;  ///< read at the start only
  double range_bias = 0.0;
  bool clockwise = false;
  Pose2 laser_in_base{-0.1, 0.0, kPi};  ///< facing back
};

struct SimulatorParameters {
  CarParameters car;
  LidarParameters lidar;
  RearLidarParameters rear_lidar;
  OdometryParameters odometry;
  GyroParameters gyro;
  double truth_rate = 100.0;  ///< Hz

  /// Throws ParameterError, naming the field.
  void validate() const;
  /// Those of `lidar`, with the values of `rear_lidar`.
  LidarParameters rearLidar() const;
};

/// The true state of the car.
struct Truth {
  double stamp = 0.0;  ///< s
  Pose2 base_in_map;
  Twist2 twist;
};

/// A measurement that arrives at the car's computer at `arrival` (s); a sweep arrives with its last
/// beam.
struct Event {
  double arrival = 0.0;
  std::variant<LidarScan, OdometrySample, GyroSample, Truth> data;
};

/// Deterministic for the same seed and commands. The noise of a sensor is independent of the other
/// sensors' parameters.
class Simulator {
 public:
  /// The clock starts at `start_time` (s). Throws ParameterError.
  Simulator(std::shared_ptr<const World> world, const SimulatorParameters& parameters,
            const Pose2& base_in_map, std::uint64_t seed, double start_time = 0.0);

  /// Simulates `seconds` in steps of 1 ms; the remainder is added to the next call. Returns the
  /// events, oldest first. A car that collides with an obstacle or non-free space stops and can
  /// back off. Throws ParameterError if the command or the time is not finite.
  std::vector<Event> advance(double seconds, const Command& command);

  /// Takes effect with the next sweep and message. Throws ParameterError without changing anything.
  void setParameters(const SimulatorParameters& parameters);
  const SimulatorParameters& parameters() const { return parameters_; }

  /// Replaces all obstacles; moving ones follow the simulator's clock. Throws ParameterError
  /// without changing anything.
  void setObstacles(std::vector<Obstacle> obstacles);
  const std::vector<Obstacle>& obstacles() const { return obstacles_; }

  /// Moves the car to a pose, stopped (kidnapped robot): odometry does not measure it. Throws
  /// ParameterError if the pose is not finite.
  void place(const Pose2& base_in_map);

  /// An instant sweep of an ideal lidar (no noise, missing returns or glass) that sees all space
  /// not known to be free as walls, except obstacles that keep clear of the car. For drivers, whose
  /// commands then do not depend on the sensor parameters.
  LidarScan look() const;

  double time() const;
  Truth truth() const;

  /// Whether the car is in contact with an obstacle, and the number of collisions.
  bool collided() const { return collided_; }
  int collisions() const { return collisions_; }

 private:
  void step(const Command& command, std::vector<Event>& events);
  Arc move(const Command& command, double begin, double end);

  std::shared_ptr<const World> world_;
  SimulatorParameters parameters_;
  std::vector<Obstacle> obstacles_;
  std::vector<Lidar> lidars_;  ///< by LidarScan::lidar
  WheelOdometry odometry_;
  Gyro gyro_;
  PeriodicTimer truths_;
  CarState car_;
  std::deque<double> steering_;  ///< rad, commands of the last steering_delay
  double start_time_;
  long ticks_ = 0;
  double pending_ = 0.0;  ///< s requested but not yet simulated
  bool collided_ = false;
  int collisions_ = 0;
};

}  // namespace racecar_mcl::sim
