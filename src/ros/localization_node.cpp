#include "ros/localization_node.h"

#include <diagnostic_msgs/DiagnosticArray.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "racecar_mcl/errors.h"
#include "ros/map_conversions.h"

namespace racecar_mcl {
namespace {

// A stamp this far from the clock is not of now: a bag's, or a mistake.
constexpr double kOtherTime = 10.0;  // s
// How often it is asked whether the inputs have fallen silent.
constexpr double kVerdictPeriod = 0.1;  // s, of wall time

/// The same node with another queue for its callbacks.
ros::NodeHandle withQueue(ros::NodeHandle node, ros::CallbackQueue* queue) {
  node.setCallbackQueue(queue);
  return node;
}

ros::TransportHints lowLatency() { return ros::TransportHints().tcpNoDelay(); }

/// Throws MapError where the map has no free cell and ParameterError where the pose is not on it.
void checkSetMap(const OccupancyGrid& grid, const Pose2& pose) {
  if (freeCells(grid).empty()) throw MapError("the map has no free cell");
  if (!contains(grid.geometry(), cellAt(grid.geometry(), {pose.x, pose.y}))) {
    throw ParameterError("the initial pose lies outside the map");
  }
}

}  // namespace

LocalizationNode::LocalizationNode(ros::NodeHandle node, ros::NodeHandle private_node)
    : parameters_(readNodeParameters(private_node)),
      node_(node),
      name_(private_node.getNamespace()),
      localizer_(parameters_.localizer, static_cast<std::uint64_t>(parameters_.seed)),
      silence_(parameters_.max_silence),
      output_(node, parameters_),
      tf_node_(withQueue(node, &tf_queue_)),
      laser_mounts_(tf_node_, parameters_),
      tf_parent_watch_(tf_node_, parameters_),
      tf_odometry_(parameters_.odom_frame, parameters_.particle_filter_frame,
                   parameters_.localizer.odometry.clock_jump) {
  diagnostics_publisher_ = node_.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 1);
  if (parameters_.initial_pose) start({*parameters_.initial_pose, Eigen::Matrix3d::Zero()});

  subscribers_ = {node_.subscribe("scan", 2, &LocalizationNode::onScan, this, lowLatency()),
                  node_.subscribe("map", 1, &LocalizationNode::onMap, this),
                  node_.subscribe("initialpose", 2, &LocalizationNode::onInitialPose, this),
                  node_.subscribe("clicked_point", 2, &LocalizationNode::onClickedPoint, this)};
  subscribeOdometry();
  services_ = {
      node_.advertiseService("global_localization", &LocalizationNode::onGlobalLocalization, this),
      node_.advertiseService("request_nomotion_update", &LocalizationNode::onNoMotionUpdate, this),
      node_.advertiseService("set_map", &LocalizationNode::onSetMap, this)};
  verdict_timer_ = node_.createWallTimer(ros::WallDuration(kVerdictPeriod),
                                         &LocalizationNode::onVerdictTimer, this);
  diagnostics_timer_ = node_.createWallTimer(ros::WallDuration(1.0 / parameters_.diagnostics_rate),
                                             &LocalizationNode::onDiagnosticsTimer, this);
}

LocalizationNode::~LocalizationNode() {
  verdict_timer_.stop();
  diagnostics_timer_.stop();
  for (ros::Subscriber& subscriber : subscribers_) subscriber.shutdown();
  for (ros::ServiceServer& service : services_) service.shutdown();
  map_builder_.stop();
  worker_.stop();
}

void LocalizationNode::subscribeOdometry() {
  if (parameters_.localizer.odometry.motion_from != MotionFrom::kTf) {
    subscribers_.push_back(
        node_.subscribe("odom", 50, &LocalizationNode::onOdometry, this, lowLatency()));
    return;
  }
  for (const bool is_static : {true, false}) {
    const boost::function<void(const tf2_msgs::TFMessageConstPtr&)> take =
        [this, is_static](const tf2_msgs::TFMessageConstPtr& message) {
          onTransforms(message, is_static);
        };
    subscribers_.push_back(node_.subscribe<tf2_msgs::TFMessage>(
        is_static ? "/tf_static" : "/tf", 100, take, ros::VoidConstPtr(), lowLatency()));
  }
}

void LocalizationNode::onTransforms(const tf2_msgs::TFMessageConstPtr& message, bool is_static) {
  if (const nav_msgs::OdometryConstPtr odometry = tf_odometry_.add(*message, is_static)) {
    onOdometry(odometry);
  }
}

