#include "offline/offline_driver.h"

#include <chrono>
#include <map>
#include <stdexcept>

#include "racecar_mcl/localizer/scan_queue.h"

namespace racecar_mcl {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Estimates by stamp. The estimate after a scan replaces the odometry prediction for the same
/// stamp, never the other way.
class TrajectoryBuilder {
 public:
  void addFromOdometry(Nanoseconds stamp, const Pose2& pose) { poses_.emplace(stamp, pose); }
  void addFromScan(Nanoseconds stamp, const Pose2& pose) { poses_[stamp] = pose; }

  Trajectory build() const {
    Trajectory trajectory;
    trajectory.reserve(poses_.size());
    for (const auto& [stamp, pose] : poses_) trajectory.push_back({stamp, pose});
    return trajectory;
  }

 private:
  std::map<Nanoseconds, Pose2> poses_;
};

/// Initializes the localizer once the recording has reached the start pose's stamp.
class DelayedInitializer {
 public:
  explicit DelayedInitializer(const std::optional<TimedStart>& start) : start_(start) {}

  void initializeOnceReached(Nanoseconds stamp, Localizer* localizer) {
    if (!start_ || stamp < start_->stamp) return;
    localizer->initialize(start_->estimate, toSeconds(start_->stamp));
    start_.reset();
  }

 private:
  std::optional<TimedStart> start_;
};

constexpr char kNoStamp[] = "the stamp is zero; expected the time of measurement";

struct QueuedScan {
  Nanoseconds stamp = 0;
  Scan scan;
};

/// Feeds recorded messages to the localizer in the order of the node: scans wait for odometry.
class OfflineDriver {
 public:
  OfflineDriver(const ReplayInput& input, Localizer* localizer,
                const std::vector<ReplayObserver*>& observers)
      : extrinsics_of_(input.extrinsics_of),
        imu_rotation_(input.imu_rotation),
        localizer_(localizer),
        observers_(observers),
        initializer_(input.start) {}

  void add(const BagEvent& event) {
    now_ = event.recorded.toSec();
    if (event.imu) {
      addImu(*event.imu);
    } else if (event.odometry) {
      processOverdueScans();
      addOdometry(*event.odometry);
    } else {
      enqueue(*event.scan, event.scan_topic);
    }
    processReadyScans();
    observe([this](ReplayObserver* observer) { observer->onMessage(*localizer_); });
  }

  /// Time spent in the observers, s.
  double observedSeconds() const { return observed_seconds_; }

  ReplayRecord finish() {
    while (std::optional<QueuedScan> queued = queue_.take()) processScan(*queued);
    observe([this](ReplayObserver* observer) { observer->onMessage(*localizer_); });
    record_.trajectory = trajectory_.build();
    record_.lidars = lidars_.lidars();
    return std::move(record_);
  }

 private:
  void addOdometry(const nav_msgs::Odometry& message) {
    const OdometrySample sample = toOdometrySample(message);
    const Nanoseconds stamp = toNanoseconds(message.header.stamp);
    if (stamp == 0) return recordDrop("odometry", kNoStamp);
    const OdometryOutcome outcome = localizer_->addOdometry(sample);
    if (!isUsed(outcome)) recordDrop("odometry", toString(outcome));
    if (outcome == OdometryOutcome::kStampOutlier) return;  // there is no pose at a wrong stamp
    initializer_.initializeOnceReached(stamp, localizer_);
    processReadyScans();
    if (const std::optional<PoseEstimate> estimate = localizer_->estimateAt(sample.stamp)) {
      trajectory_.addFromOdometry(stamp, estimate->base_in_map);
    }
  }

  void addImu(const sensor_msgs::Imu& message) {
    try {
      localizer_->addGyro(toGyroSample(message, imu_rotation_));
    } catch (const MessageError& error) {
      if (record_.imu_rejection.empty()) record_.imu_rejection = error.what();
    }
  }

  /// Does not search again for a frame that is unknown.
  LidarExtrinsics extrinsicsOf(const std::string& frame) {
    if (const auto problem = unknown_frames_.find(frame); problem != unknown_frames_.end()) {
      throw MessageError(problem->second);
    }
    try {
      return extrinsics_of_(frame);
    } catch (const std::runtime_error& error) {
      unknown_frames_[frame] = error.what();
      throw MessageError(error.what());
    }
  }

