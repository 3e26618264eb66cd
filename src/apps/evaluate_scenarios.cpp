// Failure scenarios on simulated drives, with faults and wrong maps: time to localize, accuracy and
// self-diagnosis. The reports in bench/ use it.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli.h"
#include "evaluation/drive_evaluation.h"
#include "file_options.h"
#include "offline/fault_injection.h"
#include "offline/output_files.h"
#include "offline/simulated_drive.h"
#include "parameter_options.h"
#include "racecar_mcl/map/map_writer.h"
#include "sim/map_faults.h"

namespace racecar_mcl {
namespace {

constexpr std::uint64_t kMapFaultSeed = 0x6d6170ULL;  // decorrelates map faults

struct Options {
  std::vector<std::string> maps;
  std::vector<std::string> faults{"start"};
  std::vector<std::string> map_faults{"none"};
  ParameterOptions parameters;
  int drives = 100;
  int seed = 1;
  double speed = 3.0;   // m/s
  double before = 4.0;  // s driven before the fault
  double after = 8.0;   // s driven after it
  std::string out;
  std::string maps_out;
  bool verbose = false;
};

void addOptions(Options* o, CLI::App* app) {
  app->add_option("--map", o->maps, "map YAML files; drives are simulated on each")->required();
  std::vector<std::string> names;
  names.reserve(faultNames().size());
  for (const auto& fault : faultNames()) names.push_back(fault.first);
  app->add_option("--fault", o->faults, "faults to inject, each in drives of its own")
      ->check(CLI::IsMember(names))
      ->capture_default_str();
  names.clear();
  for (const auto& map_fault : sim::mapFaults()) names.push_back(map_fault.first);
  app->add_option("--map-fault", o->map_faults,
                  "faults of the localizer's map; combined with each --fault")
      ->check(CLI::IsMember(names))
      ->capture_default_str();
  app->add_option("--drives", o->drives, "drives per map, map fault and fault")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--seed", o->seed, "seed of the first drive; the next drives count up")
      ->capture_default_str();
  app->add_option("--speed", o->speed, "m/s")->capture_default_str();
  app->add_option("--before", o->before, "s driven before the fault")->capture_default_str();
  app->add_option("--after", o->after, "s driven after it")->capture_default_str();
  addParameterOptions(&o->parameters, app);
  app->add_option("--out", o->out, "CSV file with one row per drive");
  app->add_option("--write-map", o->maps_out,
                  "folder to write the localizer's maps to, as YAML and PGM");
  app->add_flag("--verbose", o->verbose, "print one line per scan");
}

/// The map and map fault shared by a group of drives.
struct Setting {
  std::string map_path;
  std::string map_fault;
  Course course;
};

/// "maps/track.yaml" and "grey" to "track_grey".
std::string wrongMapName(const Setting& setting, std::uint64_t seed) {
  return std::filesystem::path(setting.map_path).stem().string() + '_' + setting.map_fault + '_' +
         std::to_string(seed);
}

DriveEvaluation evaluateDrive(Fault fault, const Setting& setting,
                              const LocalizerParameters& parameters, const Options& options,
                              std::uint64_t seed) {
  Random random(seed);
  Course course = setting.course;
  const Pose2 pose = sim::randomFreePose(*course.world, {}, random, kStartClearance);
  Random map_random(seed ^ kMapFaultSeed);
  const sim::WrongMap wrong = sim::makeWrongMap(sim::mapFaults().at(setting.map_fault),
                                                course.map->grid, *course.world, pose, map_random);
  if (setting.map_fault != "none") course.map = makeLocalizationMap(wrong.map, parameters);
  if (!options.maps_out.empty()) {
    const std::string name = wrongMapName(setting, seed);
    writeFolder(options.maps_out,
                {{name + ".yaml", toMapYaml(wrong.map.geometry(), name + ".pgm", MapMode::kRaw)},
                 {name + ".pgm", toPgm(wrong.map, MapMode::kRaw)}});
  }
  SimulatedDrive drive(course, parameters, {}, pose, options.speed, seed);
  placeObstacles(fault, course, wrong.boxes, seed, random, &drive);
  double start = drive.simulator().time();
  DriveEvaluation evaluation;
  const auto observe = [&](const Observation& observation) {
    evaluation.update(observation.result.stamp - start, observation);
    if (!options.verbose) return;
    std::printf("  %7.3f s, %6.3f m: %s, %s\n", observation.result.stamp - start, observation.error,
                toString(observation.result.status.state).c_str(),
                observation.result.status.reason.c_str());
  };
  if (fault == Fault::kGlobalStart) {
    drive.localizer().initializeGlobally();
  } else {
    drive.localizer().initialize(startAt(pose));
    start += options.before;
    drive.drive(options.before, observe);
    inject(fault, course, wrong.boxes, random, &drive);
  }
  drive.drive(options.after, observe);
  return evaluation;
}

void report(const std::string& what, const std::vector<DriveEvaluation>& evaluations) {
  const auto drives = static_cast<long>(evaluations.size());
  long arrived = 0, detected = 0, misleading = 0, false_alarms = 0, correct_scans = 0;
  std::vector<double> times;
  for (const DriveEvaluation& evaluation : evaluations) {
    times.push_back(evaluation.arrived.value_or(1e9));
    arrived += times.back() <= 5.0 ? 1 : 0;
    detected += evaluation.detected.value_or(1e9) <= 1.0 ? 1 : 0;
    misleading += evaluation.misleading.longest() > 1.0 ? 1 : 0;
    false_alarms += evaluation.false_alarms;
    correct_scans += evaluation.correct_scans;
  }
  std::sort(times.begin(), times.end());
  char median[32] = "none";
  if (times[times.size() / 2] < 1e9) {
    std::snprintf(median, sizeof(median), "%.2f s", times[times.size() / 2]);
  }
  std::printf(
      "%s: %ld drives: %ld localized within 5 s (median %s), %ld detected within 1 s, %ld "
      "misleading for over 1 s; false alarms %.2f %% of the time\n",
      what.c_str(), drives, arrived, median, detected, misleading,
      100.0 * static_cast<double>(false_alarms) / static_cast<double>(std::max(1L, correct_scans)));
}

/// Error statistics over all drives, after fault injection.
void reportErrors(const std::vector<DriveEvaluation>& evaluations) {
  PositionErrors errors, errors_where_mapped;
  double longest_lost = 0.0;
  long gross = 0;
  for (const DriveEvaluation& evaluation : evaluations) {
    errors.add(evaluation.errors);
    errors_where_mapped.add(evaluation.errors_where_mapped);
    longest_lost = std::max(longest_lost, evaluation.lost_while_correct.longest());
    gross += evaluation.errors.max() > DriveEvaluation::kGrossError ? 1 : 0;
  }
  const double mapped = static_cast<double>(errors_where_mapped.count()) /
                        static_cast<double>(std::max<std::size_t>(1, errors.count()));
  std::printf(
      "  error: mean %.3f m, 99 %% %.3f m, max %.3f m; mean %.3f m where mapped (%.1f %% of the "
      "time); over 0.5 m %.2f %% of the time; over 2 m in %ld drives; lost while correct for up to "
      "%.2f s\n",
      errors.mean(), errors.quantile(0.99), errors.max(), errors_where_mapped.mean(),
      100.0 * mapped, 100.0 * errors.fractionAbove(DriveEvaluation::kMaxCorrectError), gross,
      longest_lost);
}

constexpr const char* kTableHeader =
    "map,fault,seed,localized,noticed,longest_wrong_trust,map_fault,mean_error,p99_error,"
    "max_error,mean_error_where_mapped,wrong_share,longest_lost_while_right,ever_far_off\n";

/// One drive: times in s since the fault, empty if it never happened; errors in m.
std::string tableRow(const Setting& setting, const std::string& fault, int seed,
                     const DriveEvaluation& evaluation) {
  std::string row = setting.map_path + ',' + fault + ',' + std::to_string(seed);
  const auto add = [&](const std::optional<double>& value) {
    char text[32] = "";
    if (value) std::snprintf(text, sizeof(text), "%.3f", *value);
    row += std::string(",") + text;
  };
  const PositionErrors& errors = evaluation.errors;
  const PositionErrors& mapped = evaluation.errors_where_mapped;
  add(evaluation.arrived);
  add(evaluation.detected);
  add(evaluation.misleading.longest());
  row += ',' + setting.map_fault;
  add(errors.mean());
  add(errors.quantile(0.99));
  add(errors.max());
  add(mapped.count() > 0 ? std::optional<double>(mapped.mean()) : std::nullopt);
  add(errors.fractionAbove(DriveEvaluation::kMaxCorrectError));
  add(evaluation.lost_while_correct.longest());
  return row + ',' + (errors.max() > DriveEvaluation::kGrossError ? '1' : '0') + '\n';
}

std::string nameOf(const Setting& setting, const std::string& fault) {
  const std::string wrong_map = setting.map_fault == "none" ? "" : ", map " + setting.map_fault;
  return setting.map_path + wrong_map + ", " + fault;
}

/// Prints a line for each failed drive.
void reportDrive(const Setting& setting, const std::string& fault, int seed,
                 const DriveEvaluation& evaluation, bool verbose) {
  const std::string drive = nameOf(setting, fault) + ", seed " + std::to_string(seed);
  const double misleading = evaluation.misleading.longest();
  if (verbose || misleading > 1.0) {
    std::printf("  %s: misleading for %.2f s\n", drive.c_str(), misleading);
  }
  if (!evaluation.arrived && (fault == "start" || fault == "kidnap" || fault == "push")) {
    std::printf("  %s: not localized\n", drive.c_str());
  }
  std::fflush(stdout);
}

/// Not of --write-map, whose files have a fault and a seed in their names.
void requireNewOutput(const Options& options) {
  std::vector<std::string> inputs{options.parameters.config};
  for (const std::string& map : options.maps) {
    for (const std::string& file : mapFiles(map)) inputs.push_back(file);
    for (const std::string& file : mapFiles(sim::worldPathFor(map))) inputs.push_back(file);
  }
  requireSeparateFiles({options.out}, inputs);
}

void run(const Options& options) {
  requireNewOutput(options);
  const LocalizerParameters parameters = readParameters(options.parameters);
  std::string table = kTableHeader;
  // Before the first drive, too, so that a path that cannot be written fails at once.
  const auto writeTable = [&] {
    if (!options.out.empty()) writeFile(options.out, table);
  };
  writeTable();
  for (const std::string& map : options.maps) {
    Setting setting{map, "", loadCourse(map, parameters)};
    for (const std::string& map_fault : options.map_faults) {
      setting.map_fault = map_fault;
      for (const std::string& fault : options.faults) {
        std::vector<DriveEvaluation> evaluations;
        for (int i = 0; i < options.drives; ++i) {
          const int seed = options.seed + i;
          evaluations.push_back(evaluateDrive(faultNames().at(fault), setting, parameters, options,
                                              static_cast<std::uint64_t>(seed)));
          table += tableRow(setting, fault, seed, evaluations.back());
          writeTable();
          reportDrive(setting, fault, seed, evaluations.back(), options.verbose);
        }
        report(nameOf(setting, fault), evaluations);
        reportErrors(evaluations);
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram(
      argc, argv, "evaluate_scenarios",
      "Failure scenarios: recovery and self-diagnosis on simulated drives with injected faults and "
      "wrong maps.",
      racecar_mcl::addOptions, racecar_mcl::run);
}
