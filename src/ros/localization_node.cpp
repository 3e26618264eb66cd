#include "ros/localization_node.h"

#include <diagnostic_msgs/DiagnosticArray.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <chrono>
#include <cmath>

#include "racecar_mcl/errors.h"
#include "ros/map_conversions.h"
#include "ros/visualization.h"

namespace racecar_mcl {
namespace {

// A scan waits at most this long for the odometry that covers it.
constexpr std::chrono::milliseconds kOdometryWait{20};
// Odometry older than this against the scan is not worth waiting for.
constexpr double kOdometryStale = 0.5;  // s
// Two poses of one stamp cannot both enter tf; the second is stamped, and carried, this much later.
constexpr double kStampStep = 1e-6;  // s

ros::TransportHints lowLatency() { return ros::TransportHints().tcpNoDelay(); }

template <typename Message>
void publishIfHeard(const ros::Publisher& publisher, const Message& make) {
  if (publisher.getNumSubscribers() == 0) return;
  using Type = std::decay_t<decltype(make())>;
  publisher.publish(boost::make_shared<Type>(make()));
}

}  // namespace

LocalizationNode::LocalizationNode(ros::NodeHandle node, ros::NodeHandle private_node)
    : parameters_(readNodeParameters(private_node)),
      node_(node),
      localizer_(parameters_.localizer, static_cast<std::uint64_t>(parameters_.seed)),
      last_scan_arrival_(ros::WallTime::now()),
      last_odometry_arrival_(ros::WallTime::now()),
      tf_listener_(tf_buffer_),
      tf_parent_watch_(node, parameters_) {
  pose_publisher_ = node_.advertise<nav_msgs::Odometry>("pf/pose/odom", 10);
  inferred_pose_publisher_ = node_.advertise<geometry_msgs::PoseStamped>("pf/viz/inferred_pose", 1);
  amcl_pose_publisher_ =
      node_.advertise<geometry_msgs::PoseWithCovarianceStamped>("amcl_pose", 1, true);
  particles_publisher_ = node_.advertise<geometry_msgs::PoseArray>("pf/viz/particles", 1);
  markers_publisher_ =
      node_.advertise<visualization_msgs::MarkerArray>("pf/viz/particle_markers", 1);
  scan_publisher_ = node_.advertise<sensor_msgs::LaserScan>("pf/viz/scan", 1);
  fake_scan_publisher_ = node_.advertise<sensor_msgs::LaserScan>("pf/viz/fake_scan", 1);
  diagnostics_publisher_ = node_.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 1);

  if (parameters_.initial_pose) {
    start({*parameters_.initial_pose, Eigen::Matrix3d::Zero()});
  }

  subscribers_ = {node_.subscribe("odom", 50, &LocalizationNode::onOdometry, this, lowLatency()),
                  node_.subscribe("scan", 2, &LocalizationNode::onScan, this, lowLatency()),
                  node_.subscribe("map", 1, &LocalizationNode::onMap, this),
                  node_.subscribe("initialpose", 2, &LocalizationNode::onInitialPose, this),
                  node_.subscribe("clicked_point", 2, &LocalizationNode::onClickedPoint, this)};
  services_ = {
      node_.advertiseService("global_localization", &LocalizationNode::onGlobalLocalization, this),
      node_.advertiseService("request_nomotion_update", &LocalizationNode::onNoMotionUpdate, this),
      node_.advertiseService("set_map", &LocalizationNode::onSetMap, this)};
  diagnostics_timer_ = node_.createWallTimer(ros::WallDuration(1.0 / parameters_.diagnostics_rate),
                                             &LocalizationNode::onDiagnosticsTimer, this);
}

LocalizationNode::~LocalizationNode() {
  diagnostics_timer_.stop();
  for (ros::Subscriber& subscriber : subscribers_) subscriber.shutdown();
  for (ros::ServiceServer& service : services_) service.shutdown();
  odometry_arrived_.notify_all();
  map_builder_.stop();
  worker_.stop();
}

void LocalizationNode::onOdometry(const nav_msgs::OdometryConstPtr& message) {
  const OdometrySample sample = toOdometrySample(*message);
  OdometryOutcome outcome;
  bool started;
  {
    const std::lock_guard<std::mutex> lock(timeline_mutex_);
    last_odometry_arrival_ = ros::WallTime::now();
    outcome = localizer_.addOdometry(sample);
    started = localizer_.initialized();
    if (isFinite(sample.base_in_odom)) {
      base_in_odom_ = sample.base_in_odom;
      base_in_odom_stamp_ = sample.stamp;
    }
  }
  odometry_arrived_.notify_one();
  switch (outcome) {
    case OdometryOutcome::kUsed:
      break;
    case OdometryOutcome::kTimeJumpedBack:
      worker_.post([this] { restartAfterTimeJump(); });
      break;
    case OdometryOutcome::kGap:
      ROS_WARN_THROTTLE(10.0, "%s", describe(outcome).c_str());
      break;
    default:
      ROS_WARN_THROTTLE(10.0, "odometry dropped: %s", describe(outcome).c_str());
      return;
  }
  if (started) publishPose(false);
}

