#include "racecar_mcl/monitoring/localization_monitor.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "racecar_mcl/common/validation.h"

namespace racecar_mcl {
namespace {

// The factors were chosen on simulated drives and recordings (bench/2026-11-28-wrong-maps.md).

// Baseline of the inlier ratio and of its mean absolute deviation: limits, initial value, and
// distance over which they are averaged.
constexpr double kMinBaseline = 0.7;
constexpr double kBaselineDistance = 10.0;  // m driven
constexpr double kInitialDeviation = 0.05;
constexpr double kMinDeviation = 0.02;
constexpr double kMaxDeviation = 0.05;  // larger ones are wrong poses rather than the map
// Baseline of the conflict.
constexpr double kInitialBaselineConflict = 0.05;
constexpr double kMaxBaselineConflict = 0.25;
// Scans that update the baselines: minimum inlier ratio, and maximum conflict before and after the
// first localized estimate. The inlier ratio is also the minimum of a localized estimate.
constexpr double kMinBaselineInlierRatio = 0.65;
constexpr double kMaxInitialUpdateConflict = 0.2;
constexpr double kMaxUpdateConflict = 0.3;
// Disagreement of odometry and scans: time constant of the sums, and distance added to the distance
// driven, which tolerates small corrections.
constexpr double kCorrectionTime = 2.0;     // s
constexpr double kToleratedDistance = 0.5;  // m
// Distance after a start over which corrections are those of the start pose.
constexpr double kSettlingDistance = 1.0;  // m
// Minimum inlier ratio of an informative map; distance driven on it over which `carried` decays.
constexpr double kMinInformativeInlierRatio = 0.75;
constexpr double kCarriedDecayDistance = 1.0;  // m
// Maximum inlier ratio of a lost estimate. In Wean Hall the right pose has 0.42 to 0.5 for seconds.
constexpr double kMaxLostInlierRatio = 0.4;
constexpr int kMinBeams = 8;           // with a return; fewer are no evidence
constexpr double kUnusableTime = 0.5;  // s without a usable scan until the state is degraded
// Elapsed time before the first scan: larger than every time constant.
constexpr double kInfiniteTime = 1e9;  // s

std::string percent(double share) { return std::to_string(std::lround(100.0 * share)) + " %"; }

std::string metres(double length) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.2f m", length);
  return text;
}

}  // namespace

std::string toString(LocalizationState state) {
  switch (state) {
    case LocalizationState::kInitializing:
      return "initializing";
    case LocalizationState::kLocalized:
      return "localized";
    case LocalizationState::kDegraded:
      return "degraded";
    case LocalizationState::kLost:
      return "lost";
  }
  return "unknown";
}

void validate(const LocalizationMonitorParameters& p) {
  requirePositiveUpTo("inlier_averaging_time", p.inlier_averaging_time, 100.0, "s");
  requirePositiveUpTo("degraded_deviations", p.degraded_deviations, 1000.0);
  requireShare("lost_conflict", p.lost_conflict);
  requirePositiveUpTo("localized_sigma", p.localized_sigma, 1000.0, "m");
  requirePositiveUpTo("odometry_disagreement", p.odometry_disagreement, 1000.0);
}

LocalizationMonitor::LocalizationMonitor(const LocalizationMonitorParameters& parameters,
                                         const ProtectionLevelParameters& protection)
    : parameters_((validate(parameters), parameters)),
      protection_((validate(protection), protection)),
      baseline_(kTypicalInlierRatio),
      baseline_conflict_(kInitialBaselineConflict),
      deviation_(kInitialDeviation) {}

void LocalizationMonitor::setParameters(const LocalizationMonitorParameters& parameters,
                                        const ProtectionLevelParameters& protection) {
  validate(parameters);
  validate(protection);
  parameters_ = parameters;
  protection_ = protection;
}

void LocalizationMonitor::reset() {
  status_ = LocalizationStatus{};
  has_scan_ = false;
  was_localized_ = false;
  conflict_ = 0.0;
  carried_ = 0.0;
  unusable_since_.reset();
  correction_.setZero();
  travelled_ = 0.0;
  since_start_ = 0.0;
}

void LocalizationMonitor::average(const MonitorInput& input) {
  const double elapsed = has_scan_ ? std::max(0.0, input.stamp - last_stamp_) : kInfiniteTime;
  const double keep = std::exp(-elapsed / parameters_.inlier_averaging_time);
  inlier_ratio_ = keep * inlier_ratio_ + (1.0 - keep) * input.match.inlier_ratio;
  conflict_ = keep * conflict_ + (1.0 - keep) * input.match.conflict();
  last_stamp_ = input.stamp;
  has_scan_ = true;

  const double keep_correction = std::exp(-elapsed / kCorrectionTime);
  if (!input.converged || input.jumped) since_start_ = 0.0;
  since_start_ += input.travelled;
  correction_ = keep_correction * correction_ + input.correction;
  if (since_start_ < kSettlingDistance) correction_.setZero();
  travelled_ = keep_correction * travelled_ + input.travelled;
}

