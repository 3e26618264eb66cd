#include "replay_run.h"

#include <chrono>
#include <map>

#include "racecar_mcl/scan_hold.h"

namespace racecar_mcl {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Estimates by stamp. A scan's replaces what odometry said of that stamp, never the other way.
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

/// Starts the localizer once the recording has reached a pose's stamp. The localizer takes a start
/// pose to hold at the newest stamp it has seen, so the pose is carried there by odometry first.
class TimedStarter {
 public:
  TimedStarter(const std::optional<TimedStart>& start, const OdometryParameters& parameters)
      : start_(start), odometry_(parameters) {}

  void addOdometry(const OdometrySample& sample, Nanoseconds stamp, Localizer* localizer) {
    if (!start_) return;
    odometry_.add(sample);
    reach(stamp, localizer);
  }

  void reach(Nanoseconds stamp, Localizer* localizer) {
    if (!start_ || stamp < start_->stamp) return;
    PoseEstimate now = start_->estimate;
    if (const std::optional<double> newest = localizer->newestStamp()) {
      const OdometryState then = odometry_.at(toSeconds(start_->stamp));
      now.base_in_map =
          compose(now.base_in_map, between(then.base_in_odom, odometry_.at(*newest).base_in_odom));
    }
    localizer->initialize(now);
    start_.reset();
  }

 private:
  std::optional<TimedStart> start_;
  OdometryHistory odometry_;
};

struct HeldScan {
  Nanoseconds stamp = 0;
  Scan scan;
};

class Run {
 public:
  Run(const ReplayInput& input, Localizer* localizer, const std::vector<ReplayObserver*>& observers)
      : mount_(input.mount),
        localizer_(localizer),
        observers_(observers),
        starter_(input.start, localizer->parameters().odometry) {}

  void add(const BagEvent& event) {
    now_ = event.recorded.toSec();
    if (event.odometry) {
      takeWaitedLongEnough();
      addOdometry(*event.odometry);
    } else {
      hold(*event.scan);
    }
    takeReady();
    observe([this](ReplayObserver* observer) { observer->onMessage(*localizer_); });
  }

  /// s, that the observers took.
  double observedSeconds() const { return observed_seconds_; }

  ReplayRecord finish() {
    while (std::optional<HeldScan> held = hold_.take()) addScan(*held);
    observe([this](ReplayObserver* observer) { observer->onMessage(*localizer_); });
    record_.trajectory = trajectory_.build();
    return std::move(record_);
  }

 private:
  void addOdometry(const nav_msgs::Odometry& message) {
    const OdometrySample sample = toOdometrySample(message);
    const Nanoseconds stamp = toNanoseconds(message.header.stamp);
    localizer_->addOdometry(sample);
    starter_.addOdometry(sample, stamp, localizer_);
    takeReady();
    if (const std::optional<PoseEstimate> estimate = localizer_->estimateAt(sample.stamp)) {
      trajectory_.addFromOdometry(stamp, estimate->base_in_map);
    }
  }

  void hold(const sensor_msgs::LaserScan& message) {
    ++record_.scans_seen;
    try {
      HeldScan held{toNanoseconds(message.header.stamp), toScan(message, mount_)};
      const double stamp = held.scan.stamp;
      hold_.add(stamp, now_, std::move(held));
    } catch (const MessageError& error) {
      if (record_.scans_refused++ == 0) record_.first_refusal = error.what();
    }
  }

  /// A live driver's timer would have fired before this message came.
  void takeWaitedLongEnough() {
    while (std::optional<HeldScan> held = hold_.takeReady(now_, [](double) { return false; })) {
      addScan(*held);
    }
  }

  void takeReady() {
    const auto covers = [this](double stamp) { return localizer_->odometryCovers(stamp); };
    while (std::optional<HeldScan> held = hold_.takeReady(now_, covers)) addScan(*held);
  }

  void addScan(const HeldScan& held) {
    starter_.reach(held.stamp, localizer_);
    const Clock::time_point start = Clock::now();
    ScanResult result = localizer_->addScan(held.scan);
    const double update_ms = 1e3 * secondsSince(start);
    if (leavesEstimate(result.outcome)) {
      trajectory_.addFromScan(held.stamp, result.update.estimate.base_in_map);
      record_.scans.push_back({held.stamp, std::move(result), update_ms});
      observe([&](ReplayObserver* observer) {
        observer->onScan(held.scan, record_.scans.back(), *localizer_);
      });
    } else if (result.outcome == ScanOutcome::kTooFewBeams) {
      trajectory_.addFromOdometry(held.stamp, localizer_->estimateAt(held.scan.stamp)->base_in_map);
    }
  }

  template <typename Call>
  void observe(Call&& call) {
    if (observers_.empty()) return;
    const Clock::time_point start = Clock::now();
    for (ReplayObserver* observer : observers_) call(observer);
    observed_seconds_ += secondsSince(start);
  }

  LaserMount mount_;
  Localizer* localizer_;
  std::vector<ReplayObserver*> observers_;
  double observed_seconds_ = 0.0;
  TimedStarter starter_;
  ScanHold<HeldScan> hold_;
  TrajectoryBuilder trajectory_;
  ReplayRecord record_;
  double now_ = 0.0;
};

}  // namespace

ReplayRecord runReplay(const BagReader& bags, const ReplayInput& input, Localizer* localizer,
                       const std::function<void()>& progress,
                       const std::vector<ReplayObserver*>& observers) {
  const Clock::time_point start = Clock::now();
  Run run(input, localizer, observers);
  std::optional<ros::Time> first;
  ros::Time last;
  const auto add = [&](const BagEvent& event) {
    if (!first) first = event.recorded;
    last = event.recorded;
    run.add(event);
    progress();
  };
  if (input.odometry_from_tf) {
    bags.forEach(input.scan_topic, *input.odometry_from_tf, add);
  } else {
    bags.forEach(input.scan_topic, input.odometry_topic, add);
  }
  ReplayRecord record = run.finish();
  record.duration = first ? (last - *first).toSec() : 0.0;
  record.wall_seconds = secondsSince(start) - run.observedSeconds();
  return record;
}

}  // namespace racecar_mcl
