#include "racecar_mcl/motion/distance_scale.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "motion/scalars.h"

namespace racecar_mcl {
namespace {

// Limit of the estimate (docs/decisions.md): larger errors are faults rather than miscalibration.
constexpr double kMaxScaleError = 0.35;

// The Kalman filter (bench/2026-12-01-first-metres.md): how long it is used, the standard deviation
// of the scale at its beginning, and how much a scan counts, since successive scans repeat the
// errors of the map.
constexpr double kFilteredDistance = 15.0;  // m
constexpr double kInitialSigma = 0.1;
constexpr double kWeightOfScan = 0.3;

// Distance that the prior of the mean, 1, counts for.
constexpr double kPriorDistance = 5.0;  // m

// Largest correction used of one scan, per metre: larger ones are slip or wrong matches.
constexpr double kMaxCorrectionRatio = 0.3;

}  // namespace

DistanceScale::DistanceScale(double adaptation_distance)
    : adaptation_distance_(adaptation_distance), variance_(square(kInitialSigma)) {}

double DistanceScale::varianceAlong(double length) const {
  if (!filters_) return 0.0;
  return std::max(0.0, 2.0 * length * covariance_.x() + square(length) * variance_);
}

void DistanceScale::learn(const Motion& motion, const PoseCorrection& correction,
                          const MapFit& fit) {
  if (adaptation_distance_ == 0.0) return;
  if (fit.map_is_complete) distance_ += motion.distance;
  if (filters_) {
    filter(motion, correction);
  } else {
    average(motion, correction.pose.x,
            fit.map_is_complete ? std::min(adaptation_distance_, kPriorDistance + distance_)
                                : adaptation_distance_);
  }
  filters_ = fit.map_is_complete && fit.scan_is_explained && distance_ < kFilteredDistance;
  if (!filters_) covariance_.setZero();
}

void DistanceScale::resume(double scale, double distance) {
  if (adaptation_distance_ == 0.0) return;
  scale_ = 1.0 + bounded(scale - 1.0, kMaxScaleError);
  distance_ = std::clamp(distance, 0.0, adaptation_distance_);
}

/// The scale as a state beside the position, whose update by the particles is given.
void DistanceScale::filter(const Motion& motion, const PoseCorrection& correction) {
  const double length = motion.delta.x;
  const Eigen::Rotation2Dd into_frame(-motion.delta.yaw);
  const Eigen::Vector2d predicted =
      into_frame * (covariance_ + Eigen::Vector2d(length * variance_, 0.0));
  const Eigen::Vector2d gain = correction.before.ldlt().solve(predicted);
  if (!gain.allFinite()) return;
  Eigen::Vector2d difference(correction.pose.x, correction.pose.y);
  const double limit = kMaxCorrectionRatio * std::abs(length);
  if (difference.norm() > limit) difference *= limit / difference.norm();
  change(kWeightOfScan * gain.dot(difference));
  covariance_ = correction.after * gain;
  const double reduction = gain.dot((correction.before - correction.after) * gain);
  variance_ -= kWeightOfScan * std::clamp(reduction, 0.0, variance_);
}

/// Normalised least mean squares.
void DistanceScale::average(const Motion& motion, double along, double distance) {
  const double length = motion.delta.x;
  change(std::copysign(1.0, length) * bounded(along, kMaxCorrectionRatio * std::abs(length)) /
         distance);
}

void DistanceScale::change(double difference) {
  scale_ = 1.0 + bounded(scale_ - 1.0 + difference, kMaxScaleError);
}

}  // namespace racecar_mcl
