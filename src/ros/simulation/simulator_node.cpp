#include "ros/simulation/simulator_node.h"

#include <geometry_msgs/PoseWithCovarianceStamped.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "racecar_mcl/common/errors.h"
#include "ros/conversions/message_conversions.h"

namespace racecar_mcl {
namespace {

constexpr double kStep = 0.01;                     // s of simulated time
constexpr long kStepsPerCommand = 2;               // of the wall follower
constexpr long kStepsPerMarkers = 10;              // of moving obstacles
constexpr double kInitialTime = 1000.0;            // s; ROS treats 0 as unset
constexpr double kMinRollingSpeed = 0.1;           // m/s; limits the steering angle
constexpr std::chrono::milliseconds kMaxLag{200};  // of wall time; a longer lag is skipped

bool isClock() {
  bool use_sim_time = false;
  ros::param::get("/use_sim_time", use_sim_time);
  return use_sim_time;
}

SimulatorNodeParameters readParameters(const ros::NodeHandle& private_node, bool is_clock) {
  SimulatorNodeParameters parameters = readSimulatorParameters(private_node);
  if (parameters.real_time_factor != 1.0 && !is_clock) {
    throw ParameterError(
        "real_time_factor is " + std::to_string(parameters.real_time_factor) +
        "; it must be 1 without /use_sim_time, which makes the simulator the clock");
  }
  return parameters;
}

void requireMapFrame(const std::string& frame) {
  if (!frame.empty() && stripLeadingSlash(frame) != "map") {
    throw MessageError("the frame is '" + printable(frame) + "'; expected 'map'");
  }
}

}  // namespace

SimulatorNode::SimulatorNode(ros::NodeHandle node, ros::NodeHandle private_node)
    : private_node_(private_node),
      is_clock_(isClock()),
      parameters_(readParameters(private_node, is_clock_)),
      scenario_(sim::loadScenario(parameters_.scenario)),
      simulator_(scenario_.world, parameters_.simulator, scenario_.start_in_map,
                 parameters_.scenario.seed,
                 is_clock_ ? kInitialTime : ros::WallTime::now().toSec()),
      driver_(parameters_.follower),
      laps_(scenario_.start_in_map),
      lap_start_(simulator_.time()),
      publisher_(node, private_node, parameters_, is_clock_) {
  simulator_.setObstacles(scenario_.obstacles);
  if (parameters_.announce_start) {
    start_announcer_ = node.advertise<geometry_msgs::PoseWithCovarianceStamped>(
        "initialpose", 1, [this](const ros::SingleSubscriberPublisher& subscriber) {
          onStartSubscriber(subscriber);
        });
  }
  subscribers_ = {
      node.subscribe("cmd_vel", 1, &SimulatorNode::onTwist, this),
      private_node.subscribe("place", 1, &SimulatorNode::onPlace, this),
      private_node.subscribe("add_obstacle", 10, &SimulatorNode::onObstacle, this),
      private_node.subscribe("add_moving_obstacle", 10, &SimulatorNode::onMovingObstacle, this)};
#ifdef RACECAR_MCL_HAS_ACKERMANN
  subscribers_.push_back(node.subscribe("drive", 1, &SimulatorNode::onDrive, this));
#endif
  services_ = {
      private_node.advertiseService("clear_obstacles", &SimulatorNode::onClearObstacles, this),
      private_node.advertiseService("reload_parameters", &SimulatorNode::onReload, this)};
  const Pose2& start = scenario_.start_in_map;
  ROS_INFO("simulating %s from (%.2f, %.2f, %.2f)", scenario_.world_path.c_str(), start.x, start.y,
           start.yaw);
  thread_ = std::thread([this] { run(); });
}

SimulatorNode::~SimulatorNode() {
  start_announcer_.shutdown();
  for (ros::Subscriber& subscriber : subscribers_) subscriber.shutdown();
  for (ros::ServiceServer& service : services_) service.shutdown();
  stopping_ = true;
  thread_.join();
}

void SimulatorNode::run() {
  using Clock = std::chrono::steady_clock;
  auto due = Clock::now();
  while (!stopping_ && ros::ok()) {
    double real_time_factor;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      real_time_factor = parameters_.real_time_factor;
    }
    due += std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(kStep / real_time_factor));
    const auto late = Clock::now() - due;
    if (late > kMaxLag) {
      // Catching up would flood subscribers. With simulated time the clock has simply paused.
      if (!is_clock_) {
        const std::lock_guard<std::mutex> lock(mutex_);
        publisher_.addDelay(std::chrono::duration<double>(late).count());
      }
      due = Clock::now();
    }
    std::this_thread::sleep_until(due);
    publish(step());
  }
}

