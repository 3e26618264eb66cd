// Monitoring of the localizer and online estimation of the sensors' systematic errors.
#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "racecar_mcl/localizer/localizer.h"
#include "racecar_mcl/sensor/scan_direction.h"

namespace racecar_mcl {
namespace {

// Minimum inlier ratio of scans whose corrections are taken as errors of the odometry: where the
// map is wrong, scans contradict correct odometry as well.
constexpr double kMinInlierRatioForAdaptation = 0.9;
// Minimum inlier ratio, of the baseline or of a scan, where the map shows nearly all that the lidar
// sees.
constexpr double kMinInlierRatioOfCompleteMap = 0.9;

PoseCorrection correctionOf(const PoseEstimate& predicted, const PoseEstimate& estimate) {
  const Eigen::Matrix2d into_frame =
      Eigen::Rotation2Dd(-predicted.base_in_map.yaw).toRotationMatrix();
  const auto inFrame = [&](const Eigen::Matrix3d& covariance) -> Eigen::Matrix2d {
    return into_frame * covariance.topLeftCorner<2, 2>() * into_frame.transpose();
  };
  return {between(predicted.base_in_map, estimate.base_in_map), inFrame(predicted.covariance),
          inFrame(estimate.covariance)};
}

}  // namespace

void Localizer::monitor(const PoseEstimate& estimate, Step* step, ScanResult* result) {
  const Scan& beams = step->scan.beams;
  // Of the odometry, or of the motion that scan matching refined.
  const Pose2& delta = step->is_refined ? step->motion.delta : step->odometry_motion.delta;
  const Pose2 correction = between(compose(step->before.base_in_map, delta), estimate.base_in_map);
  result->match = match_evaluator_.evaluate(map_->view(), estimate.base_in_map, beams);
  const LikelihoodField& field =
      map_->likelihood_field ? *map_->likelihood_field : map_->matcher.field();
  step->score = scanScore(field, compose(estimate.base_in_map, beams.laser_in_base), beams);
  MonitorInput input;
  input.stamp = result->stamp;
  input.match = result->match;
  input.converged = filter_.converged();
  input.unconfirmed = verifier_.confirming();
  input.estimate = estimate;
  input.localizability = localizabilityOf(poseInformation(step->score), estimate.base_in_map.yaw);
  input.travelled = step->motion.distance;
  input.jumped = step->jumped;
  input.correction = {correction.x, correction.y};
  result->status = monitor_.update(input);
  recovery_.update({result->stamp, filter_.converged(), result->status.conflict});
}

void Localizer::learn(const Step& step, const ScanResult& result) {
  for (LidarState& lidar : lidars_) lidar.travelled += step.motion.distance;
  const double travelled = std::exchange(lidarAt(step.scan.beams.lidar).travelled, 0.0);
  const Pose2& estimate = result.update.estimate.base_in_map;
  if (step.jumped || !filter_.converged()) {
    noise_adaptation_.reset();
    slip_compensation_.reset();
    lidar_odometry_.reset();
    calibration_.restart();
    return;
  }
  if (parameters_.slip_compensation) {
    slip_compensation_.learn(step.odometry_motion, between(step.before.base_in_map, estimate));
  } else {
    slip_compensation_.reset();
  }
  if (!parameters_.noise_adaptation || step.motion.compensation ||
      result.status.inlier_ratio < kMinInlierRatioForAdaptation) {
    noise_adaptation_.reset();
  } else {
    Motion motion = step.motion;
    motion.noise_scale = 1.0;
    noise_adaptation_.learn(between(step.predicted.base_in_map, estimate),
                            motionCovariance(parameters_.motion, motion), motion.seconds);
  }
  if (parameters_.lidar_odometry && !step.is_refined) {
    lidar_odometry_.remember(step.scan.beams, estimate);
  }
  if (result.status.state == LocalizationState::kLocalized && !step.motion.compensation) {
    calibrate(step, result, travelled);
  }
}

void Localizer::calibrate(const Step& step, const ScanResult& result, double travelled) {
  const Pose2& estimate = result.update.estimate.base_in_map;
  LidarState& lidar = lidarAt(step.scan.beams.lidar);
  const PoseEstimate predicted =
      propagate(step.before, step.motion.delta, motionCovariance(parameters_.motion, step.motion));
  calibration_.learn(step.motion, correctionOf(predicted, result.update.estimate),
                     {monitor_.baseline() >= kMinInlierRatioOfCompleteMap,
                      result.status.inlier_ratio >= kMinInlierRatioOfCompleteMap});
  const double direction_log_odds =
      step.mirrored ? scanLogOdds(map_->matcher.field(), estimate, step.scan.beams, *step.mirrored)
                    : 0.0;
  // A sweep that fits the map better in the opposite order is distorted.
  if (map_->likelihood_field && !(direction_log_odds < 0.0)) {
    lidar.range_bias.learn(step.score, travelled);
  }
  if (step.mirrored && lidar.direction.learn(direction_log_odds, step.scan.turned)) {
    // Discard what was estimated from sweeps deskewed in the wrong order.
    calibration_.forgetDelay();
    lidar.range_bias.reset();
    noise_adaptation_.reset();
  }
}

SensorCalibration Localizer::sensorCalibration() const {
  SensorCalibration sensors{calibration_.errors(), {}};
  for (const LidarState& lidar : lidars_) {
    sensors.lidars.push_back({lidar.range_bias.bias(), lidar.direction.isReversed()});
  }
  return sensors;
}

void Localizer::resumeCalibration(const SensorCalibration& calibration) {
  calibration_.resume(calibration.odometry);
  int index = 0;
  for (const LidarCalibration& of_lidar : calibration.lidars) {
    if (index == kMaxLidars) return;
    LidarState& lidar = lidarAt(index++);
    lidar.range_bias.resume(of_lidar.range_bias);
    lidar.direction.resume(of_lidar.scan_reversed);
  }
}

void Localizer::count(ScanOutcome outcome) {
  switch (outcome) {
    case ScanOutcome::kUsed:
      ++counters_.scans_used;
      break;
    case ScanOutcome::kWeightsVanished:
      ++counters_.weights_vanished;
      break;
    case ScanOutcome::kStationary:
      ++counters_.scans_stationary;
      break;
    default:
      ++counters_.scans_dropped;
  }
}

}  // namespace racecar_mcl
