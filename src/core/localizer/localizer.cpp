#include "racecar_mcl/localizer/localizer.h"

#include <algorithm>

#include "racecar_mcl/scan/beam_selection.h"
#include "racecar_mcl/scan/deskew.h"
#include "racecar_mcl/sensor/distance_filter.h"

namespace racecar_mcl {
namespace {

// The car is stationary if it moves less than this between two scans.
constexpr double kStationaryDistance = 1e-3;  // m
constexpr double kStationaryRotation = 1e-3;  // rad

// Standard deviation of the common position error of the surfaces around the car, in cells. A
// surface may be anywhere in its cell; the range bias removes the part that is common to all
// surfaces.
constexpr double kSurfaceSigma = 0.1;

// Decorrelation distance of a converged set (docs/decisions.md): on every map, since consecutive
// scans end in the same cells, plus, in scan_decorrelation_distance per excess of the outlier ratio
// over the typical one, since they repeat the outliers of an incomplete map.
constexpr double kMinDecorrelationDistance = 0.15;  // m
constexpr double kDecorrelationPerOutlierRatio = 1.5;

/// The motion of a scan's beams: the car's pose at a time after the scan's `stamp`, in its frame at
/// the stamp `from` (s). The odometry must outlive the function.
BaseAfter baseAfter(const CalibratedOdometry& odometry, double stamp, double from) {
  return [&odometry, stamp, origin = odometry.at(from)](double seconds) {
    return odometry.motion(origin, stamp + seconds).delta;
  };
}

ScanCorrection correctionOf(const LidarState& lidar, bool moves) {
  return {lidar.range_bias.bias(), lidar.direction.isReversed(), moves};
}

bool isStationary(const Motion& motion) {
  return motion.distance < kStationaryDistance && motion.rotation < kStationaryRotation;
}

/// Adds the position error of the map's surfaces.
void addSurfaceError(const LocalizationMap& map, PoseEstimate* estimate) {
  const double sigma = kSurfaceSigma * map.grid.geometry().resolution;
  estimate->covariance(0, 0) += sigma * sigma;
  estimate->covariance(1, 1) += sigma * sigma;
}

}  // namespace

ScanResult Localizer::update(const Scan& scan) {
  ScanResult result;
  result.stamp = scan.stamp;
  result.status = monitor_.status();
  ++counters_.scans_seen;
  result.outcome = check(scan);
  result.odometry_lag = extrapolator_.odometryLag(scan.stamp);
  if (result.outcome == ScanOutcome::kUsed) {
    try {
      run(scan, &result);
    } catch (...) {
      recoverFromError();
      throw;
    }
  }
  count(result.outcome);
  return result;
}

ScanOutcome Localizer::check(const Scan& scan) {
  if (!isWithin(scan.laser_in_base, kMaxMountOffset)) return ScanOutcome::kNotFinite;
  if (scan.lidar < 0 || scan.lidar >= kMaxLidars) return ScanOutcome::kTooManyLidars;
  const ScanOutcome outcome = extrapolator_.checkStamp(scan.stamp, scan.lidar);
  if (outcome != ScanOutcome::kUsed) return outcome;
  if (!map_) return ScanOutcome::kNoMap;
  return initialized() ? ScanOutcome::kUsed : ScanOutcome::kNoStart;
}

void Localizer::run(const Scan& scan, ScanResult* result) {
  const Scan selected = preprocessor_.select(scan);
  if (!preprocessor_.isEnough(selected)) {
    result->outcome = ScanOutcome::kTooFewBeams;
    result->status = monitor_.recordUnusableScan(scan.stamp);
    return;
  }
  Step step = preprocess(selected);
  result->stamp = step.stamp;
  PoseEstimate& estimate = result->update.estimate;
  result->range_bias = lidarAt(scan.lidar).range_bias.bias();
  result->distance_scale = calibration_.distanceScale();
  result->turn_scale = calibration_.odometryTurn().scale();
  result->turned_by_gyro = step.motion.turned_by_gyro;
  if (step.is_stationary) {
    result->outcome = ScanOutcome::kStationary;
    estimate = step.before;
    monitor(step.predicted, &step, result);
    return;
  }
  if (global_start_pending_) {
    initializeFromScan(&step, &result->update);
  } else {
    predict(&step);
    const bool was_converged = filter_.converged();
    reweight(step, &result->update);
    relocalize(filter_.converged() && !was_converged, &step, &result->update);
  }
  addSurfaceError(*map_, &estimate);
  if (result->update.weights_vanished) result->outcome = ScanOutcome::kWeightsVanished;
  monitor(estimate, &step, result);
  learn(step, *result);
  extrapolator_.setReference(estimate, step.stamp, calibration_, noise_adaptation_.noiseScale(),
                             slip_compensation_);
}

Scan Localizer::correctedScan(const Scan& scan, int count) const {
  const Scan selected = selectBeams(scan, count, parameters_.scan.scan_field_of_view);
  const CalibratedOdometry odometry = extrapolator_.odometryOver(selected);
  const double stamp = extrapolator_.evaluationStamp(scan.stamp);
  return preprocessor_
      .correct(selected,
               correctionOf(lidars_.at(static_cast<std::size_t>(scan.lidar)), stamp != scan.stamp),
               baseAfter(odometry, scan.stamp, stamp))
      .beams;
}

Localizer::Step Localizer::preprocess(const Scan& selected) {
  const PoseExtrapolator::ScanMotion motion = extrapolator_.beginScan(selected);
  const BaseAfter base_after = baseAfter(motion.odometry, selected.stamp, motion.stamp);
  const LidarState& lidar = lidarAt(selected.lidar);
  Step step;
  step.stamp = motion.stamp;
  step.scan = preprocessor_.correct(selected, correctionOf(lidar, motion.stamp != selected.stamp),
                                    base_after);
  if (lidar.direction.needsComparison(step.scan.turned)) {
    step.mirrored = deskew(mirroredInTime(step.scan.sweep), base_after);
  }
  step.odometry_motion = motion.odometry_motion;
  step.motion = motion.motion;
  step.before = motion.before;
  step.predicted = propagate(step.before, step.motion.delta, Eigen::Matrix3d::Zero());
  // Without recent or right odometry, or if scans contradict the pose, the car may be moving.
  const bool is_stationary = motion.odometry_is_new && !recovery_.inConflict() &&
                             !step.motion.compensation && isStationary(step.motion);
  // A scan at the stamp of another lidar's does not show whether the car moves.
  if (step.motion.duration != 0.0) scans_since_stop_ = is_stationary ? scans_since_stop_ + 1 : 0;
  step.is_stationary = !global_start_pending_ && scans_since_stop_ > parameters_.stationary_updates;
  return step;
}

void Localizer::predict(Step* step) {
  step->is_refined =
      parameters_.lidar_odometry && filter_.converged() && !monitor_.mapIsInformative();
  if (step->is_refined) {
    step->motion = lidar_odometry_.refine(step->motion, step->scan.beams);
    step->predicted = propagate(step->before, step->motion.delta, Eigen::Matrix3d::Zero());
  }
  filter_.predict(step->motion);
}

void Localizer::reweight(const Step& step, UpdateResult* update) {
  const MapView map = map_->view();
  const Scan& scan = step.scan.beams;
  // Only while localized: at a wrong pose the beams that contradict it would be rejected.
  const bool rejects_obstacles =
      parameters_.distance_filter && status().state == LocalizationState::kLocalized;
  const Pose2 lidar = compose(step.predicted.base_in_map, scan.laser_in_base);
  std::optional<LikelihoodFieldModel> other;
  if (const LikelihoodField* const field = map_->fieldInstead(filter_.converged(), lidar, scan)) {
    other.emplace(*field, parameters_.filter.num_threads);
  }
  SensorModel* const model = other ? &*other : sensor_model_.get();
  std::optional<Scan> filtered;
  if (rejects_obstacles) {
    filtered =
        withoutShortReturns(map, step.predicted.base_in_map, scan, parameters_.scan.min_beams);
  }
  *update = filter_.update(filtered ? *filtered : scan, model, &map, decorrelationDistance());
}

double Localizer::decorrelationDistance() const {
  // While a place is being confirmed, scans count in full.
  if (verifier_.confirming()) return 0.0;
  const double distance = parameters_.filter.scan_decorrelation_distance;
  if (distance == 0.0) return 0.0;
  return kMinDecorrelationDistance + kDecorrelationPerOutlierRatio * distance *
                                         std::max(0.0, kTypicalInlierRatio - monitor_.baseline());
}

void Localizer::relocalize(bool just_converged, Step* step, UpdateResult* update) {
  using Purpose = HypothesisVerifier::Purpose;
  using Decision = HypothesisVerifier::Decision;
  if (!filter_.converged()) return;
  const Scan& scan = step->scan.beams;
  if (verifier_.confirming() || verifier_.challenging()) {
    const bool challenges = verifier_.challenging();
    const Decision decision = verifier_.update(step->motion, searchMap(), scan, update->estimate);
    if (decision == Decision::kProven) {
      *update = filter_.replaceSet(verifier_.particles());
      update->beams = static_cast<int>(scan.size());
      step->jumped = just_converged = true;
      verifier_.stop();
      recovery_.reset();
      ++counters_.recoveries;
    } else if (challenges && decision != Decision::kUndecided) {
      recovery_.onRejected(step->stamp);
    }
    // While it is tested, the alternative place is reported as a cluster.
    if (verifier_.challenging() && verifier_.candidate()) {
      update->clusters.push_back({*verifier_.candidate(), verifier_.candidateProbability(), 0});
    }
  } else if (parameters_.relocalization == Relocalization::kFull && recovery_.searchIsDue()) {
    verifier_.start(Purpose::kChallenge, searchMap(), scan, monitor_.wasLocalized());
  }
  if (!just_converged || parameters_.relocalization == Relocalization::kOff) return;
  verifier_.start(Purpose::kConfirm, searchMap(), scan);
  scans_since_stop_ = 0;  // scans of a stationary car are used for the confirmation
}

}  // namespace racecar_mcl
