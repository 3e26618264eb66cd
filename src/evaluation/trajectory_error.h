// How far an estimated trajectory lies from the true one.
#pragma once

#include <vector>

#include "evaluation/trajectory.h"

namespace racecar_mcl {

/// The value under which a share of the values lies, interpolated linearly between the two nearest
/// ranks (as numpy's default); `share` in [0, 1]. NaN of no values.
double quantile(std::vector<double> values, double share);
double mean(const std::vector<double>& values);

struct TrajectoryErrors {
  std::vector<double> position;  ///< m, one per truth stamp used, in order
  std::vector<double> heading;   ///< rad, absolute, one per truth stamp used
  int stamps_used = 0;
  int stamps_skipped = 0;  ///< inside the run, but in a gap of the estimate
};

/// Errors at every truth stamp from the first to the last estimate, without any alignment. The
/// estimate is interpolated between its two neighbours, never across more than `max_gap` seconds:
/// such stamps are skipped.
TrajectoryErrors compareTrajectories(const Trajectory& estimate, const Trajectory& truth,
                                     double max_gap);

struct PositionErrorSummary {
  double mean = 0.0, median = 0.0, p95 = 0.0, max = 0.0, rmse = 0.0, final = 0.0;  ///< m
};
struct HeadingErrorSummary {
  double mean = 0.0, p95 = 0.0, max = 0.0;  ///< degrees
};

/// Of at least one error.
PositionErrorSummary summarizePosition(const TrajectoryErrors& errors);
HeadingErrorSummary summarizeHeading(const TrajectoryErrors& errors);

}  // namespace racecar_mcl
