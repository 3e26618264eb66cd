#include "sim/simulator.h"

#include <algorithm>
#include <iterator>

#include "racecar_mcl/common/validation.h"

namespace racecar_mcl::sim {
namespace {

constexpr double kTicksPerSecond = 1000.0;
constexpr double kLeavingClearance = 0.01;  // m
// Streams of random numbers, apart from the others.
constexpr std::uint64_t kGyroStream = 0x6779726fULL;
constexpr std::uint64_t kRearLidarStream = 0x72656172ULL;
constexpr double kRearLidarPhase = 0.4;  // of its sweeps behind those in front, in periods

const SimulatorParameters& validated(const SimulatorParameters& parameters) {
  parameters.validate();
  return parameters;
}

}  // namespace

void SimulatorParameters::validate() const {
  car.validate();
  lidar.validate();
  rearLidar().validate();
  odometry.validate();
  gyro.validate();
  requirePositiveUpTo("truth_rate", truth_rate, 1000.0, "Hz");
}

LidarParameters SimulatorParameters::rearLidar() const {
  LidarParameters rear = lidar;
  rear.range_bias = rear_lidar.range_bias;
  rear.clockwise = rear_lidar.clockwise;
  rear.laser_in_base = rear_lidar.laser_in_base;
  return rear;
}

Simulator::Simulator(std::shared_ptr<const World> world, const SimulatorParameters& parameters,
                     const Pose2& base_in_map, std::uint64_t seed, double start_time)
    : world_(std::move(world)),
      parameters_(validated(parameters)),
      lidars_{Lidar(parameters.lidar, Random(seed)(), start_time)},
      odometry_(parameters.odometry, Random(~seed)(), start_time),
      gyro_(parameters.gyro, Random(seed ^ kGyroStream)(), start_time),
      truths_(parameters.truth_rate, start_time),
      start_time_(start_time) {
  if (parameters.rear_lidar.enabled) {
    lidars_.emplace_back(parameters.rearLidar(), Random(seed ^ kRearLidarStream)(),
                         start_time + kRearLidarPhase / parameters.lidar.rate);
  }
  place(base_in_map);
}

std::vector<Event> Simulator::advance(double seconds, const Command& command) {
  requireNotNegative("simulated time", seconds, "s");
  requireFinite("commanded speed", command.speed, "m/s");
  requireFinite("commanded steering", command.steering, "rad");
  std::vector<Event> events;
  pending_ += seconds;
  // A tolerance of 0.5 ns, so that ten steps of 0.1 s are 1 s.
  const auto steps = static_cast<long>(std::floor((pending_ + 5e-10) * kTicksPerSecond));
  pending_ -= static_cast<double>(steps) / kTicksPerSecond;
  for (long i = 0; i < steps; ++i) step(command, events);
  return events;
}

void Simulator::step(const Command& command, std::vector<Event>& events) {
  const double begin = time();
  ++ticks_;
  const Arc arc = move(command, begin, time());

  const std::size_t first = events.size();
  while (truths_.next() < arc.end) {
    const double stamp = truths_.next();
    events.push_back({stamp, Truth{stamp, arc.at(stamp), arc.twist}});
    truths_.setRate(parameters_.truth_rate);
    truths_.advance();
  }
  CarState commanded = car_;
  commanded.steering =
      std::clamp(command.steering, -parameters_.car.max_steering, parameters_.car.max_steering);
  if (const auto sample = odometry_.measure(arc, twistOf(commanded, parameters_.car).wz)) {
    events.push_back({sample->stamp, *sample});
  }
  if (const auto sample = gyro_.measure(arc)) events.push_back({sample->stamp, *sample});
  for (std::size_t i = 0; i < lidars_.size(); ++i) {
    std::optional<LidarScan> sweep = lidars_[i].measure(arc, *world_, obstacles_);
    if (!sweep) continue;
    sweep->lidar = static_cast<int>(i);
    const double arrival = sweep->arrival;
    events.push_back({arrival, std::move(*sweep)});
  }
  std::stable_sort(events.begin() + static_cast<std::ptrdiff_t>(first), events.end(),
                   [](const Event& a, const Event& b) { return a.arrival < b.arrival; });
}

Arc Simulator::move(const Command& command, double begin, double end) {
  steering_.push_back(command.steering);
  while (static_cast<double>(steering_.size() - 1) >
         parameters_.car.steering_delay * kTicksPerSecond) {
    steering_.pop_front();
  }
  car_ = followCommand(car_, {command.speed, steering_.front()}, parameters_.car, end - begin);
  Arc arc{begin, end, car_.base_in_map, twistOf(car_, parameters_.car)};
  const Pose2 there = arc.at(end);
  const bool blocked = touches(there, parameters_.car, *world_, obstacles_, end);
  // A car that already overlaps an obstacle (placed there, or hit by it) may drive out of it, but
  // not into a wall.
  const auto enters = [&](const std::vector<Obstacle>& obstacles) {
    return touches(there, parameters_.car, *world_, obstacles, end) &&
           !touches(arc.base_in_map, parameters_.car, *world_, obstacles, begin);
  };
  if (blocked && !collided_) ++collisions_;
  // A collision ends when the car has left the wall.
  collided_ = blocked || (collided_ && touches(there, parameters_.car, *world_, obstacles_, end,
                                               kLeavingClearance));
  if (blocked && (enters(obstacles_) || enters({}))) {
    car_.speed = 0.0;
    arc.twist = {};
    return arc;
  }
  car_.base_in_map = there;
  return arc;
}

void Simulator::setParameters(const SimulatorParameters& parameters) {
  parameters.validate();
  parameters_ = parameters;
  lidars_.front().setParameters(parameters.lidar);
  if (lidars_.size() > 1) lidars_.back().setParameters(parameters.rearLidar());
  odometry_.setParameters(parameters.odometry);
  gyro_.setParameters(parameters.gyro);
}

void Simulator::setObstacles(std::vector<Obstacle> obstacles) {
  for (const Obstacle& obstacle : obstacles) obstacle.validate();
  obstacles_ = std::move(obstacles);
}

void Simulator::place(const Pose2& base_in_map) {
  requireFinite("x of the car's place", base_in_map.x, "m");
  requireFinite("y of the car's place", base_in_map.y, "m");
  requireFinite("yaw of the car's place", base_in_map.yaw, "rad");
  car_ = {base_in_map, 0.0, 0.0};
  car_.base_in_map.yaw = wrapAngle(base_in_map.yaw);
}

LidarScan Simulator::look() const {
  LidarParameters ideal;
  ideal.instant = true;
  ideal.beams = 541;
  ideal.range_noise = 0.0;
  ideal.missing_rate = 0.0;
  ideal.ends = Ends::kWhereNotFree;
  ideal.laser_in_base = parameters_.lidar.laser_in_base;
  const Arc here{time(), time() + 1.0 / kTicksPerSecond, car_.base_in_map, {}};
  std::vector<Obstacle> visible;
  std::copy_if(obstacles_.begin(), obstacles_.end(), std::back_inserter(visible),
               [](const Obstacle& obstacle) { return !obstacle.keeps_clear; });
  return Lidar(ideal, 0, here.begin).measure(here, *world_, visible).value();
}

double Simulator::time() const {
  return start_time_ + static_cast<double>(ticks_) / kTicksPerSecond;
}

Truth Simulator::truth() const {
  return {time(), car_.base_in_map, twistOf(car_, parameters_.car)};
}

}  // namespace racecar_mcl::sim
