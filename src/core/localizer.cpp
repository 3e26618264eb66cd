#include "racecar_mcl/localizer.h"

#include <algorithm>
#include <sstream>
#include <utility>
#include <vector>

#include "racecar_mcl/errors.h"
#include "racecar_mcl/short_returns.h"

namespace racecar_mcl {
namespace {

// Motion between two scans under which the car counts as parked.
constexpr double kParkedDistance = 1e-3;  // m
constexpr double kParkedRotation = 1e-3;  // rad

// For how long and how many scans must be explained badly before the map is searched again, and how
// long it takes at least and at most until the next search if that was in vain.
constexpr double kDoubt = 0.2;  // s
constexpr int kDoubtfulScans = 6;
constexpr double kShortestPause = 0.5;  // s
constexpr double kLongestPause = 16.0;  // s

bool isParked(const Motion& motion) {
  return motion.distance < kParkedDistance && motion.rotation < kParkedRotation;
}

}  // namespace

std::string describe(ScanOutcome outcome) {
  switch (outcome) {
    case ScanOutcome::kUsed:
      return "used";
    case ScanOutcome::kParked:
      return "parked: the estimate stays";
    case ScanOutcome::kNoMap:
      return "no map yet";
    case ScanOutcome::kNoStart:
      return "no start pose yet";
    case ScanOutcome::kNotFinite:
      return "scan stamp is not finite";
    case ScanOutcome::kRepeatedStamp:
      return "scan stamp repeats";
    case ScanOutcome::kOutOfOrder:
      return "scan is older than the last one";
    case ScanOutcome::kTooFewBeams:
      return "scan has too few valid beams";
    case ScanOutcome::kTimeJumpedBack:
      return "scan time jumped back";
    case ScanOutcome::kWeightsVanished:
      return "no particle could have seen this scan";
  }
  return "unknown";
}

Localizer::Localizer(const LocalizerParameters& parameters, std::uint64_t seed)
    : parameters_((validate(parameters), parameters)),
      filter_(parameters.filter, parameters.motion, seed),
      odometry_(parameters.odometry),
      calibration_(parameters.calibration),
      sweep_order_(parameters.sweep_order),
      second_opinion_(parameters.filter, parameters.motion, seed + 1),
      judge_(parameters.verdict) {}

void Localizer::setMap(std::shared_ptr<MapModel> map) { map_ = std::move(map); }

void Localizer::initialize(const PoseEstimate& start) {
  const Pose2& pose = start.base_in_map;
  if (map_ && isFinite(pose)) {
    const GridGeometry& geometry = map_->grid.geometry();
    if (!contains(geometry, cellAt(geometry, {pose.x, pose.y}))) {
      std::ostringstream problem;
      problem << "the start pose (" << pose.x << ", " << pose.y << ") lies outside the map of "
              << geometry.width * geometry.resolution << " x "
              << geometry.height * geometry.resolution << " m with its corner at ("
              << geometry.origin.x << ", " << geometry.origin.y << ")";
      throw ParameterError(problem.str());
    }
  }
  filter_.initialize(start);
  search_pending_ = false;
  anchorHere();
}

bool Localizer::initializeGlobally() {
  if (!map_) return false;
  filter_.initializeGlobally(*map_);
  search_pending_ = parameters_.global_search;
  anchorHere();
  return true;
}

void Localizer::anchorHere() {
  anchor_ = Anchor{filter_.estimate(), odometryAt(newestStamp().value_or(0.0))};
  scans_since_stop_ = 0;
  judge_.startAgain();
  doubt_.startAgain();
  sweep_order_.startAgain();
  recovery_pause_ = kShortestPause;
  second_opinion_.drop();
}

OdometryOutcome Localizer::addOdometry(const OdometrySample& sample) {
  ++counters_.odometry_seen;
  const OdometryOutcome outcome = odometry_.add(sample);
  switch (outcome) {
    case OdometryOutcome::kNotFinite:
    case OdometryOutcome::kImplausible:
    case OdometryOutcome::kRepeatedStamp:
    case OdometryOutcome::kOutOfOrder:
      ++counters_.odometry_dropped;
      return outcome;
    case OdometryOutcome::kTimeJumpedBack:
      ++counters_.time_jumps;
      last_scan_stamp_.reset();
      break;
    case OdometryOutcome::kGap:
      ++counters_.odometry_gaps;
      break;
    case OdometryOutcome::kUsed:
      break;
  }
  ++counters_.odometry_used;
  return outcome;
}

ScanOutcome Localizer::admit(const Scan& scan) {
  if (!std::isfinite(scan.stamp)) return ScanOutcome::kNotFinite;
  if (last_scan_stamp_) {
    const double elapsed = scan.stamp - *last_scan_stamp_;
    if (elapsed == 0.0) return ScanOutcome::kRepeatedStamp;
    if (elapsed <= -parameters_.odometry.clock_jump) {
      ++counters_.time_jumps;
      last_scan_stamp_.reset();
      // Odometry that has not jumped yet knows nothing of the new time.
      if (!odometry_.empty() &&
          scan.stamp <= odometry_.newestStamp() - parameters_.odometry.clock_jump) {
        odometry_.startAgain();
      }
      return ScanOutcome::kTimeJumpedBack;
    }
    if (elapsed < 0.0) return ScanOutcome::kOutOfOrder;
  }
  if (!map_) return ScanOutcome::kNoMap;
  if (!initialized()) return ScanOutcome::kNoStart;
  return ScanOutcome::kUsed;
}

Localizer::ScanTask Localizer::prepareScan(const Scan& scan) {
  ++counters_.scans_seen;
  ScanTask task;
  task.result.stamp = scan.stamp;
  task.result.outcome = admit(scan);
  if (task.result.outcome != ScanOutcome::kUsed) return task;

  task.beams = chooseBeams(parameters_, scan);
  if (task.beams.size() < parameters_.min_beams) {
    task.result.outcome = ScanOutcome::kTooFewBeams;
    judge_.judgeUnusable(scan.stamp);
    return task;
  }
  const OdometryState odometry = odometryAt(scan.stamp);
  task.motion = calibration_.correct(motionBetween(anchor_->odometry, odometry));
  if (parameters_.noise_adaptation) task.motion.noise_factor = doubt_.noiseFactor();
  if (parameters_.deskew) straighten(odometry, &task);
  // Silent odometry is no sign that the car stands.
  const bool heard = !odometry_.empty() &&
                     scan.stamp - odometry_.newestStamp() <= parameters_.odometry.max_odometry_gap;
  // Nor is odometry that says so to be believed while scans say otherwise.
  const bool doubtful = judge_.doubtfulFor() > 0.0;
  scans_since_stop_ = heard && !doubtful && isParked(task.motion) ? scans_since_stop_ + 1 : 0;
  task.predicted = carryForward(anchor_->estimate, task.motion.delta, Eigen::Matrix3d::Zero());
  // What is to confirm a place counts in full.
  if (!second_opinion_.pending()) {
    task.repeat_distance =
        parameters_.map_error_distance * std::max(0.0, kUsualOfGoodMaps - judge_.usual());
  }
  task.search = search_pending_;
  task.recover = !task.search && wantsRecovery(scan.stamp);
  task.weigh = task.search || scans_since_stop_ <= parameters_.parked_updates;
  // A lost filter would take the very beams that say so for obstacles.
  task.reject_short = parameters_.reject_short_returns && !task.recover &&
                      judge_.verdict().state == VerdictState::kLocalized;
  if (!task.weigh) task.result.outcome = ScanOutcome::kParked;
  last_scan_stamp_ = scan.stamp;
  return task;
}

void Localizer::straighten(const OdometryState& at_stamp, ScanTask* task) const {
  if ((task->beams.seconds_after_stamp == 0.0f).all()) return;  // all at once
  const Scan sweep = sweep_order_.inOrderTaken(std::move(task->beams));
  const Pose2 odom_in_base = inverse(at_stamp.base_in_odom);
  const auto base_after = [&](double seconds) {
    return compose(odom_in_base, odometryAt(sweep.stamp + seconds).base_in_odom);
  };
  const auto first = static_cast<double>(sweep.seconds_after_stamp.minCoeff());
  const auto last = static_cast<double>(sweep.seconds_after_stamp.maxCoeff());
  task->turned = between(base_after(first), base_after(last)).yaw;
  if (sweep_order_.wantsToCompare(task->turned)) {
    task->mirrored = deskew(mirroredInTime(sweep), base_after);
  }
  task->beams = deskew(sweep, base_after);
}

bool Localizer::wantsRecovery(double stamp) {
  if (!parameters_.recovery || judge_.doubtfulFor() < kDoubt ||
      judge_.doubtfulScans() < kDoubtfulScans) {
    return false;
  }
  return std::abs(stamp - last_recovery_stamp_) >= recovery_pause_;
}

void Localizer::processScan(ScanTask* task) {
  if (task->result.outcome != ScanOutcome::kUsed && task->result.outcome != ScanOutcome::kParked) {
    return;
  }
  UpdateResult& update = task->result.update;
  const Pose2& predicted = task->predicted.base_in_map;
  if (!task->weigh) {
    update.estimate = task->predicted;
  } else if (task->search) {
    update = filter_.initializeGlobally(*map_, task->beams);
  } else {
    weigh(task);
  }
  const Pose2& estimated = update.estimate.base_in_map;
  task->correction = between(predicted, estimated);
  task->fit = fitScan(map_.get(), estimated, task->beams);
  if (task->mirrored) {
    task->order_log_odds =
        logOddsOfScans(map_->search.field(), estimated, task->beams, *task->mirrored);
  }
  if (task->result.update.weights_vanished) task->result.outcome = ScanOutcome::kWeightsVanished;
}

void Localizer::weigh(ScanTask* task) {
  const bool was_converging = filter_.converging();
  filter_.predict(task->motion);
  task->recovered = task->recover && filter_.reconsider(map_.get(), task->beams);
  const Pose2& predicted = task->predicted.base_in_map;
  task->result.update = filter_.update(
      map_.get(),
      task->reject_short
          ? withoutShortReturns(map_.get(), predicted, task->beams, parameters_.min_beams)
          : task->beams,
      task->repeat_distance);
  if (parameters_.second_opinion) seekSecondOpinion(was_converging, task);
}

void Localizer::seekSecondOpinion(bool was_converging, ScanTask* task) {
  if (filter_.converging()) return;
  bool ask = was_converging;
  if (!ask && second_opinion_.pending()) {
    UpdateResult& update = task->result.update;
    const SecondOpinion::Answer answer =
        second_opinion_.hear(task->motion, map_.get(), task->beams, update.estimate.base_in_map);
    if (answer == SecondOpinion::Answer::kObjects) {
      update = filter_.initialize(second_opinion_.particles(), task->beams);
      task->recovered = ask = true;  // and the next one is to agree with it
    }
  }
  if (!ask) return;
  second_opinion_.ask(*map_, task->beams);
  task->asked = true;
}

Verdict Localizer::judge(const ScanTask& task) {
  const UpdateResult& update = task.result.update;
  Evidence evidence;
  evidence.stamp = task.result.stamp;
  evidence.fit = task.fit;
  evidence.converging = update.converging;
  evidence.unconfirmed = second_opinion_.pending();
  evidence.position_sigma = positionSigma(update.estimate);
  evidence.travelled = task.motion.distance;
  evidence.moved = task.moved();
  evidence.correction = {task.correction.x, task.correction.y};
  return judge_.judge(evidence);
}

void Localizer::learnDoubt(const ScanTask& task) {
  // A jump to another place says nothing of the way there.
  if (task.moved() || task.result.update.converging) return doubt_.startAgain();
  Motion usual = task.motion;
  usual.noise_factor = 1.0;
  doubt_.learn(task.correction, motionCovariance(parameters_.motion, usual), usual.seconds);
}

ScanResult Localizer::commitScan(const ScanTask& task) {
  ScanResult result = task.result;
  result.verdict = judge_.verdict();
  switch (result.outcome) {
    case ScanOutcome::kUsed:
      ++counters_.scans_used;
      break;
    case ScanOutcome::kWeightsVanished:
      ++counters_.weights_vanished;
      break;
    case ScanOutcome::kParked:
      ++counters_.scans_parked;
      result.update.estimate = anchor_->estimate;
      result.verdict = judge(task);
      return result;
    default:
      ++counters_.scans_dropped;
      return result;
  }
  if (task.search) search_pending_ = false;
  if (task.asked) scans_since_stop_ = 0;  // a parked car is to hear it too
  if (task.recovered) ++counters_.recoveries;
  if (task.recover) {
    last_recovery_stamp_ = result.stamp;
    if (!task.recovered) judge_.acceptAsUsual();
    recovery_pause_ =
        task.recovered ? kShortestPause : std::min(2.0 * recovery_pause_, kLongestPause);
  }
  result.verdict = judge(task);
  learnDoubt(task);
  if (result.verdict.state == VerdictState::kLocalized) {
    calibration_.learn(task.motion, task.correction);
    if (task.mirrored && sweep_order_.learn(task.order_log_odds, task.turned)) {
      // What was learned of a sweep that went the other way says nothing of this one.
      calibration_.forgetDelay();
      doubt_.startAgain();
    }
  }
  // Asked again, for what was learned of the delay moves it.
  anchor_ = Anchor{result.update.estimate, odometryAt(result.stamp)};
  return result;
}

ScanResult Localizer::addScan(const Scan& scan) {
  ScanTask task = prepareScan(scan);
  processScan(&task);
  return commitScan(task);
}

std::optional<PoseEstimate> Localizer::estimateAt(double stamp) const {
  if (!anchor_) return std::nullopt;
  const OdometryState then = odometryAt(stamp);
  const Motion motion = calibration_.correct(motionBetween(anchor_->odometry, then));
  return carryForward(anchor_->estimate, motion.delta,
                      motionCovariance(parameters_.motion, motion));
}

std::optional<double> Localizer::newestStamp() const {
  if (odometry_.empty()) return last_scan_stamp_;
  return std::max(odometry_.newestStamp(), last_scan_stamp_.value_or(odometry_.newestStamp()));
}

}  // namespace racecar_mcl