void LocalizationNode::onOdometry(const nav_msgs::OdometryConstPtr& message) {
  if (isStampRefused("odometry", message->header.stamp)) return;
  const OdometrySample sample = toOdometrySample(*message);
  checkOdometryFrames(*message, sample);
  OdometryOutcome outcome;
  bool started;
  {
    const std::lock_guard<std::mutex> lock(timeline_mutex_);
    outcome = localizer_.addOdometry(sample);
    started = localizer_.initialized();
    odometry_frame_ = stripLeadingSlash(message->child_frame_id);
    if (outcome == OdometryOutcome::kUsed || outcome == OdometryOutcome::kGap ||
        outcome == OdometryOutcome::kTimeJumpedBack) {
      newest_odometry_stamp_ = sample.stamp;
      silence_.hearOdometry(ros::Time::now().toSec());
      if (isFinite(sample.base_in_odom)) {
        base_in_odom_ = sample.base_in_odom;
        base_in_odom_stamp_ = sample.stamp;
      }
    }
    if (outcome == OdometryOutcome::kTimeJumpedBack) last_published_stamp_ = 0.0;
  }
  odometry_arrived_.notify_one();
  switch (outcome) {
    case OdometryOutcome::kUsed:
      break;
    case OdometryOutcome::kTimeJumpedBack:
      worker_.post([this, stamp = sample.stamp] { restartAfterTimeJump(stamp); });
      break;
    case OdometryOutcome::kGap:
      warn("odometry", describe(outcome));
      break;
    default:
      note(describe(outcome));
      warn("odometry dropped", describe(outcome));
      return;
  }
  if (started) publishPose(false);
}

void LocalizationNode::checkOdometryFrames(const nav_msgs::Odometry& message,
                                           const OdometrySample& sample) {
  if (parameters_.tf_mode != TfMode::kMapToOdom) return;
  const std::string frame = stripLeadingSlash(message.header.frame_id);
  if (!frame.empty() && frame != parameters_.odom_frame) {
    warn("odom_frame", "odometry is given in '" + frame + "' but tf goes to '" +
                           parameters_.odom_frame + "'; expected both to be the same frame");
  }
  if (!isFinite(sample.base_in_odom)) {
    warn("odometry", "it carries no pose, which tf_mode map_to_odom needs");
  }
}

void LocalizationNode::onScan(const sensor_msgs::LaserScanConstPtr& message) {
  if (isStampRefused("scan", message->header.stamp)) return;
  if (!newest_scan_.put({message, ros::WallTime::now()})) {
    worker_.post([this] { processScan(); });
    return;
  }
  const std::lock_guard<std::mutex> lock(timeline_mutex_);
  ++status_.scans_superseded;
}

void LocalizationNode::onMap(const nav_msgs::OccupancyGridConstPtr& message) {
  const std::string frame = stripLeadingSlash(message->header.frame_id);
  if (!frame.empty() && frame != parameters_.map_frame) {
    warn("map_frame", "the map is given in '" + frame + "' but poses in '" + parameters_.map_frame +
                          "'; expected both to be the same frame");
  }
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
    checkSetMap(toOccupancyGrid(request.map), pose.base_in_map);
    onMap(boost::make_shared<nav_msgs::OccupancyGrid>(request.map));
    // Behind the map on its way through the builder, so that the pose is judged by the new map.
    map_builder_.post([this, pose] { worker_.post([this, pose] { start(pose); }); });
    response.success = true;
  } catch (const std::exception& error) {
    refuse(&NodeStatus::maps_refused, std::string("set_map refused: ") + error.what());
    response.success = false;
  }
  return true;
}

void LocalizationNode::buildMap() {
  const std::optional<nav_msgs::OccupancyGridConstPtr> message = newest_map_.take();
  if (!message) return;
  try {
    OccupancyGrid grid = toOccupancyGrid(**message);
    const Surfaces surfaces = findSurfaces(grid);
    const MapSummary summary = summarize(grid, surfaces);
    const std::shared_ptr<MapModel> map =
        makeMapModel(std::move(grid), surfaces, parameters_.localizer.sensor);
    worker_.post([this, map, summary] { useMap(map, summary); });
  } catch (const std::exception& error) {
    refuse(&NodeStatus::maps_refused,
           std::string("map refused, the one before stays: ") + error.what());
  }
}

void LocalizationNode::report(const MapSummary& summary) {
  ROS_INFO("%s", describe(summary).c_str());
  for (const std::string& line : summary.warnings) {
    const bool said =
        std::find(map_warnings_.begin(), map_warnings_.end(), line) != map_warnings_.end();
    if (!said) ROS_WARN("the map: %s", line.c_str());
  }
  map_warnings_ = summary.warnings;
}

