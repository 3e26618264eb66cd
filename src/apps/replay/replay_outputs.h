// What a replay leaves behind: trajectory.tum, updates.csv and summary.json.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "evaluation/trajectory_error.h"
#include "racecar_mcl/localizer.h"
#include "replay_run.h"

namespace racecar_mcl {

/// What the summary says beside the run itself.
struct RunDescription {
  LocalizerParameters parameters;
  std::uint64_t seed = 0;
  std::string version;
  LocalizerCounters counters;
  std::string sweep_order;  ///< "listed" or "reversed", as known at the end
};

/// The summary as JSON text; errors are in it where there was a truth.
std::string summaryJson(const ReplayRecord& record, const RunDescription& description,
                        const std::optional<TrajectoryErrors>& errors);

/// The summary in two lines for people.
std::string summaryText(const ReplayRecord& record, const RunDescription& description,
                        const std::optional<TrajectoryErrors>& errors);

/// A row a scan: stamp, estimate, covariance, and how the update went.
std::string updatesCsv(const ReplayRecord& record);

/// Writes the three files as writeFolder does.
void writeOutputs(const std::string& directory, const ReplayRecord& record,
                  const std::string& summary_json);

}  // namespace racecar_mcl
