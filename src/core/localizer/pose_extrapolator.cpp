#include "racecar_mcl/localizer/pose_extrapolator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace racecar_mcl {
namespace {

// Odometry that has been missing for longer is assumed to have stopped: a scan does not wait for
// it.
constexpr double kOdometryTimeout = 0.5;  // s

// A scan may be an outlier if it is further ahead of odometry, in periods.
constexpr double kMaxOdometryPeriodsAhead = 1.0;

using Lock = std::lock_guard<std::mutex>;

}  // namespace

PoseExtrapolator::PoseExtrapolator(const OdometryParameters& odometry,
                                   const MotionModelParameters& motion)
    : parameters_(odometry),
      motion_parameters_(motion),
      odometry_(odometry),
      scan_clocks_(odometry.clock_jump) {}

void PoseExtrapolator::setParameters(const OdometryParameters& odometry,
                                     const MotionModelParameters& motion) {
  const Lock lock(*mutex_);
  odometry_.setParameters(odometry);
  parameters_ = odometry;
  motion_parameters_ = motion;
}

OdometryOutcome PoseExtrapolator::addOdometry(const OdometrySample& sample) {
  const Lock lock(*mutex_);
  ++counters_.odometry_seen;
  const OdometryOutcome outcome = odometry_.add(sample);
  switch (outcome) {
    case OdometryOutcome::kNotFinite:
    case OdometryOutcome::kImplausible:
    case OdometryOutcome::kRepeatedStamp:
    case OdometryOutcome::kOutOfOrder:
    case OdometryOutcome::kStampOutlier:
      ++counters_.odometry_dropped;
      return outcome;
    case OdometryOutcome::kTimeJumpedBack:
      ++counters_.time_jumps;
      scan_clocks_.reset();
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

GyroOutcome PoseExtrapolator::addGyro(const GyroSample& sample) {
  const Lock lock(*mutex_);
  ++counters_.gyro_seen;
  const GyroOutcome outcome = odometry_.add(sample);
  const bool used = outcome == GyroOutcome::kUsed || outcome == GyroOutcome::kGap ||
                    outcome == GyroOutcome::kTimeJumpedBack;
  ++(used ? counters_.gyro_used : counters_.gyro_dropped);
  return outcome;
}

bool PoseExtrapolator::covers(double stamp) const {
  const Lock lock(*mutex_);
  if (odometry_.odometry().empty()) return scan_clocks_.newest().has_value();
  const double newest = odometry_.odometry().newestStamp();
  return newest >= stamp + std::min(0.0, odometry_.calibration().delay()) ||
         newest < stamp - kOdometryTimeout;
}

Motion PoseExtrapolator::odometryMotionTo(double stamp) const {
  Motion motion = odometry_.motion(reference_->origin, stamp);
  motion.noise_scale = noise_scale_;
  return motion;
}

std::optional<PoseEstimate> PoseExtrapolator::estimateAt(double stamp) const {
  const Lock lock(*mutex_);
  if (!reference_) return std::nullopt;
  Motion motion = odometryMotionTo(stamp);
  if (slip_compensation_.twist()) {
    motion = slip_compensation_.correct(motion, motion_parameters_);
  }
  return propagate(reference_->estimate, motion.delta,
                   motionCovariance(motion_parameters_, motion));
}

std::optional<double> PoseExtrapolator::newest() const {
  const OdometryBuffer& odometry = odometry_.odometry();
  const std::optional<double> scan = scan_clocks_.newest();
  if (odometry.empty()) return scan;
  return std::max(odometry.newestStamp(), scan.value_or(odometry.newestStamp()));
}

std::optional<double> PoseExtrapolator::newestStamp() const {
  const Lock lock(*mutex_);
  return newest();
}

double PoseExtrapolator::odometryLag(double stamp) const {
  const Lock lock(*mutex_);
  const OdometryBuffer& odometry = odometry_.odometry();
  return odometry.empty() ? 0.0 : stamp - odometry.newestStamp();
}

PoseEstimate PoseExtrapolator::moveToNewest(const PoseEstimate& estimate, double stamp) const {
  const Lock lock(*mutex_);
  const OdometryBuffer& odometry = odometry_.odometry();
  if (odometry.empty() || stamp < odometry.oldestStamp() || stamp >= *newest()) return estimate;
  const Motion motion = odometry_.motion(odometry_.at(stamp), *newest());
  return propagate(estimate, motion.delta, Eigen::Matrix3d::Zero());
}

Twist2 PoseExtrapolator::twist() const {
  const Lock lock(*mutex_);
  const Twist2 newest =
      odometry_.odometry().empty() ? Twist2{} : odometry_.odometry().newestTwist();
  return slip_compensation_.twist().value_or(newest);
}

OdometryCounters PoseExtrapolator::counters() const {
  const Lock lock(*mutex_);
  return counters_;
}

void PoseExtrapolator::reset(const PoseEstimate& estimate, const OdometryCalibration& calibration) {
  const Lock lock(*mutex_);
  odometry_.setCalibration(calibration);
  noise_scale_ = 1.0;
  slip_compensation_.reset();
  reference_ = Reference{estimate, odometry_.at(newest().value_or(0.0))};
}

bool PoseExtrapolator::initialized() const {
  const Lock lock(*mutex_);
  return reference_.has_value();
}

std::optional<PoseEstimate> PoseExtrapolator::lastEstimate() const {
  const Lock lock(*mutex_);
  if (!reference_) return std::nullopt;
  return reference_->estimate;
}

ScanOutcome PoseExtrapolator::checkStamp(double stamp, int lidar) {
  const Lock lock(*mutex_);
  const OdometryBuffer& odometry = odometry_.odometry();
  std::optional<double> max_stamp;
  if (!odometry.empty()) {
    max_stamp = odometry.newestStamp() + kMaxOdometryPeriodsAhead * knownPeriod(odometry.period());
  }
  const ScanOutcome outcome = scan_clocks_.check(stamp, lidar, max_stamp);
  if (outcome != ScanOutcome::kTimeJumpedBack) return outcome;
  ++counters_.time_jumps;
  // Odometry from before the jump belongs to the old time.
  if (!odometry.empty() && stamp <= odometry.newestStamp() - scan_clocks_.clockJump()) {
    odometry_.reset();
  }
  return outcome;
}

double PoseExtrapolator::evaluationStamp(double stamp) const {
  const Lock lock(*mutex_);
  return scan_clocks_.evaluationStamp(stamp);
}

CalibratedOdometry PoseExtrapolator::odometryOver(const Scan& scan) const {
  const Lock lock(*mutex_);
  CalibratedOdometry odometry = since(scan);
  odometry.replaceTwist(slip_compensation_.twist());
  return odometry;
}

CalibratedOdometry PoseExtrapolator::since(const Scan& scan) const {
  const auto sweep_time = static_cast<double>(scan.seconds_after_stamp.abs().maxCoeff());
  return odometry_.since(scan.stamp - sweep_time);
}

PoseExtrapolator::ScanMotion PoseExtrapolator::beginScan(const Scan& scan) {
  const Lock lock(*mutex_);
  if (!reference_) throw std::logic_error("there is no pose to extrapolate: initialize first");
  ScanMotion motion;
  motion.stamp = scan_clocks_.evaluationStamp(scan.stamp);
  scan_clocks_.recordUsed(scan.stamp, scan.lidar);
  motion.odometry = since(scan);
  motion.before = reference_->estimate;
  motion.odometry_motion = odometryMotionTo(motion.stamp);
  motion.motion = slip_compensation_.correct(motion.odometry_motion, motion_parameters_);
  motion.odometry.replaceTwist(motion.motion.compensation);
  motion.odometry_is_new =
      !odometry_.odometry().empty() &&
      motion.stamp - odometry_.odometry().newestStamp() <= parameters_.max_odometry_gap;
  return motion;
}

void PoseExtrapolator::setReference(const PoseEstimate& estimate, double stamp,
                                    const OdometryCalibration& calibration, double noise_scale,
                                    const SlipCompensation& slip_compensation) {
  const Lock lock(*mutex_);
  odometry_.setCalibration(calibration);
  noise_scale_ = noise_scale;
  slip_compensation_ = slip_compensation;
  reference_ = Reference{estimate, odometry_.at(stamp)};
}

}  // namespace racecar_mcl