void LocalizationNode::useMap(const std::shared_ptr<MapModel>& map, const MapSummary& summary) {
  report(summary);
  const GridGeometry& geometry = map->grid.geometry();
  bool start_anywhere;
  std::optional<PoseEstimate> pose;
  {
    const std::lock_guard<std::mutex> lock(timeline_mutex_);
    localizer_.setMap(map);
    start_anywhere = parameters_.global_start && !localizer_.initialized();
    pose = localizer_.estimateAt(localizer_.newestStamp().value_or(0.0));
  }
  if (start_anywhere) startGlobally();
  if (pose && !contains(geometry, cellAt(geometry, {pose->base_in_map.x, pose->base_in_map.y}))) {
    refuse(nullptr, "the pose (" + std::to_string(pose->base_in_map.x) + ", " +
                        std::to_string(pose->base_in_map.y) +
                        ") lies outside the new map; expected a start pose on it");
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
  publishVerdict();
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
    publishVerdict();
    ROS_INFO("localizing globally: the car may be anywhere on the map");
  } else {
    refuse(&NodeStatus::starts_refused, "global localization needs a map first");
  }
}

void LocalizationNode::restartAfterTimeJump(double stamp) {
  // A live car's clock may be set back while it drives; only a bag brings the car back too.
  const bool live =
      ros::Time::isSystemTime() && std::abs(ros::Time::now().toSec() - stamp) < kOtherTime;
  const bool restart = parameters_.initial_pose && !live;
  {
    const std::lock_guard<std::mutex> lock(timeline_mutex_);
    last_published_stamp_ = 0.0;
  }
  ROS_WARN("time jumped back%s: odometry starts again%s",
           live ? " as when a clock is set" : " as when a bag loops",
           restart ? " at initial_pose" : "; the pose stays where it was");
  if (restart) start({*parameters_.initial_pose, Eigen::Matrix3d::Zero()});
}

bool LocalizationNode::isStampRefused(const std::string& what, const ros::Time& stamp) {
  std::string problem;
  const ros::Time now = ros::Time::now();
  if (stamp.isZero()) {
    problem = "it carries no stamp; expected the time of measurement";
  } else if (!now.isZero() && stamp.toSec() - now.toSec() > kOtherTime) {
    // Published on, such a stamp would make every tf listener refuse the true ones after it.
    problem =
        "it is stamped more than 10 s ahead of the clock; a bag needs --clock and "
        "use_sim_time";
  } else {
    return false;
  }
  note(what + " dropped: " + problem, &NodeStatus::stamps_refused);
  warn(what + " dropped", problem);
  return true;
}

void LocalizationNode::warn(const std::string& subject, const std::string& reason) {
  if (log_limiter_.isDue(subject, reason)) ROS_WARN("%s: %s", subject.c_str(), reason.c_str());
}

void LocalizationNode::noteError(const std::string& what) {
  const std::string problem = "internal error: " + what;
  note(problem, &NodeStatus::errors);
  if (log_limiter_.isDue("internal error", what)) ROS_ERROR("%s", problem.c_str());
}

void LocalizationNode::note(const std::string& problem, std::uint64_t NodeStatus::*counter) {
  const std::lock_guard<std::mutex> lock(timeline_mutex_);
  if (counter) ++(status_.*counter);
  status_.last_problem = problem;
}

void LocalizationNode::refuse(std::uint64_t NodeStatus::*counter, const std::string& problem) {
  ROS_WARN("%s", problem.c_str());
  note(problem, counter);
}

void LocalizationNode::onVerdictTimer(const ros::WallTimerEvent&) { publishVerdict(); }

void LocalizationNode::onDiagnosticsTimer(const ros::WallTimerEvent&) {
  tf_queue_.callAvailable();
  diagnostic_msgs::DiagnosticArray array;
  array.header.stamp = ros::Time::now();
  NodeStatus status;
  {
    const std::lock_guard<std::mutex> lock(timeline_mutex_);
    status_.has_map = localizer_.hasMap();
    status_.started = localizer_.initialized();
    status_.counters = localizer_.counters();
    status_.sweep_order = localizer_.sweepOrder().word();
    status_.range_bias = localizer_.rangeBias();
    status_.latency_p50 = latency_.quantile(0.5);
    status_.latency_p99 = latency_.quantile(0.99);
    status = status_;
  }
  array.status.push_back(toDiagnostics(status, name_ + ": localization"));
  diagnostics_publisher_.publish(array);
}

}  // namespace racecar_mcl
