#include "evaluation/trajectory_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace racecar_mcl {

double quantile(std::vector<double> values, double fraction) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double rank = fraction * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (rank - static_cast<double>(below)) * (values[above] - values[below]);
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

TrajectoryErrors compareTrajectories(const Trajectory& estimate, const Trajectory& truth,
                                     double max_gap) {
  TrajectoryErrors errors;
  if (estimate.empty()) return errors;
  for (const StampedPose& row : truth) {
    if (row.stamp < estimate.front().stamp || row.stamp > estimate.back().stamp) continue;
    const std::optional<Pose2> pose = poseAt(estimate, row.stamp, max_gap);
    if (!pose) {
      ++errors.stamps_skipped;
      continue;
    }
    errors.position.push_back(distance(*pose, row.pose));
    errors.heading.push_back(std::abs(wrapAngle(pose->yaw - row.pose.yaw)));
    ++errors.stamps_used;
  }
  return errors;
}

PositionErrorSummary summarizePosition(const TrajectoryErrors& errors) {
  const std::vector<double>& e = errors.position;
  const double sum_of_squares = std::inner_product(e.begin(), e.end(), e.begin(), 0.0);
  PositionErrorSummary summary;
  summary.mean = mean(e);
  summary.median = quantile(e, 0.5);
  summary.p95 = quantile(e, 0.95);
  summary.max = quantile(e, 1.0);
  summary.rmse = std::sqrt(sum_of_squares / static_cast<double>(e.size()));
  summary.final = e.back();
  return summary;
}

HeadingErrorSummary summarizeHeading(const TrajectoryErrors& errors) {
  std::vector<double> degrees = errors.heading;
  for (double& error : degrees) error *= 180.0 / kPi;
  return {mean(degrees), quantile(degrees, 0.95), quantile(degrees, 1.0)};
}

}  // namespace racecar_mcl
