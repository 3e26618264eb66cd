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

// By how much of a cell the surfaces about the car may be off together, as a sigma. A surface lies
// anywhere in its cell; what is common to all of them the range bias takes out.
constexpr double kSurfaceCells = 0.1;

// The share of beams that the map must explain for scans to be trusted against the odometry.
constexpr double kTrustedMap = 0.9;

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

bool leavesEstimate(ScanOutcome outcome) {
  return outcome == ScanOutcome::kUsed || outcome == ScanOutcome::kParked ||
         outcome == ScanOutcome::kWeightsVanished;
}

Localizer::Localizer(const LocalizerParameters& parameters, std::uint64_t seed)
    : parameters_((validate(parameters), parameters)),
      filter_(parameters.filter, parameters.motion, seed),
      odometry_(parameters.odometry),
      calibration_(parameters.calibration),
      range_bias_(parameters.range_bias),
      sweep_order_(parameters.sweep_order),
      verifier_(parameters.filter, parameters.motion, seed + 1),
      judge_(parameters.verdict, parameters.protection),
      lidar_odometry_(parameters.filter, parameters.motion, parameters.sensor.field, seed + 2) {}

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
  recovery_.reset();
  challenge_pending_ = false;
  verifier_.stop();
  lidar_odometry_.reset();
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

Motion Localizer::motionTo(const OdometryState& odometry) const {
  Motion motion = calibration_.correct(motionBetween(anchor_->odometry, odometry));
  if (parameters_.noise_adaptation) motion.noise_factor = doubt_.noiseFactor();
  return motion;
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
  range_bias_.correct(&task.beams);
  task.result.range_bias = range_bias_.bias();
  if (task.beams.size() < parameters_.min_beams) {
    task.result.outcome = ScanOutcome::kTooFewBeams;
    judge_.judgeUnusable(scan.stamp);
    return task;
  }
  const OdometryState odometry = odometryAt(scan.stamp);
  task.motion = motionTo(odometry);
  if (parameters_.deskew) straighten(odometry, &task);
  // Silent odometry is no sign that the car stands.
  const bool heard = !odometry_.empty() &&
                     scan.stamp - odometry_.newestStamp() <= parameters_.odometry.max_odometry_gap;
  // Nor is odometry that says so to be believed while scans say otherwise.
  scans_since_stop_ =
      heard && !recovery_.inConflict() && isParked(task.motion) ? scans_since_stop_ + 1 : 0;
  task.before = anchor_->estimate;
  task.predicted = carryForward(anchor_->estimate, task.motion.delta, Eigen::Matrix3d::Zero());
  // What is to confirm a place counts in full.
  if (!verifier_.confirming()) {
    task.repeat_distance =
        parameters_.map_error_distance * std::max(0.0, kUsualOfGoodMaps - judge_.usual());
  }
  task.search = search_pending_;
  task.carry =
      parameters_.lidar_odometry && !task.search && !filter_.converging() && judge_.mapIsSilent();
  task.challenge = challenge_pending_;
  task.was_localized = judge_.wasLocalized();
  task.weigh = task.search || scans_since_stop_ <= parameters_.parked_updates;
  // A lost filter would take the very beams that say so for obstacles.
  task.reject_short =
      parameters_.reject_short_returns && judge_.verdict().state == VerdictState::kLocalized;
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
  // Scans know the surfaces no better than the map's cells show them.
  const double surface_sigma = kSurfaceCells * map_->grid.geometry().resolution;
  if (task->weigh) {
    update.estimate.covariance(0, 0) += surface_sigma * surface_sigma;
    update.estimate.covariance(1, 1) += surface_sigma * surface_sigma;
  }
  const Pose2& estimated = update.estimate.base_in_map;
  task->correction = between(predicted, estimated);
  task->result.fit = fitScan(map_.get(), estimated, task->beams);
  if (task->mirrored) {
    task->order_log_odds =
        logOddsOfScans(map_->search.field(), estimated, task->beams, *task->mirrored);
  }
  if (task->result.update.weights_vanished) task->result.outcome = ScanOutcome::kWeightsVanished;
}

void Localizer::weigh(ScanTask* task) {
  const bool was_converging = filter_.converging();
  if (task->carry) {
    task->motion = lidar_odometry_.refine(task->motion, task->beams);
    task->predicted = carryForward(task->before, task->motion.delta, Eigen::Matrix3d::Zero());
  }
  filter_.predict(task->motion);
  const Pose2& predicted = task->predicted.base_in_map;
  task->result.update = filter_.update(
      map_.get(),
      task->reject_short
          ? withoutShortReturns(map_.get(), predicted, task->beams, parameters_.min_beams)
          : task->beams,
      task->repeat_distance);
  verify(was_converging, task);
}