void LocalizationNode::onScan(const sensor_msgs::LaserScanConstPtr& message) {
  const ros::WallTime now = ros::WallTime::now();
  const bool replaced = newest_scan_.put({message, now});
  {
    const std::lock_guard<std::mutex> lock(timeline_mutex_);
    last_scan_arrival_ = now;
    if (replaced) ++status_.scans_superseded;
  }
  if (!replaced) worker_.post([this] { processScan(); });
}

void LocalizationNode::onMap(const nav_msgs::OccupancyGridConstPtr& message) {
  if (!newest_map_.put(message)) map_builder_.post([this] { buildMap(); });
}

void LocalizationNode::onInitialPose(
    const geometry_msgs::PoseWithCovarianceStampedConstPtr& message) {
  const std::string frame = stripLeadingSlash(message->header.frame_id);
  try {
    if (frame != parameters_.map_frame) {
      throw MessageError("it is given in frame '" + frame + "'; expected '" +
                         parameters_.map_frame + "'");
    }
    const PoseEstimate pose = toPoseEstimate(message->pose);
    worker_.post([this, pose] { start(pose); });
  } catch (const MessageError& error) {
    refuse(&NodeStatus::starts_refused, std::string("initialpose cannot be used: ") + error.what());
  }
}

void LocalizationNode::onClickedPoint(const geometry_msgs::PointStampedConstPtr&) {
  worker_.post([this] { startGlobally(); });
}

bool LocalizationNode::onGlobalLocalization(std_srvs::Empty::Request&, std_srvs::Empty::Response&) {
  worker_.post([this] { startGlobally(); });
  return true;
}

bool LocalizationNode::onNoMotionUpdate(std_srvs::Empty::Request&, std_srvs::Empty::Response&) {
  const std::lock_guard<std::mutex> lock(timeline_mutex_);
  localizer_.requestUpdate();
  return true;
}

bool LocalizationNode::onSetMap(nav_msgs::SetMap::Request& request,
                                nav_msgs::SetMap::Response& response) {
  try {
    const PoseEstimate pose = toPoseEstimate(request.initial_pose.pose);
    toOccupancyGrid(request.map);  // refuses here what the builder would refuse later
    onMap(boost::make_shared<nav_msgs::OccupancyGrid>(request.map));
    // Behind the map on its way through the builder, so that the pose is judged by the new map.
    map_builder_.post([this, pose] { worker_.post([this, pose] { start(pose); }); });
    response.success = true;
  } catch (const std::exception& error) {
    ROS_ERROR("set_map refused: %s", error.what());
    response.success = false;
  }
  return true;
}

void LocalizationNode::buildMap() {
  const std::optional<nav_msgs::OccupancyGridConstPtr> message = newest_map_.take();
  if (!message) return;
  try {
    const std::shared_ptr<MapModel> map = makeMapModel(toOccupancyGrid(**message), parameters_.localizer);
    worker_.post([this, map] {
      const GridGeometry& geometry = map->grid.geometry();
      ROS_INFO("map of %d x %d cells at %g m", geometry.width, geometry.height,
               geometry.resolution);
      bool start_anywhere;
      {
        const std::lock_guard<std::mutex> lock(timeline_mutex_);
        localizer_.setMap(map);
        start_anywhere = parameters_.global_start && !localizer_.initialized();
      }
      if (start_anywhere) startGlobally();
    });
  } catch (const std::exception& error) {
    ROS_ERROR("the map cannot be used, the one before stays: %s", error.what());
    const std::lock_guard<std::mutex> lock(timeline_mutex_);
    status_.last_problem = error.what();
  }
}

void LocalizationNode::start(const PoseEstimate& pose) {
  try {
    const std::lock_guard<std::mutex> lock(timeline_mutex_);
    localizer_.initialize(pose);
  } catch (const std::exception& error) {
    refuse(&NodeStatus::starts_refused, std::string("start refused: ") + error.what());
    return;
  }
  ROS_INFO("localizing from (%.3f m, %.3f m, %.3f rad)", pose.base_in_map.x, pose.base_in_map.y,
           pose.base_in_map.yaw);
}

void LocalizationNode::startGlobally() {
  bool started;
  {
    const std::lock_guard<std::mutex> lock(timeline_mutex_);
    started = localizer_.initializeGlobally();
  }
  if (started) {
    ROS_INFO("localizing globally: the car may be anywhere on the map");
  } else {
    refuse(&NodeStatus::starts_refused, "global localization needs a map first");
  }
}

