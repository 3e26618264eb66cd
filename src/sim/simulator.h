// The simulated car in its world: commands in, sensor events out, in the order in which they would
// arrive.
#pragma once

#include <memory>
#include <variant>
#include <vector>

#include "sim/car.h"
#include "sim/lidar.h"
#include "sim/odometry.h"
#include "sim/world.h"

namespace racecar_mcl::sim {

struct SimulatorParameters {
  CarParameters car;
  LidarParameters lidar;
  OdometryParameters odometry;
  double truth_rate = 100.0;  ///< Hz

  /// Throws ParameterError, naming the field.
  void validate() const;
};

/// Where the car truly is.
struct Truth {
  double stamp = 0.0;  ///< s
  Pose2 base_in_map;
  Twist2 twist;
};

/// Something that reaches the computer on the car at `arrival` (s). A sweep arrives with its last
/// beam.
struct Event {
  double arrival = 0.0;
  std::variant<LidarScan, OdometrySample, Truth> data;
};

/// Same seed, same commands, same bits. The noise of one sensor is independent of the others'
/// parameters.
class Simulator {
 public:
  /// The clock starts at `start_time` (s). Throws ParameterError.
  Simulator(std::shared_ptr<const World> world, const SimulatorParameters& parameters,
            const Pose2& base_in_map, std::uint64_t seed, double start_time = 0.0);

  /// Drives on for `seconds`, in steps of 1 ms; what is left over counts towards the next call.
  /// Returns what arrived meanwhile, oldest first. A car that meets an obstacle or what is not
  /// known to be free stands before it, and can go back. Throws ParameterError on a command or a
  /// time that is not finite.
  std::vector<Event> advance(double seconds, const Command& command);

  /// Holds from the next sweep and the next message on. Throws ParameterError and changes nothing.
  void setParameters(const SimulatorParameters& parameters);
  const SimulatorParameters& parameters() const { return parameters_; }

  /// Replaces all obstacles; moving ones are on their paths by the simulator's clock. Throws
  /// ParameterError and changes nothing.
  void setObstacles(std::vector<Obstacle> obstacles);
  const std::vector<Obstacle>& obstacles() const { return obstacles_; }

  /// Lifts the car and puts it down elsewhere, standing still. Its odometry notices nothing. Throws
  /// ParameterError on a pose that is not finite.
  void place(const Pose2& base_in_map);

  /// What a lidar without faults (no noise, no missing returns, no glass) would see from here at
  /// once, were everything a wall that is not known to be free. Obstacles that keep clear of the
  /// car are not looked at. A driver who looks with it drives the same way whatever the sensors are
  /// set to.
  LidarScan look() const;

  double time() const;
  Truth truth() const;

  /// Whether the car stands against something now, and how often it has run into something.
  bool collided() const { return collided_; }
  int collisions() const { return collisions_; }

 private:
  void step(const Command& command, std::vector<Event>& events);
  Arc move(const Command& command, double begin, double end);

  std::shared_ptr<const World> world_;
  SimulatorParameters parameters_;
  std::vector<Obstacle> obstacles_;
  Lidar lidar_;
  WheelOdometry odometry_;
  Metronome truths_;
  CarState car_;
  double start_time_;
  long ticks_ = 0;
  double pending_ = 0.0;  ///< s asked for and not yet driven
  bool collided_ = false;
  int collisions_ = 0;
};

}  // namespace racecar_mcl::sim
