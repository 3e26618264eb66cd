#include "evaluation/drive_watch.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace racecar_mcl {
namespace {

constexpr double kMapped = 0.6;  // share of explained beams

}  // namespace

void LongestSpell::see(double seconds, bool holds) {
  if (!holds) since_.reset();
  if (holds && !since_) since_ = last_seconds_;
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

double PositionErrors::quantile(double share) const {
  if (errors_.empty()) return 0.0;
  std::vector<double> sorted = errors_;
  std::sort(sorted.begin(), sorted.end());
  const double rank = std::ceil(share * static_cast<double>(sorted.size()) - 1e-9);
  return sorted[std::min(static_cast<std::size_t>(std::max(rank, 1.0)), sorted.size()) - 1];
}

double PositionErrors::shareAbove(double bound) const {
  if (errors_.empty()) return 0.0;
  const auto above = std::count_if(errors_.begin(), errors_.end(),
                                   [bound](double error) { return error > bound; });
  return static_cast<double>(above) / static_cast<double>(errors_.size());
}

void DriveWatch::see(double seconds, const Observation& seen) {
  const VerdictState state = seen.result.verdict.state;
  const bool right = seen.error <= kWrong;
  const bool trusted = state == VerdictState::kLocalized;
  const bool alarmed = state == VerdictState::kDegraded || state == VerdictState::kLost;
  ++scans;
  right_scans += right ? 1 : 0;
  false_alarms += right && alarmed ? 1 : 0;
  wrongly_trusted.see(seconds, !right && trusted);
  if (seconds < 0.0) return;
  if (!trusted && !noticed) noticed = seconds;
  if (!right) arrived.reset();
  if (seen.error <= kRight && !arrived) arrived = seconds;

  errors.add(seen.error);
  if (seen.explained_from_truth >= kMapped) errors_where_mapped.add(seen.error);
  lost_while_right.see(seconds, right && state == VerdictState::kLost);
}

}  // namespace racecar_mcl