SimulatorNode::Step SimulatorNode::step() {
  const std::lock_guard<std::mutex> lock(mutex_);
  Step step;
  if (steps_ % kStepsPerCommand == 0) current_command_ = nextCommand();
  step.events = simulator_.advance(kStep, current_command_);
  step.now = simulator_.time();
  step.parameters = parameters_;
  if (simulator_.collisions() > collisions_) {
    collisions_ = simulator_.collisions();
    step.collisions = collisions_;
  }
  const std::vector<sim::Obstacle>& obstacles = simulator_.obstacles();
  const bool moving = std::any_of(obstacles.begin(), obstacles.end(),
                                  [](const sim::Obstacle& o) { return o.speed > 0.0; });
  if (obstacles_changed_ || (moving && steps_ % kStepsPerMarkers == 0)) step.obstacles = obstacles;
  obstacles_changed_ = false;
  countLaps();
  ++steps_;
  return step;
}

sim::Command SimulatorNode::nextCommand() {
  if (parameters_.driver != Driver::kWallFollower && command_ &&
      simulator_.time() < command_until_) {
    return *command_;
  }
  if (parameters_.driver == Driver::kCommands) return {};
  return driver_.drive(simulator_.look(), simulator_.truth().twist.vx, simulator_.collided());
}

void SimulatorNode::countLaps() {
  const int before = laps_.laps();
  laps_.update(simulator_.truth().base_in_map);
  if (laps_.laps() == before) return;
  const double now = simulator_.time();
  ROS_INFO("lap %d: %.1f s, %d collisions in total", laps_.laps(), now - lap_start_, collisions_);
  lap_start_ = now;
}

void SimulatorNode::publish(const Step& step) {
  if (is_clock_) publisher_.publishClock(step.now);
  for (const sim::Event& event : step.events) publisher_.publish(event, step.parameters);
  if (step.obstacles) publisher_.publishObstacles(*step.obstacles, step.now);
  if (step.collisions) {
    if (log_throttle_.isDue()) ROS_WARN("collision of the car (%d in total)", *step.collisions);
    publisher_.publishCollisions(*step.collisions);
  }
}

void SimulatorNode::setCommand(const sim::Command& command) {
  if (!std::isfinite(command.speed) || !std::isfinite(command.steering)) {
    warnThrottled(&log_throttle_, "command dropped", "speed and steering must be finite");
    return;
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  command_ = command;
  command_until_ = simulator_.time() + parameters_.command_timeout;
}

void SimulatorNode::onTwist(const geometry_msgs::TwistConstPtr& message) {
  // wz = speed tan(steering) / wheelbase. A minimum speed lets the wheels of a stopped car turn.
  const double speed = message->linear.x;
  double wheelbase;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    wheelbase = parameters_.simulator.car.wheelbase;
  }
  const double rolling =
      std::abs(speed) < kMinRollingSpeed ? std::copysign(kMinRollingSpeed, speed) : speed;
  setCommand({speed, std::atan(message->angular.z * wheelbase / rolling)});
}

#ifdef RACECAR_MCL_HAS_ACKERMANN
void SimulatorNode::onDrive(const ackermann_msgs::AckermannDriveStampedConstPtr& message) {
  setCommand({message->drive.speed, message->drive.steering_angle});
}
#endif

