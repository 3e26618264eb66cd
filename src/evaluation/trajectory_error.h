// Errors of an estimated trajectory with respect to the ground truth.
#pragma once

#include <vector>

#include "evaluation/trajectory.h"

namespace racecar_mcl {

/// The quantile at `fraction` in [0, 1], linearly interpolated (numpy's default). NaN without
/// values.
double quantile(std::vector<double> values, double fraction);
double mean(const std::vector<double>& values);

struct TrajectoryErrors {
  std::vector<double> position;  ///< m, one per truth stamp used, in order
  std::vector<double> heading;   ///< rad, absolute, one per truth stamp used
  int stamps_used = 0;
  int stamps_skipped = 0;  ///< within the run but in a gap of the estimate
};

/// Errors at every truth stamp between the first and the last estimate, without alignment. The
/// estimate is interpolated; stamps in gaps longer than `max_gap` seconds are skipped.
TrajectoryErrors compareTrajectories(const Trajectory& estimate, const Trajectory& truth,
                                     double max_gap);

struct PositionErrorSummary {
  double mean = 0.0, median = 0.0, p95 = 0.0, max = 0.0, rmse = 0.0, final = 0.0;  ///< m
};
struct HeadingErrorSummary {
  double mean = 0.0, p95 = 0.0, max = 0.0;  ///< degrees
};

/// Require at least one error.
PositionErrorSummary summarizePosition(const TrajectoryErrors& errors);
HeadingErrorSummary summarizeHeading(const TrajectoryErrors& errors);

}  // namespace racecar_mcl