  void enqueue(const sensor_msgs::LaserScan& message, const std::string& topic) {
    ++record_.scans_seen;
    if (message.header.stamp.isZero()) return recordDrop("scan", kNoStamp);
    const bool deskew = localizer_->parameters().scan.deskew;
    try {
      const std::string frame = stripLeadingSlash(message.header.frame_id);
      QueuedScan queued{toNanoseconds(message.header.stamp),
                        toScan(message, extrinsicsOf(frame), deskew)};
      const int lidar = queued.scan.lidar = lidars_.add(frame, topic);
      const double stamp = queued.scan.stamp;
      queue_.add(stamp, now_, std::move(queued), lidar);
    } catch (const MessageError& error) {
      recordDrop("scan", error.what());
    }
  }

  /// Scans whose maximum wait had elapsed before this message was recorded.
  void processOverdueScans() {
    while (std::optional<QueuedScan> queued =
               queue_.takeReady(now_, [](double) { return false; })) {
      processScan(*queued);
    }
  }

  void processReadyScans() {
    const auto covers = [this](double stamp) { return localizer_->odometryCovers(stamp); };
    while (std::optional<QueuedScan> queued = queue_.takeReady(now_, covers)) processScan(*queued);
  }

  void processScan(const QueuedScan& queued) {
    initializer_.initializeOnceReached(queued.stamp, localizer_);
    const Clock::time_point start = Clock::now();
    ScanResult result = localizer_->update(queued.scan);
    const double update_ms = 1e3 * secondsSince(start);
    if (const std::string problem = clockProblem(result); !problem.empty()) {
      record_.clock_problem = problem;
    }
    if (hasEstimate(result.outcome)) {
      // A newer scan of another lidar may have been used before.
      newest_used_ = result.stamp > queued.scan.stamp ? newest_used_ : queued.stamp;
      trajectory_.addFromScan(newest_used_, result.update.estimate.base_in_map);
      lidars_.countUsed(queued.scan.lidar);
      record_.scans.push_back({newest_used_, queued.scan.lidar, std::move(result), update_ms});
      observe([&](ReplayObserver* observer) {
        observer->onScan(queued.scan, record_.scans.back(), *localizer_);
      });
      return;
    }
    if (result.outcome != ScanOutcome::kNoStart) recordDrop("scan", toString(result.outcome));
    if (result.outcome == ScanOutcome::kTooFewBeams) {
      trajectory_.addFromOdometry(queued.stamp,
                                  localizer_->estimateAt(queued.scan.stamp)->base_in_map);
    }
  }

  void recordDrop(const std::string& kind, const std::string& reason) {
    ++record_.dropped[kind + " dropped: " + reason];
  }

  template <typename Call>
  void observe(Call&& call) {
    if (observers_.empty()) return;
    const Clock::time_point start = Clock::now();
    for (ReplayObserver* observer : observers_) call(observer);
    observed_seconds_ += secondsSince(start);
  }

  std::function<LidarExtrinsics(const std::string&)> extrinsics_of_;
  std::map<std::string, std::string> unknown_frames_;  ///< with the reason
  LidarRegistry lidars_;
  geometry_msgs::Quaternion imu_rotation_;
  Localizer* localizer_;
  std::vector<ReplayObserver*> observers_;
  double observed_seconds_ = 0.0;
  DelayedInitializer initializer_;
  ScanQueue<QueuedScan> queue_;
  TrajectoryBuilder trajectory_;
  Nanoseconds newest_used_ = 0;  ///< stamp of the newest scan with an estimate
  ReplayRecord record_;
  double now_ = 0.0;
};

}  // namespace

ReplayRecord runReplay(const BagReader& bags, const ReplayInput& input, Localizer* localizer,
                       const std::function<void()>& progress,
                       const std::vector<ReplayObserver*>& observers) {
  const Clock::time_point start = Clock::now();
  OfflineDriver driver(input, localizer, observers);
  std::optional<ros::Time> first;
  ros::Time last;
  const auto add = [&](const BagEvent& event) {
    if (!first) first = event.recorded;
    last = event.recorded;
    driver.add(event);
    progress();
  };
  const BagTopics topics{input.scan_topics, input.odometry_topic, input.imu_topic};
  if (input.odometry_from_tf) {
    bags.forEach(topics, *input.odometry_from_tf, add);
  } else {
    bags.forEach(topics, add);
  }
  ReplayRecord record = driver.finish();
  record.duration = first ? (last - *first).toSec() : 0.0;
  record.wall_seconds = secondsSince(start) - driver.observedSeconds();
  return record;
}

}  // namespace racecar_mcl
