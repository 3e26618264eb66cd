#include "ros/simulator_node.h"

#include <geometry_msgs/PoseWithCovarianceStamped.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "racecar_mcl/errors.h"
#include "ros/conversions.h"

namespace racecar_mcl {
namespace {

constexpr double kStep = 0.01;                    // s, of simulated time
constexpr long kStepsPerLook = 2;                 // of the wall follower
constexpr long kStepsPerMarkers = 10;             // of obstacles that walk
constexpr double kFirstClock = 1000.0;            // s; ROS takes 0 for no time at all
constexpr double kRolling = 0.1;                  // m/s, below which a turn rate says little
constexpr std::chrono::milliseconds kStall{200};  // of the wall's time, not made up for

bool isClock() {
  bool use_sim_time = false;
  ros::param::get("/use_sim_time", use_sim_time);
  return use_sim_time;
}

SimulatorNodeParameters readParameters(const ros::NodeHandle& private_node, bool is_clock) {
  SimulatorNodeParameters parameters = readSimulatorParameters(private_node);
  if (parameters.real_time_factor != 1.0 && !is_clock) {
    throw ParameterError("real_time_factor is " + std::to_string(parameters.real_time_factor) +
                         "; without /use_sim_time everybody goes by the wall's clock, and it must "
                         "be 1");
  }
  return parameters;
}

void requireMapFrame(const std::string& frame) {
  if (!frame.empty() && stripLeadingSlash(frame) != "map") {
    throw MessageError("it is given in frame '" + frame + "'; expected 'map'");
  }
}

}  // namespace

SimulatorNode::SimulatorNode(ros::NodeHandle node, ros::NodeHandle private_node)
    : private_node_(private_node),
      is_clock_(isClock()),
      parameters_(readParameters(private_node, is_clock_)),
      scene_(sim::loadScene(parameters_.scene)),
      simulator_(scene_.world, parameters_.simulator, scene_.start_in_map, parameters_.scene.seed,
                 is_clock_ ? kFirstClock : ros::WallTime::now().toSec()),
      driver_(parameters_.follower),
      laps_(scene_.start_in_map),
      lap_began_(simulator_.time()),
      output_(node, private_node, parameters_, is_clock_) {
  simulator_.setObstacles(scene_.obstacles);
  if (parameters_.announce_start) {
    start_announcer_ = node.advertise<geometry_msgs::PoseWithCovarianceStamped>(
        "initialpose", 1,
        [this](const ros::SingleSubscriberPublisher& subscriber) { onStartAsked(subscriber); });
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
  const Pose2& start = scene_.start_in_map;
  ROS_INFO("simulating %s from (%.2f, %.2f, %.2f)", scene_.world_path.c_str(), start.x, start.y,
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
    if (late > kStall) {
      // Run after, the lost time would flood everybody. A clock of our own has simply stood still.
      if (!is_clock_) {
        const std::lock_guard<std::mutex> lock(mutex_);
        output_.addDelay(std::chrono::duration<double>(late).count());
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
  if (steps_ % kStepsPerLook == 0) driving_ = nextCommand();
  step.events = simulator_.advance(kStep, driving_);
  step.now = simulator_.time();
  step.parameters = parameters_;
  if (simulator_.collisions() > collisions_) {
    collisions_ = simulator_.collisions();
    step.collisions = collisions_;
  }
  const std::vector<sim::Obstacle>& obstacles = simulator_.obstacles();
  const bool walk = std::any_of(obstacles.begin(), obstacles.end(),
                                [](const sim::Obstacle& o) { return o.speed > 0.0; });
  if (obstacles_changed_ || (walk && steps_ % kStepsPerMarkers == 0)) step.obstacles = obstacles;
  obstacles_changed_ = false;
  countLaps();
  ++steps_;
  return step;
}

sim::Command SimulatorNode::nextCommand() {
  const bool follows = parameters_.driver != Driver::kCommands;
  if (parameters_.driver != Driver::kWallFollower && command_ &&
      simulator_.time() < command_until_) {
    return *command_;
  }
  if (!follows) return {};
  return driver_.drive(simulator_.look(), simulator_.truth().twist.vx, simulator_.collided());
}

void SimulatorNode::countLaps() {
  const int before = laps_.laps();
  laps_.update(simulator_.truth().base_in_map);
  if (laps_.laps() == before) return;
  const double now = simulator_.time();
  ROS_INFO("lap %d: %.1f s, %d collisions so far", laps_.laps(), now - lap_began_, collisions_);
  lap_began_ = now;
}

void SimulatorNode::publish(const Step& step) {
  if (is_clock_) output_.publishClock(step.now);
  for (const sim::Event& event : step.events) output_.publish(event, step.parameters);
  if (step.obstacles) output_.publishObstacles(*step.obstacles, step.now);
  if (step.collisions) {
    ROS_WARN("the simulated car ran into something (%d so far)", *step.collisions);
    output_.publishCollisions(*step.collisions);
  }
}

void SimulatorNode::command(const sim::Command& command) {
  if (!std::isfinite(command.speed) || !std::isfinite(command.steering)) {
    ROS_WARN_THROTTLE(5.0, "command dropped: speed and steering must be finite");
    return;
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  command_ = command;
  command_until_ = simulator_.time() + parameters_.command_timeout;
}

void SimulatorNode::onTwist(const geometry_msgs::TwistConstPtr& message) {
  // wz = speed tan(steering) / wheelbase. A car that stands cannot turn; its wheels can.
  const double speed = message->linear.x;
  double wheelbase;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    wheelbase = parameters_.simulator.car.wheelbase;
  }
  const double rolling = std::abs(speed) < kRolling ? std::copysign(kRolling, speed) : speed;
  command({speed, std::atan(message->angular.z * wheelbase / rolling)});
}

#ifdef RACECAR_MCL_HAS_ACKERMANN
void SimulatorNode::onDrive(const ackermann_msgs::AckermannDriveStampedConstPtr& message) {
  command({message->drive.speed, message->drive.steering_angle});
}
#endif

void SimulatorNode::onPlace(const geometry_msgs::PoseStampedConstPtr& message) {
  try {
    requireMapFrame(message->header.frame_id);
    const Pose2 pose = toPose2(message->pose);
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!scene_.world->isFree({pose.x, pose.y}) ||
        sim::overlaps(pose, parameters_.simulator.car, *scene_.world, simulator_.obstacles(),
                      simulator_.time())) {
      throw MessageError("the car would not stand free there");
    }
    simulator_.place(pose);
    laps_ = sim::LapCounter(pose);
    lap_began_ = simulator_.time();
    ROS_INFO("the simulated car was placed at (%.2f, %.2f, %.2f)", pose.x, pose.y, pose.yaw);
  } catch (const std::exception& error) {
    ROS_WARN("place cannot be used: %s", error.what());
  }
}

void SimulatorNode::onObstacle(const geometry_msgs::PointStampedConstPtr& message) {
  try {
    requireMapFrame(message->header.frame_id);
    sim::Obstacle disc;
    disc.in_map = {message->point.x, message->point.y, 0.0};
    addObstacle(disc);
  } catch (const std::exception& error) {
    ROS_WARN("add_obstacle cannot be used: %s", error.what());
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
    ROS_WARN("add_moving_obstacle cannot be used: %s", error.what());
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

void SimulatorNode::onStartAsked(const ros::SingleSubscriberPublisher& subscriber) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const sim::Truth truth = simulator_.truth();
  output_.announce(subscriber, truth.base_in_map, truth.stamp);
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
    if (read.scene.map != old.scene.map || read.scene.world != old.scene.world ||
        read.start != old.start) {
      throw ParameterError("map, world and start hold from the simulator's start on");
    }
    std::optional<std::vector<sim::Obstacle>> obstacles;
    if (read.scene.obstacles != old.scene.obstacles || read.scene.seed != old.scene.seed ||
        read.scene.moving_obstacles != old.scene.moving_obstacles) {
      obstacles = sim::drawObstacles(read.scene, *scene_.world, base_in_map);
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    simulator_.setParameters(read.simulator);
    driver_.setParameters(read.follower);
    if (obstacles) simulator_.setObstacles(std::move(*obstacles));
    obstacles_changed_ = true;
    parameters_ = read;
    response.success = true;
    response.message = "holds from the next step on";
  } catch (const std::exception& error) {
    ROS_WARN("parameters stay as they were: %s", error.what());
    response.success = false;
    response.message = error.what();
  }
  return true;
}

}  // namespace racecar_mcl
