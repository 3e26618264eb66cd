// ROS node of the simulator: subscribes to commands, publishes the car's sensors and the truth.
//
// A thread advances the simulation in fixed steps and publishes the sensor events of each step. ROS
// callbacks only change its inputs. One mutex guards the shared state; it is not held while
// publishing.
#pragma once

#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/Twist.h>
#include <ros/ros.h>
#include <std_srvs/Empty.h>
#include <std_srvs/Trigger.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#ifdef RACECAR_MCL_HAS_ACKERMANN
#include <ackermann_msgs/AckermannDriveStamped.h>
#endif

#include "ros/simulation/simulator_parameters.h"
#include "ros/simulation/simulator_publisher.h"
#include "ros/util/log_throttle.h"
#include "sim/driver.h"
#include "sim/lap_counter.h"

namespace racecar_mcl {

class SimulatorNode {
 public:
  /// Topics of the car are relative to `node`, those of the simulation to `private_node`. With
  /// /use_sim_time the simulator publishes the clock. Throws ParameterError or MapError.
  SimulatorNode(ros::NodeHandle node, ros::NodeHandle private_node);
  ~SimulatorNode();

 private:
  /// The messages of one simulation step.
  struct Step {
    double now = 0.0;  ///< s
    SimulatorNodeParameters parameters;
    std::vector<sim::Event> events;
    std::optional<std::vector<sim::Obstacle>> obstacles;  ///< if they have changed or move
    std::optional<int> collisions;                        ///< total, if one occurred
  };

  void run();
  Step step();
  sim::Command nextCommand();
  void countLaps();
  void publish(const Step& step);

  void setCommand(const sim::Command& command);
  void addObstacle(sim::Obstacle obstacle);

  void onTwist(const geometry_msgs::TwistConstPtr& message);
#ifdef RACECAR_MCL_HAS_ACKERMANN
  void onDrive(const ackermann_msgs::AckermannDriveStampedConstPtr& message);
#endif
  void onPlace(const geometry_msgs::PoseStampedConstPtr& message);
  void onObstacle(const geometry_msgs::PointStampedConstPtr& message);
  void onMovingObstacle(const geometry_msgs::PoseStampedConstPtr& message);
  void onStartSubscriber(const ros::SingleSubscriberPublisher& subscriber);
  bool onClearObstacles(std_srvs::Empty::Request&, std_srvs::Empty::Response&);
  bool onReload(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);

  ros::NodeHandle private_node_;
  const bool is_clock_;

  LogThrottle log_throttle_;
  std::mutex mutex_;  ///< guards the fields up to `output_`
  SimulatorNodeParameters parameters_;
  const sim::Scenario scenario_;
  sim::Simulator simulator_;
  sim::Driver driver_;
  sim::LapCounter laps_;
  double lap_start_;  ///< s
  std::optional<sim::Command> command_;
  double command_until_ = 0.0;  ///< s of simulated time
  sim::Command current_command_;
  long steps_ = 0;
  int collisions_ = 0;
  bool obstacles_changed_ = true;

  SimulatorPublisher
      publisher_;  ///< used by the simulation thread; its delay is guarded by `mutex_`
  ros::Publisher start_announcer_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace racecar_mcl
