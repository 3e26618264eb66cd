#include "offline/replay_report.h"

#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "offline/output_files.h"
#include "racecar_mcl/localizer/parameter_registry.h"

namespace racecar_mcl {
namespace {

std::vector<double> updateTimes(const ReplayRecord& record) {
  std::vector<double> times;
  for (const ScanRow& row : record.scans) times.push_back(row.update_ms);
  return times;
}

double realTimeFactor(const ReplayRecord& record) {
  return record.duration / std::max(record.wall_seconds, 1e-9);
}

std::string outcomeName(ScanOutcome outcome) {
  switch (outcome) {
    case ScanOutcome::kStationary:
      return "stationary";
    case ScanOutcome::kWeightsVanished:
      return "weights_vanished";
    default:
      return "used";
  }
}

/// Percent of the scans with an estimate, by state; states without a scan are left out.
std::map<std::string, double> statusPercent(const ReplayRecord& record) {
  std::map<std::string, double> percent;
  for (const ScanRow& row : record.scans) {
    percent[toString(row.result.status.state)] += 100.0 / static_cast<double>(record.scans.size());
  }
  return percent;
}

std::string tum(const Trajectory& trajectory) {
  std::ostringstream text;
  writeTum(trajectory, text);
  return text.str();
}

}  // namespace

std::string summaryJson(const ReplayRecord& record, const ReplayMetadata& description,
                        const std::optional<TrajectoryErrors>& errors) {
  nlohmann::json json;
  if (errors) {
    const PositionErrorSummary position = summarizePosition(*errors);
    const HeadingErrorSummary heading = summarizeHeading(*errors);
    json["position_error_m"] = {{"mean", position.mean}, {"median", position.median},
                                {"p95", position.p95},   {"max", position.max},
                                {"rmse", position.rmse}, {"final", position.final}};
    json["heading_error_deg"] = {
        {"mean", heading.mean}, {"p95", heading.p95}, {"max", heading.max}};
    json["truth_stamps_used"] = errors->stamps_used;
    json["truth_stamps_skipped"] = errors->stamps_skipped;
  }
  const std::vector<double> times = updateTimes(record);
  json["scans_seen"] = record.scans_seen;
  json["scans_used"] = description.counters.scans_used;
  json["odometry_seen"] = description.counters.odometry_seen;
  json["duration_s"] = record.duration;
  json["real_time_factor"] = realTimeFactor(record);
  json["update_ms"] = {
      {"mean", mean(times)}, {"p50", quantile(times, 0.5)}, {"p99", quantile(times, 0.99)}};
  json["status_percent"] = statusPercent(record);
  json["num_particles"] = description.parameters.filter.num_particles;
  json["num_beams"] = description.parameters.scan.num_beams_per_particle;
  json["sensor_model"] = parameterTexts(description.parameters).at("sensor_model");
  if (description.parameters.sensor.sensor_model == SensorModelType::kBeam) {
    json["range_method"] = description.parameters.sensor.caster.range_method;
  }
  json["scan_direction"] = scanDirectionName(description.sensors.lidars.front().scan_reversed);
  for (std::size_t i = 0; i < record.lidars.size(); ++i) {
    const RegisteredLidar& lidar = record.lidars[i];
    const LidarCalibration calibration =
        i < description.sensors.lidars.size() ? description.sensors.lidars[i] : LidarCalibration{};
    json["lidars"].push_back({{"frame", lidar.frame},
                              {"topic", lidar.topic},
                              {"scans_used", lidar.scans_used},
                              {"range_bias_m", calibration.range_bias},
                              {"scan_direction", scanDirectionName(calibration.scan_reversed)}});
  }
  json["gyro"] = description.gyro;
  json["seed"] = description.seed;
  json["version"] = description.version;
  return json.dump(2) + "\n";
}

std::string summaryText(const ReplayRecord& record, const ReplayMetadata& description,
                        const std::optional<TrajectoryErrors>& errors) {
  char line[320];
  const std::vector<double> times = updateTimes(record);
  std::snprintf(line, sizeof(line),
                "%llu of %zu scans used over %.1f s, %.0f times real time, %.2f ms per update (p99 "
                "%.2f)",
                static_cast<unsigned long long>(description.counters.scans_used), record.scans_seen,
                record.duration, realTimeFactor(record), mean(times), quantile(times, 0.99));
  std::string text = line;
  text += "\nstatus:";
  for (const auto& [state, percent] : statusPercent(record)) {
    std::snprintf(line, sizeof(line), " %s %.0f %%,", state.c_str(), percent);
    text += line;
  }
  text.back() = '.';
  if (errors) {
    const PositionErrorSummary position = summarizePosition(*errors);
    const HeadingErrorSummary heading = summarizeHeading(*errors);
    std::snprintf(line, sizeof(line),
                  "\nposition error: rmse %.3f m, mean %.3f, p95 %.3f, max %.3f, final %.3f; "
                  "heading error: mean %.2f deg, max %.2f (%d truth stamps, %d skipped)",
                  position.rmse, position.mean, position.p95, position.max, position.final,
                  heading.mean, heading.max, errors->stamps_used, errors->stamps_skipped);
    text += line;
  }
  return text;
}

std::string updatesCsv(const ReplayRecord& record) {
  std::string text =
      "stamp,x,y,yaw,cov_xx,cov_xy,cov_xyaw,cov_yy,cov_yyaw,cov_yawyaw,effective_sample_size,"
      "beams,particles,log_likelihood,resampled,outcome,update_ms,clusters,inlier_ratio,obstructed,"
      "contradicted,unmapped,conflict,carried,range_bias,distance_scale,turn_scale,turned_by_gyro,"
      "level_along,level_across,level_heading,"
      "localizability_along,localizability_across,localizability_heading,lidar,status,reason\n";
  for (const ScanRow& row : record.scans) {
    const UpdateResult& update = row.result.update;
    const Pose2& pose = update.estimate.base_in_map;
    const Eigen::Matrix3d& cov = update.estimate.covariance;
    const LocalizationStatus& status = row.result.status;
    const ScanMatch& fit = row.result.match;
    const ProtectionLevel& level = status.level;
    char line[1024];
    std::snprintf(line, sizeof(line),
                  "%s,%.9f,%.9f,%.12f,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.3f,%d,%d,%.9g,%d,"
                  "%s,%.4f,%zu,%.3f,%.3f,%.3f,%.3f,%.3f,%.2f,%.4f,%.4f,%.4f,%d,%.4f,%.4f,%.5f,%.4f,"
                  "%.4f,%.5f,%d,%s,%s\n",
                  formatStamp(row.stamp).c_str(), pose.x, pose.y, pose.yaw, cov(0, 0), cov(0, 1),
                  cov(0, 2), cov(1, 1), cov(1, 2), cov(2, 2), update.effective_sample_size,
                  update.beams, update.particles, update.log_likelihood, update.resampled ? 1 : 0,
                  outcomeName(row.result.outcome).c_str(), row.update_ms, update.clusters.size(),
                  status.inlier_ratio, fit.obstructed, fit.contradicted, fit.unmapped,
                  status.conflict, status.carried, row.result.range_bias, row.result.distance_scale,
                  row.result.turn_scale, row.result.turned_by_gyro ? 1 : 0, level.along,
                  level.across, level.heading, status.localizability.along,
                  status.localizability.across, status.localizability.heading, row.lidar,
                  toString(status.state).c_str(), status.reason.c_str());
    text += line;
  }
  return text;
}

std::vector<std::string> reportFiles() { return {"trajectory.tum", "updates.csv", "summary.json"}; }

void writeReport(const std::string& directory, const ReplayRecord& record,
                 const std::string& summary_json) {
  const std::vector<std::string> names = reportFiles();
  writeFolder(directory, {{names[0], tum(record.trajectory)},
                          {names[1], updatesCsv(record)},
                          {names[2], summary_json}});
}

}  // namespace racecar_mcl