void LocalizationMonitor::updateBaseline(double travelled) {
  const double gain = 1.0 - std::exp(-travelled / kBaselineDistance);
  deviation_ += gain * (std::abs(inlier_ratio_ - baseline_) - deviation_);
  deviation_ = std::clamp(deviation_, kMinDeviation, kMaxDeviation);
  baseline_ = std::max(kMinBaseline, baseline_ + gain * (inlier_ratio_ - baseline_));
  baseline_conflict_ =
      std::min(kMaxBaselineConflict, baseline_conflict_ + gain * (conflict_ - baseline_conflict_));
}

double LocalizationMonitor::minInlierRatio() const {
  const double limit = baseline_ - parameters_.degraded_deviations * deviation_;
  return std::max(limit, kMinBaselineInlierRatio);
}

bool LocalizationMonitor::mapIsInformative() const {
  return !has_scan_ || inlier_ratio_ >= kMinInformativeInlierRatio;
}

LocalizationStatus LocalizationMonitor::conclude(const MonitorInput& input) const {
  const double disagreement = correction_.norm() / (travelled_ + kToleratedDistance);
  const auto status = [&](LocalizationState state, std::string reason) {
    LocalizationStatus made;
    made.state = state;
    made.reason = std::move(reason);
    made.inlier_ratio = inlier_ratio_;
    made.baseline_inlier_ratio = baseline_;
    made.conflict = excessConflict();
    made.carried = carried_;
    made.disagreement = disagreement;
    made.localizability = input.localizability;
    return made;
  };
  const std::string fit = percent(inlier_ratio_) + " inliers; baseline " + percent(baseline_);
  if (!input.converged) {
    return was_localized_
               ? status(LocalizationState::kLost, "searching: particles are in several clusters")
               : status(LocalizationState::kInitializing, "particles are in several clusters");
  }
  if (input.match.beams < kMinBeams) {
    return status(LocalizationState::kDegraded, "too few beams return");
  }
  if (excessConflict() > parameters_.lost_conflict && inlier_ratio_ < kMaxLostInlierRatio) {
    return status(LocalizationState::kLost,
                  "the scans contradict the map: " + percent(conflict_) + " of the beams");
  }
  const bool is_inlier = inlier_ratio_ >= minInlierRatio();
  const bool is_narrow = positionSigma(input.estimate) <= parameters_.localized_sigma;
  if (!was_localized_ && !(is_inlier && is_narrow)) {
    return status(LocalizationState::kInitializing, fit);
  }
  if (!is_inlier) {
    return status(LocalizationState::kDegraded,
                  "the map does not show what the lidar sees: " + fit + "; position sigma " +
                      metres(positionSigma(input.estimate)));
  }
  if (!is_narrow) return status(LocalizationState::kDegraded, "the position is uncertain");
  if (disagreement > parameters_.odometry_disagreement) {
    return status(
        LocalizationState::kDegraded,
        "odometry and scans disagree by " + percent(disagreement) + " of the distance driven");
  }
  if (input.unconfirmed) {
    return status(LocalizationState::kInitializing,
                  "a second search of the map has not agreed yet");
  }
  return status(LocalizationState::kLocalized, fit);
}

const LocalizationStatus& LocalizationMonitor::update(const MonitorInput& input) {
  average(input);
  unusable_since_.reset();
  // Not reset by a single scan: scans at a wrong pose can match the map as well.
  carried_ = mapIsInformative() ? carried_ * std::exp(-input.travelled / kCarriedDecayDistance)
                                : carried_ + input.travelled;
  status_ = conclude(input);
  if (status_.state == LocalizationState::kLocalized ||
      status_.state == LocalizationState::kDegraded) {
    status_.level = protectionLevel(protection_, input.estimate, input.match, carried_);
  }
  if (status_.state == LocalizationState::kLocalized) was_localized_ = true;
  if (input.converged && !input.unconfirmed && inlier_ratio_ >= kMinBaselineInlierRatio &&
      conflict_ <= (was_localized_ ? kMaxUpdateConflict : kMaxInitialUpdateConflict) &&
      positionSigma(input.estimate) <= parameters_.localized_sigma) {
    updateBaseline(input.travelled);
  }
  return status_;
}

const LocalizationStatus& LocalizationMonitor::recordUnusableScan(double stamp) {
  // A start in the future is from before the clock was set back.
  if (!unusable_since_ || *unusable_since_ > stamp) unusable_since_ = stamp;
  if (stamp - *unusable_since_ > kUnusableTime && status_.state == LocalizationState::kLocalized) {
    status_.state = LocalizationState::kDegraded;
    status_.reason = "no usable scan";
  }
  return status_;
}

}  // namespace racecar_mcl