void Localizer::verify(bool was_converging, ScanTask* task) {
  using Purpose = HypothesisVerifier::Purpose;
  using Decision = HypothesisVerifier::Decision;
  if (filter_.converging()) return;
  UpdateResult& update = task->result.update;
  bool confirm = was_converging;
  if (verifier_.confirming() || verifier_.challenging()) {
    const bool challenging = verifier_.challenging();
    const Decision decision =
        verifier_.update(task->motion, map_.get(), task->beams, update.estimate);
    if (decision == Decision::kProven) {
      update = filter_.initialize(verifier_.particles(), task->beams);
      task->recovered = confirm = true;  // and another search is to agree with it
      verifier_.stop();
    }
    task->rejected =
        challenging && (decision == Decision::kRejected || decision == Decision::kConfirmed);
    // Another place is one of the places where the car may be while it is tested.
    if (verifier_.challenging() && verifier_.candidate()) {
      update.clusters.push_back({*verifier_.candidate(), verifier_.candidateProbability(), 0});
    }
  } else if (task->challenge) {
    verifier_.start(Purpose::kChallenge, *map_, task->beams, task->was_localized);
  }
  if (!confirm || !parameters_.second_opinion) return;
  verifier_.start(Purpose::kConfirm, *map_, task->beams);
  task->asked = true;
}

Verdict Localizer::judge(const ScanTask& task) {
  const UpdateResult& update = task.result.update;
  Evidence evidence;
  evidence.stamp = task.result.stamp;
  evidence.fit = task.result.fit;
  evidence.converging = update.converging;
  evidence.unconfirmed = verifier_.confirming();
  evidence.position_sigma = positionSigma(update.estimate);
  evidence.estimate = update.estimate;
  evidence.travelled = task.motion.distance;
  evidence.moved = task.moved();
  evidence.correction = {task.correction.x, task.correction.y};
  return judge_.judge(evidence);
}

void Localizer::lookForConflict(const ScanResult& result) {
  challenge_pending_ =
      recovery_.update({result.stamp, !filter_.converging(), result.verdict.conflict}) &&
      parameters_.recovery && !verifier_.confirming() && !verifier_.challenging();
}

void Localizer::learnDoubt(const ScanTask& task) {
  // A jump to another place says nothing of the way there.
  if (task.moved() || task.result.update.converging) return doubt_.startAgain();
  // Where the map is wrong, scans contradict good odometry as well.
  if (judge_.verdict().explained < kTrustedMap) return doubt_.startAgain();
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
      lookForConflict(result);
      return result;
    default:
      ++counters_.scans_dropped;
      return result;
  }
  if (task.search) search_pending_ = false;
  if (task.asked) scans_since_stop_ = 0;  // a parked car is to hear it too
  if (task.recovered) {
    ++counters_.recoveries;
    recovery_.reset();
  }
  if (task.rejected) recovery_.onRejected(result.stamp);
  result.verdict = judge(task);
  lookForConflict(result);
  learnDoubt(task);
  if (task.moved() || result.update.converging) {
    lidar_odometry_.reset();
  } else if (!task.carry && parameters_.lidar_odometry) {
    lidar_odometry_.remember(task.beams, result.update.estimate.base_in_map);
  }
  if (result.verdict.state == VerdictState::kLocalized) {
    calibration_.learn(task.motion, task.correction);
    // A sweep that lies better on the map the other way about is bent.
    const bool is_bent = task.mirrored && task.order_log_odds < 0.0;
    if (map_->likelihood_field && !is_bent) {
      range_bias_.learn(*map_->likelihood_field, result.update.estimate.base_in_map, task.beams,
                        task.motion.distance);
    }
    if (task.mirrored && sweep_order_.learn(task.order_log_odds, task.turned)) {
      // What was learned of a sweep that went the other way says nothing of this one.
      calibration_.forgetDelay();
      range_bias_.reset();
      doubt_.startAgain();
    }
  }
  // Asked again, for what was learned of the delay moves it.
  anchor_ = Anchor{result.update.estimate, odometryAt(result.stamp)};
  return result;
}

void Localizer::abandonScan() {
  ++counters_.scans_failed;
  verifier_.stop();
  lidar_odometry_.reset();
  if (!initialized()) return;
  if (filter_.converging()) {
    initializeGlobally();
  } else {
    filter_.initialize(anchor_->estimate);
  }
}

ScanResult Localizer::addScan(const Scan& scan) {
  ScanTask task = prepareScan(scan);
  processScan(&task);
  return commitScan(task);
}

std::optional<PoseEstimate> Localizer::estimateAt(double stamp) const {
  if (!anchor_) return std::nullopt;
  const Motion motion = motionTo(odometryAt(stamp));
  return carryForward(anchor_->estimate, motion.delta,
                      motionCovariance(parameters_.motion, motion));
}

std::optional<double> Localizer::newestStamp() const {
  if (odometry_.empty()) return last_scan_stamp_;
  return std::max(odometry_.newestStamp(), last_scan_stamp_.value_or(odometry_.newestStamp()));
}

}  // namespace racecar_mcl
