// The simulated car on the ROS graph: commands in, what a car publishes out.
//
// One thread of its own drives the car in steps of simulated time and publishes what arrives
// meanwhile; ROS callbacks only leave it something to do. They meet under one mutex, which is not
// held while messages are published.
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

#include "ros/simulator_output.h"
#include "ros/simulator_parameters.h"
#include "sim/driver.h"
#include "sim/lap_counter.h"

namespace racecar_mcl {

class SimulatorNode {
 public:
  /// Topics are relative to `node`, those of the simulation itself to `private_node`. With
  /// /use_sim_time the simulator is the clock. Throws ParameterError or MapError.
  SimulatorNode(ros::NodeHandle node, ros::NodeHandle private_node);
  ~SimulatorNode();

 private:
  /// What a step leaves to be published.
  struct Step {
    double now = 0.0;  ///< s
    SimulatorNodeParameters parameters;
    std::vector<sim::Event> events;
    std::optional<std::vector<sim::Obstacle>> obstacles;  ///< where they have changed or walk
    std::optional<int> collisions;                        ///< where there was one
  };

  void run();
  Step step();
  sim::Command nextCommand();
  void countLaps();
  void publish(const Step& step);

  void command(const sim::Command& command);
  void addObstacle(sim::Obstacle obstacle);

  void onTwist(const geometry_msgs::TwistConstPtr& message);
#ifdef RACECAR_MCL_HAS_ACKERMANN
  void onDrive(const ackermann_msgs::AckermannDriveStampedConstPtr& message);
#endif
  void onPlace(const geometry_msgs::PoseStampedConstPtr& message);
  void onObstacle(const geometry_msgs::PointStampedConstPtr& message);
  void onMovingObstacle(const geometry_msgs::PoseStampedConstPtr& message);
  void onStartAsked(const ros::SingleSubscriberPublisher& subscriber);
  bool onClearObstacles(std_srvs::Empty::Request&, std_srvs::Empty::Response&);
  bool onReload(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);

  ros::NodeHandle private_node_;
  const bool is_clock_;

  std::mutex mutex_;  ///< guards the fields up to `output_`
  SimulatorNodeParameters parameters_;
  const sim::Scene scene_;
  sim::Simulator simulator_;
  sim::Driver driver_;
  sim::LapCounter laps_;
  double lap_began_;  ///< s
  std::optional<sim::Command> command_;
  double command_until_ = 0.0;  ///< s, of simulated time
  sim::Command driving_;
  long steps_ = 0;
  int collisions_ = 0;
  bool obstacles_changed_ = true;

  SimulatorOutput output_;  ///< the driving thread's; its delay is guarded by `mutex_`
  ros::Publisher start_announcer_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace racecar_mcl
