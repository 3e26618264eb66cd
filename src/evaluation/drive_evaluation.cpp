#include "evaluation/drive_evaluation.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace racecar_mcl {
namespace {

constexpr double kMappedInlierRatio = 0.6;  // see errors_where_mapped

}  // namespace

void LongestInterval::update(double seconds, bool active) {
  if (!active) since_.reset();
  if (active && !since_) since_ = last_seconds_;
  if (since_) longest_ = std::max(longest_, seconds - *since_);
  last_seconds_ = seconds;
}

void PositionErrors::add(const PositionErrors& others) {
  errors_.insert(errors_.end(), others.errors_.begin(), others.errors_.end());
}

double PositionErrors::mean() const {
  if (errors_.empty()) return 0.0;
  return std::accumulate(errors_.begin(), errors_.end(), 0.0) / static_cast<double>(errors_.size());
}

double PositionErrors::max() const { return quantile(1.0); }

double PositionErrors::quantile(double fraction) const {
  if (errors_.empty()) return 0.0;
  std::vector<double> sorted = errors_;
  std::sort(sorted.begin(), sorted.end());
  const double rank = std::ceil(fraction * static_cast<double>(sorted.size()) - 1e-9);
  return sorted[std::min(static_cast<std::size_t>(std::max(rank, 1.0)), sorted.size()) - 1];
}

double PositionErrors::fractionAbove(double bound) const {
  if (errors_.empty()) return 0.0;
  const auto above = std::count_if(errors_.begin(), errors_.end(),
                                   [bound](double error) { return error > bound; });
  return static_cast<double>(above) / static_cast<double>(errors_.size());
}

void DriveEvaluation::update(double seconds, const Observation& observation) {
  const LocalizationState state = observation.result.status.state;
  const bool is_correct = observation.error <= kMaxCorrectError;
  const bool is_localized = state == LocalizationState::kLocalized;
  const bool is_alarm = state == LocalizationState::kDegraded || state == LocalizationState::kLost;
  ++scans;
  correct_scans += is_correct ? 1 : 0;
  false_alarms += is_correct && is_alarm ? 1 : 0;
  misleading.update(seconds, !is_correct && is_localized);
  if (seconds < 0.0) return;
  if (!is_localized && !detected) detected = seconds;
  if (!is_correct) arrived.reset();
  if (observation.error <= kArrivalError && !arrived) arrived = seconds;

  errors.add(observation.error);
  if (observation.inlier_ratio_from_truth >= kMappedInlierRatio) {
    errors_where_mapped.add(observation.error);
  }
  lost_while_correct.update(seconds, is_correct && state == LocalizationState::kLost);
}

}  // namespace racecar_mcl
