#include "racecar_mcl/odometry_calibration.h"

#include <algorithm>
#include <cmath>

#include "racecar_mcl/require.h"

namespace racecar_mcl {
namespace {

// Farther off than this, odometry is broken rather than not calibrated.
constexpr double kMostScale = 0.15;     // per metre or radian
constexpr double kMostCurvature = 0.1;  // rad/m

constexpr double kMostDelay = 0.1;  // s

// What one scan may teach, per metre or radian: a correction beyond is a slip or a bad match.
constexpr double kMostSurprise = 0.3;

// A radian that scans correct counts as much as this many metres.
constexpr double kMetresPerRadian = 0.5;
// (m/s)^2; no scan alone tells a delay, for all that it corrects is noise to a centimetre or so.
constexpr double kDelayPrior = 0.25;

double bounded(double value, double most) { return std::clamp(value, -most, most); }

}  // namespace

void validate(const OdometryCalibrationParameters& p) {
  require(p.calibration_distance == 0.0 ||
              (p.calibration_distance >= 1.0 && p.calibration_distance <= 1e6),
          "calibration_distance", p.calibration_distance, "0 (off) or between 1 and 1000000", "m");
}

OdometryCalibration::OdometryCalibration(const OdometryCalibrationParameters& parameters)
    : parameters_((validate(parameters), parameters)) {}

Motion OdometryCalibration::correct(const Motion& motion) const {
  Motion corrected = motion;
  const double yaw = turn_scale_ * motion.delta.yaw + curvature_ * motion.delta.x;
  // The path bends with the yaw: its chord turns by half of what the yaw is turned.
  const double half = 0.5 * (yaw - motion.delta.yaw);
  const double c = distance_scale_ * std::cos(half);
  const double s = distance_scale_ * std::sin(half);
  corrected.delta = {c * motion.delta.x - s * motion.delta.y,
                     s * motion.delta.x + c * motion.delta.y, wrapAngle(yaw)};
  corrected.distance = distance_scale_ * motion.distance;
  return corrected;
}

void OdometryCalibration::learn(const Motion& motion, const Pose2& correction) {
  if (parameters_.calibration_distance == 0.0) return;
  // Normalised least mean squares: the error that is left dies off by e over the distance.
  const double rate = 1.0 / parameters_.calibration_distance;
  const Pose2& moved = motion.delta;
  const double along =
      std::copysign(1.0, moved.x) * bounded(correction.x, kMostSurprise * std::abs(moved.x));
  distance_scale_ = 1.0 + bounded(distance_scale_ - 1.0 + rate * along, kMostScale);

  const double turn =
      bounded(correction.yaw, kMostSurprise * (std::abs(moved.x) + std::abs(moved.yaw)));
  const double power = std::abs(moved.x) + std::abs(moved.yaw);
  if (power == 0.0) return;
  turn_scale_ = 1.0 + bounded(turn_scale_ - 1.0 + rate * turn * moved.yaw / power, kMostScale);
  curvature_ = bounded(curvature_ + rate * turn * moved.x / power, kMostCurvature);
  learnDelay(motion, correction);
}

// Odometry that is late by d lacks d times what the twist has changed by. Least squares, which
// forget over the distance.
void OdometryCalibration::learnDelay(const Motion& motion, const Pose2& correction) {
  const double drive = motion.twist_change.vx;
  const double turn = kMetresPerRadian * motion.twist_change.wz;
  const double along = bounded(correction.x, kMostDelay * std::abs(drive));
  const double around = bounded(kMetresPerRadian * correction.yaw, kMostDelay * std::abs(turn));
  delay_information_ =
      std::exp(-motion.distance / parameters_.calibration_distance) * delay_information_ +
      drive * drive + turn * turn;
  delay_ = bounded(delay_ + (drive * along + turn * around) / (kDelayPrior + delay_information_),
                   kMostDelay);
}

}  // namespace racecar_mcl