void LocalizationNode::restartAfterTimeJump() {
  ROS_WARN("time jumped back, as when a bag loops: odometry starts again%s",
           parameters_.initial_pose ? " at initial_pose" : "; the pose stays where it was");
  {
    const std::lock_guard<std::mutex> lock(timeline_mutex_);
    last_published_stamp_ = 0.0;
  }
  if (parameters_.initial_pose) start({*parameters_.initial_pose, Eigen::Matrix3d::Zero()});
}

void LocalizationNode::refuse(std::uint64_t NodeStatus::*counter, const std::string& problem) {
  ROS_WARN_THROTTLE(5.0, "%s", problem.c_str());
  const std::lock_guard<std::mutex> lock(timeline_mutex_);
  ++(status_.*counter);
  status_.last_problem = problem;
}

std::optional<LaserMount> LocalizationNode::laserMount(const std::string& frame) {
  if (frame == parameters_.particle_filter_frame) return LaserMount{};
  try {
    const geometry_msgs::TransformStamped laser_in_base =
        tf_buffer_.lookupTransform(parameters_.particle_filter_frame, frame, ros::Time(0));
    return toLaserMount(laser_in_base.transform);
  } catch (const tf2::TransformException& error) {
    refuse(&NodeStatus::scans_without_tf,
           "scan in frame '" + frame + "' dropped: no transform to '" +
               parameters_.particle_filter_frame + "': " + error.what());
  } catch (const MessageError& error) {
    refuse(&NodeStatus::scans_without_tf, "scan in frame '" + frame + "' dropped: " + error.what());
  }
  return std::nullopt;
}

void LocalizationNode::waitForOdometry(double stamp) {
  std::unique_lock<std::mutex> lock(timeline_mutex_);
  const std::optional<double> newest = localizer_.newestStamp();
  if (!newest || stamp - *newest > kOdometryStale) return;
  odometry_arrived_.wait_for(lock, kOdometryWait,
                             [&] { return localizer_.odometryCovers(stamp) || !ros::ok(); });
}

void LocalizationNode::processScan() {
  const std::optional<ReceivedScan> received = newest_scan_.take();
  if (!received) return;
  const sensor_msgs::LaserScan& message = *received->message;
  const std::optional<LaserMount> mount = laserMount(stripLeadingSlash(message.header.frame_id));
  if (!mount) return;
  Scan scan;
  try {
    scan = toScan(message, *mount);
  } catch (const MessageError& error) {
    refuse(&NodeStatus::scans_unreadable, std::string("scan dropped: ") + error.what());
    return;
  }

  waitForOdometry(scan.stamp);
  Localizer::ScanTask task;
  {
    const std::lock_guard<std::mutex> lock(timeline_mutex_);
    task = localizer_.prepareScan(scan);
  }
  localizer_.processScan(&task);
  ScanResult result;
  {
    const std::lock_guard<std::mutex> lock(timeline_mutex_);
    result = localizer_.commitScan(task);
  }
  if (result.outcome == ScanOutcome::kTimeJumpedBack) restartAfterTimeJump();
  if (result.outcome != ScanOutcome::kUsed && result.outcome != ScanOutcome::kParked) {
    reportDropped(result);
    return;
  }
  publishPose(true);
  {
    const std::lock_guard<std::mutex> lock(timeline_mutex_);
    latency_.add((ros::WallTime::now() - received->arrival).toSec());
    if (result.outcome == ScanOutcome::kUsed) {
      status_.effective_sample_size = result.update.effective_sample_size;
      status_.particles = result.update.particles;
      status_.beams = result.update.beams;
    }
    const Eigen::Matrix3d& covariance = result.update.estimate.covariance;
    const Eigen::Vector2d axes =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance.topLeftCorner<2, 2>())
            .eigenvalues();
    status_.position_sigma = std::sqrt(std::max(0.0, axes.maxCoeff()));
    status_.yaw_sigma = std::sqrt(std::max(0.0, covariance(2, 2)));
  }
  publishScanTopics(message, *mount, result);
}

void LocalizationNode::reportDropped(const ScanResult& result) {
  const std::string reason = describe(result.outcome);
  switch (result.outcome) {
    case ScanOutcome::kNoMap:
      ROS_WARN_ONCE("scans and odometry wait for a map on %s", node_.resolveName("map").c_str());
      break;
    case ScanOutcome::kNoStart:
      ROS_WARN_ONCE(
          "scans wait for a start pose: set it in rviz with '2D Pose Estimate', click a point with "
          "'Publish Point' to localize globally, or set initial_pose or global_start");
      break;
    default:
      ROS_WARN_THROTTLE(10.0, "scan not used: %s", reason.c_str());
  }
  const std::lock_guard<std::mutex> lock(timeline_mutex_);
  status_.last_problem = reason;
}