void SimulatorNode::onPlace(const geometry_msgs::PoseStampedConstPtr& message) {
  try {
    requireMapFrame(message->header.frame_id);
    const Pose2 pose = toPose2(message->pose);
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!scenario_.world->isFree({pose.x, pose.y}) ||
        sim::overlaps(pose, parameters_.simulator.car, *scenario_.world, simulator_.obstacles(),
                      simulator_.time())) {
      throw MessageError("the car would collide there");
    }
    simulator_.place(pose);
    laps_ = sim::LapCounter(pose);
    lap_start_ = simulator_.time();
    if (log_throttle_.isDue()) ROS_INFO("placed at (%.2f, %.2f, %.2f)", pose.x, pose.y, pose.yaw);
  } catch (const std::exception& error) {
    warnThrottled(&log_throttle_, "place rejected", error.what());
  }
}

void SimulatorNode::onObstacle(const geometry_msgs::PointStampedConstPtr& message) {
  try {
    requireMapFrame(message->header.frame_id);
    sim::Obstacle disc;
    disc.in_map = {message->point.x, message->point.y, 0.0};
    addObstacle(disc);
  } catch (const std::exception& error) {
    warnThrottled(&log_throttle_, "add_obstacle rejected", error.what());
  }
}

void SimulatorNode::onMovingObstacle(const geometry_msgs::PoseStampedConstPtr& message) {
  try {
    requireMapFrame(message->header.frame_id);
    const Pose2 start = toPose2(message->pose);
    sim::Obstacle disc;
    disc.path = {{start.x, start.y}};
    disc.in_map = start;
    addObstacle(disc);
  } catch (const std::exception& error) {
    warnThrottled(&log_throttle_, "add_moving_obstacle rejected", error.what());
  }
}

void SimulatorNode::addObstacle(sim::Obstacle obstacle) {
  const std::lock_guard<std::mutex> lock(mutex_);
  obstacle.radius = parameters_.obstacle_radius;
  if (!obstacle.path.empty()) {
    const Pose2 turn = compose(obstacle.in_map, {parameters_.obstacle_walk, 0.0, 0.0});
    obstacle.path.push_back({turn.x, turn.y});
    obstacle.speed = parameters_.obstacle_speed;
    obstacle.start_time = simulator_.time();
  }
  std::vector<sim::Obstacle> obstacles = simulator_.obstacles();
  obstacles.push_back(std::move(obstacle));
  simulator_.setObstacles(std::move(obstacles));
  obstacles_changed_ = true;
}

void SimulatorNode::onStartSubscriber(const ros::SingleSubscriberPublisher& subscriber) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const sim::Truth truth = simulator_.truth();
  publisher_.announce(subscriber, truth.base_in_map, truth.stamp);
}

bool SimulatorNode::onClearObstacles(std_srvs::Empty::Request&, std_srvs::Empty::Response&) {
  const std::lock_guard<std::mutex> lock(mutex_);
  simulator_.setObstacles({});
  obstacles_changed_ = true;
  return true;
}

bool SimulatorNode::onReload(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  try {
    const SimulatorNodeParameters read = readParameters(private_node_, is_clock_);
    SimulatorNodeParameters old;
    Pose2 base_in_map;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      old = parameters_;
      base_in_map = simulator_.truth().base_in_map;
    }
    if (read.scenario.map != old.scenario.map || read.scenario.world != old.scenario.world ||
        read.start != old.start) {
      throw ParameterError("map, world and start cannot be changed while the simulator runs");
    }
    std::optional<std::vector<sim::Obstacle>> obstacles;
    if (read.scenario.obstacles != old.scenario.obstacles ||
        read.scenario.seed != old.scenario.seed ||
        read.scenario.moving_obstacles != old.scenario.moving_obstacles) {
      obstacles = sim::drawObstacles(read.scenario, *scenario_.world, base_in_map);
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    simulator_.setParameters(read.simulator);
    driver_.setParameters(read.follower);
    if (obstacles) simulator_.setObstacles(std::move(*obstacles));
    obstacles_changed_ = true;
    parameters_ = read;
    response.success = true;
    response.message = "takes effect with the next step";
  } catch (const std::exception& error) {
    warnThrottled(&log_throttle_, "parameters unchanged", error.what());
    response.success = false;
    response.message = error.what();
  }
  return true;
}

}  // namespace racecar_mcl
