#include "racecar_mcl/odometry_calibration.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "racecar_mcl/errors.h"

namespace racecar_mcl {
namespace {

// Farther off than this, odometry is broken rather than not calibrated.
constexpr double kMostScale = 0.15;     // per metre or radian
constexpr double kMostCurvature = 0.1;  // rad/m

// What one scan may teach, per metre or radian: a correction beyond is a slip or a bad match.
constexpr double kMostSurprise = 0.3;

double bounded(double value, double most) { return std::clamp(value, -most, most); }

}  // namespace

void validate(const OdometryCalibrationParameters& p) {
  if (!(p.calibration_distance == 0.0 ||
        (p.calibration_distance >= 1.0 && p.calibration_distance <= 1e6))) {
    std::ostringstream problem;
    problem << "calibration_distance is " << p.calibration_distance
            << " m; it must be 0 (off) or lie in [1, 1e6]";
    throw ParameterError(problem.str());
  }
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
}

}  // namespace racecar_mcl