void LocalizationNode::publishPose(bool after_scan) {
  const std::lock_guard<std::mutex> lock(timeline_mutex_);
  const std::optional<double> newest = localizer_.newestStamp();
  if (!newest) return;
  double stamp = *newest;
  if (stamp <= last_published_stamp_) {
    // Odometry adds nothing to a stamp that is out; a scan's correction does.
    if (!after_scan) return;
    stamp = last_published_stamp_ + kStampStep;
  }
  const std::optional<PoseEstimate> estimate = localizer_.estimateAt(stamp);
  if (!estimate) return;
  last_published_stamp_ = stamp;

  broadcast(*estimate, stamp);
  auto odometry = boost::make_shared<nav_msgs::Odometry>();
  odometry->header.stamp = ros::Time(stamp);
  odometry->header.frame_id = parameters_.map_frame;
  odometry->child_frame_id = parameters_.particle_filter_frame;
  odometry->pose = toMessage(*estimate);
  const Twist2 twist = localizer_.twist();
  odometry->twist.twist.linear.x = twist.vx;
  odometry->twist.twist.linear.y = twist.vy;
  odometry->twist.twist.angular.z = twist.wz;
  pose_publisher_.publish(odometry);
  publishIfHeard(inferred_pose_publisher_, [&] {
    geometry_msgs::PoseStamped pose;
    pose.header = odometry->header;
    pose.pose = odometry->pose.pose;
    return pose;
  });
  if (!after_scan) return;
  auto amcl_pose = boost::make_shared<geometry_msgs::PoseWithCovarianceStamped>();
  amcl_pose->header = odometry->header;
  amcl_pose->pose = odometry->pose;
  amcl_pose_publisher_.publish(amcl_pose);
}

void LocalizationNode::broadcast(const PoseEstimate& estimate, double stamp) {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = ros::Time(stamp + parameters_.transform_tolerance);
  transform.header.frame_id = parameters_.map_frame;
  switch (parameters_.tf_mode) {
    case TfMode::kOff:
      return;
    case TfMode::kMapToBase: {
      // Stamped ahead, and truthfully so: predicted to that time by the newest odometry.
      const Pose2 base_ahead = compose(
          estimate.base_in_map, integrate(localizer_.twist(), parameters_.transform_tolerance));
      transform.child_frame_id = parameters_.particle_filter_frame;
      transform.transform = toTransform(base_ahead);
      break;
    }
    case TfMode::kMapToOdom: {
      const std::optional<PoseEstimate> then = localizer_.estimateAt(base_in_odom_stamp_);
      if (!base_in_odom_ || !then) return;
      transform.child_frame_id = parameters_.odom_frame;
      transform.transform = toTransform(compose(then->base_in_map, inverse(*base_in_odom_)));
      break;
    }
  }
  broadcaster_.sendTransform(transform);
}

void LocalizationNode::publishScanTopics(const sensor_msgs::LaserScan& message,
                                         const LaserMount& mount, const ScanResult& result) {
  const ros::WallTime now = ros::WallTime::now();
  if ((now - last_visualization_).toSec() < 1.0 / parameters_.visualization_rate) return;
  last_visualization_ = now;
  std_msgs::Header header;
  header.stamp = message.header.stamp;
  header.frame_id = parameters_.map_frame;
  publishIfHeard(particles_publisher_,
                 [&] { return particleArray(localizer_.particles(), header); });
  publishIfHeard(markers_publisher_,
                 [&] { return particleMarkers(localizer_.particles(), header); });
  publishIfHeard(scan_publisher_, [&] { return message; });
  publishIfHeard(fake_scan_publisher_, [&] {
    const Pose2 laser_in_map = compose(result.update.estimate.base_in_map, mount.laser_in_base);
    return expectedScan(*localizer_.map(), laser_in_map, mount.upside_down, message);
  });
}

void LocalizationNode::onDiagnosticsTimer(const ros::WallTimerEvent&) {
  diagnostic_msgs::DiagnosticArray array;
  array.header.stamp = ros::Time::now();
  NodeStatus status;
  {
    const std::lock_guard<std::mutex> lock(timeline_mutex_);
    const ros::WallTime now = ros::WallTime::now();
    status_.has_map = localizer_.hasMap();
    status_.started = localizer_.initialized();
    status_.counters = localizer_.counters();
    status_.seconds_since_scan = (now - last_scan_arrival_).toSec();
    status_.seconds_since_odometry = (now - last_odometry_arrival_).toSec();
    status_.latency_p50 = latency_.quantile(0.5);
    status_.latency_p99 = latency_.quantile(0.99);
    status = status_;
  }
  array.status.push_back(toDiagnostics(status, ros::this_node::getName() + ": localization"));
  diagnostics_publisher_.publish(array);
}

}  // namespace racecar_mcl
