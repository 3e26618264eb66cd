// Report of a replay: trajectory.tum, updates.csv and summary.json.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/trajectory_error.h"
#include "offline/offline_driver.h"
#include "racecar_mcl/localizer/localizer.h"

namespace racecar_mcl {

/// Parameters and counters for the summary.
struct ReplayMetadata {
  LocalizerParameters parameters;
  std::uint64_t seed = 0;
  std::string version;
  LocalizerCounters counters;
  SensorCalibration sensors;  ///< as estimated by the end
  std::string gyro;           ///< its use at the end
};

/// The summary as JSON; includes errors if there is a ground truth.
std::string summaryJson(const ReplayRecord& record, const ReplayMetadata& description,
                        const std::optional<TrajectoryErrors>& errors);

/// The summary as text, three lines; two without errors.
std::string summaryText(const ReplayRecord& record, const ReplayMetadata& description,
                        const std::optional<TrajectoryErrors>& errors);

/// One row per scan: stamp, estimate, covariance, and statistics of the update.
std::string updatesCsv(const ReplayRecord& record);

/// The names of the three files.
std::vector<std::string> reportFiles();

/// Writes the three files with writeFolder.
void writeReport(const std::string& directory, const ReplayRecord& record,
                 const std::string& summary_json);

}  // namespace racecar_mcl
