#include "ros/simulation/simulator_publisher.h"

#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <rosgraph_msgs/Clock.h>
#include <std_msgs/Int32.h>
#include <visualization_msgs/MarkerArray.h>

#include "ros/conversions/simulator_conversions.h"

namespace racecar_mcl {
namespace {

const char* const kMap = "map";
const char* const kOdom = "odom";
const char* const kBase = "base_link";
const char* const kTruth = "base_link_truth";

constexpr double kObstacleHeight = 0.4;  // m, of markers; the simulated world is planar
constexpr double kCarHeight = 0.12;      // m, of the marker
// Uncertainty of the announced start pose: the car moves while the message is in transit.
constexpr double kAnnouncedSigma = 0.2;     // m
constexpr double kAnnouncedYawSigma = 0.1;  // rad

std_msgs::ColorRGBA color(float red, float green, float blue, float alpha) {
  std_msgs::ColorRGBA color;
  color.r = red;
  color.g = green;
  color.b = blue;
  color.a = alpha;
  return color;
}

visualization_msgs::Marker obstacleMarker(const sim::Obstacle& obstacle, int id, double now) {
  visualization_msgs::Marker marker;
  marker.header.frame_id = kMap;
  marker.ns = "obstacles";
  marker.id = id;
  const bool disc = obstacle.shape == sim::Obstacle::Shape::kDisc;
  marker.type = disc ? visualization_msgs::Marker::CYLINDER : visualization_msgs::Marker::CUBE;
  marker.pose = toMessage(sim::poseAt(obstacle, now));
  marker.pose.position.z = kObstacleHeight / 2.0;
  marker.scale.x = disc ? 2.0 * obstacle.radius : obstacle.length;
  marker.scale.y = disc ? 2.0 * obstacle.radius : obstacle.width;
  marker.scale.z = kObstacleHeight;
  marker.color =
      obstacle.path.empty() ? color(0.9f, 0.5f, 0.0f, 0.8f) : color(0.8f, 0.1f, 0.5f, 0.8f);
  return marker;
}

}  // namespace

SimulatorPublisher::SimulatorPublisher(ros::NodeHandle node, ros::NodeHandle private_node,
                                       const SimulatorNodeParameters& parameters,
                                       bool publish_clock)
    : odometry_(node.advertise<nav_msgs::Odometry>("odom", 20)),
      imu_(node.advertise<sensor_msgs::Imu>("imu", 50)),
      truth_(node.advertise<nav_msgs::Odometry>("ground_truth/odom", 50)),
      obstacles_(private_node.advertise<visualization_msgs::MarkerArray>("obstacles", 1, true)),
      car_(private_node.advertise<visualization_msgs::Marker>("car", 1, true)),
      collisions_(private_node.advertise<std_msgs::Int32>("collisions", 1, true)) {
  if (publish_clock) clock_ = node.advertise<rosgraph_msgs::Clock>("/clock", 100);
  const std::vector<geometry_msgs::TransformStamped> lidars =
      lidarTransforms(parameters.simulator, 0.0);
  static_broadcaster_.sendTransform(lidars);
  for (std::size_t i = 0; i < lidars.size(); ++i) {
    scans_.push_back(node.advertise<sensor_msgs::LaserScan>(kSimulatedScanTopics[i], 5));
  }
  publishCar(parameters.simulator.car);
  publishCollisions(0);
}

void SimulatorPublisher::publishClock(double now) {
  rosgraph_msgs::Clock clock;
  clock.clock.fromSec(now);
  clock_.publish(clock);
}

void SimulatorPublisher::publish(const sim::Event& event,
                                 const SimulatorNodeParameters& parameters) {
  if (const auto* sweep = std::get_if<sim::LidarScan>(&event.data)) {
    auto message = boost::make_shared<sensor_msgs::LaserScan>(toMessage(*sweep));
    message->header.stamp.fromSec(sweep->stamp + delay_);
    scans_[static_cast<std::size_t>(sweep->lidar)].publish(message);
  } else if (const auto* sample = std::get_if<OdometrySample>(&event.data)) {
    const double stamp = sample->stamp + delay_;
    if (parameters.publish_odom_tf) {
      broadcaster_.sendTransform(toTransformMessage(stamp, sample->base_in_odom, kOdom, kBase));
    }
    auto message = boost::make_shared<nav_msgs::Odometry>(
        toMessage(*sample, parameters.simulator.odometry, kOdom, kBase));
    message->header.stamp.fromSec(stamp);
    odometry_.publish(message);
  } else if (const auto* gyro = std::get_if<GyroSample>(&event.data)) {
    auto message = boost::make_shared<sensor_msgs::Imu>(toMessage(*gyro, kBase));
    message->header.stamp.fromSec(gyro->stamp + delay_);
    imu_.publish(message);
  } else {
    const auto& truth = std::get<sim::Truth>(event.data);
    const double stamp = truth.stamp + delay_;
    broadcaster_.sendTransform(toTransformMessage(stamp, truth.base_in_map, kMap, kTruth));
    truth_.publish(boost::make_shared<nav_msgs::Odometry>(
        toOdometryMessage(stamp, truth.base_in_map, truth.twist, kMap, kTruth)));
  }
}

void SimulatorPublisher::announce(const ros::SingleSubscriberPublisher& subscriber,
                                  const Pose2& base_in_map, double now) const {
  geometry_msgs::PoseWithCovarianceStamped message;
  message.header.stamp.fromSec(now + delay_);
  message.header.frame_id = kMap;
  message.pose.pose = toMessage(base_in_map);
  message.pose.covariance[0] = kAnnouncedSigma * kAnnouncedSigma;
  message.pose.covariance[7] = kAnnouncedSigma * kAnnouncedSigma;
  message.pose.covariance[35] = kAnnouncedYawSigma * kAnnouncedYawSigma;
  subscriber.publish(message);
}

void SimulatorPublisher::publishObstacles(const std::vector<sim::Obstacle>& obstacles, double now) {
  auto array = boost::make_shared<visualization_msgs::MarkerArray>();
  visualization_msgs::Marker wipe;
  wipe.action = visualization_msgs::Marker::DELETEALL;
  array->markers.push_back(wipe);
  for (const sim::Obstacle& obstacle : obstacles) {
    array->markers.push_back(
        obstacleMarker(obstacle, static_cast<int>(array->markers.size()), now));
  }
  obstacles_.publish(array);
}

void SimulatorPublisher::publishCollisions(int count) {
  std_msgs::Int32 message;
  message.data = count;
  collisions_.publish(message);
}

void SimulatorPublisher::publishCar(const sim::CarParameters& car) {
  visualization_msgs::Marker marker;
  marker.header.frame_id = kTruth;
  marker.frame_locked = true;
  marker.ns = "car";
  marker.type = visualization_msgs::Marker::CUBE;
  marker.pose = toMessage(Pose2{(car.length_ahead - car.length_behind) / 2.0, 0.0, 0.0});
  marker.pose.position.z = kCarHeight / 2.0;
  marker.scale.x = car.length_ahead + car.length_behind;
  marker.scale.y = car.width;
  marker.scale.z = kCarHeight;
  marker.color = color(0.2f, 0.2f, 0.25f, 0.6f);
  car_.publish(marker);
}

}  // namespace racecar_mcl
