// What a localizer makes of trouble, on many simulated drives: whether it finds itself, how soon,
// and whether its verdict tells. The numbers of bench/ are made with it.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/simulated_drive.h"
#include "output_files.h"
#include "parameter_options.h"
#include "program.h"

namespace racecar_mcl {
namespace {

constexpr double kRight = 0.15;       // m
constexpr double kWrong = 0.5;        // m
constexpr double kClearance = 0.3;    // m, about the car where it starts
constexpr double kFarAway = 2.0;      // m, that a kidnapped car is carried at least
constexpr double kCoverRange = 0.05;  // m, where the beams of a covered lidar end

enum class Trouble {
  kNone,
  kGlobalStart,
  kKidnap,
  kObstacles,
  kCovered,
  kFrozen,
  kScale,
  kWrongStart
};

const std::map<std::string, Trouble> kTroubles = {
    {"none", Trouble::kNone},         {"start", Trouble::kGlobalStart},
    {"kidnap", Trouble::kKidnap},     {"obstacles", Trouble::kObstacles},
    {"covered", Trouble::kCovered},   {"frozen_odometry", Trouble::kFrozen},
    {"wrong_scale", Trouble::kScale}, {"wrong_start", Trouble::kWrongStart},
};

struct Options {
  std::vector<std::string> maps;
  std::vector<std::string> troubles{"start"};
  ParameterOptions parameters;
  int drives = 100;
  int seed = 1;
  double speed = 3.0;   // m/s
  double before = 4.0;  // s driven before the trouble
  double after = 8.0;   // s driven with it
  std::string out;
  bool verbose = false;
};

void addOptions(Options* o, CLI::App* app) {
  app->add_option("--map", o->maps, "YAML files of maps; each is driven on")->required();
  std::vector<std::string> names;
  for (const auto& trouble : kTroubles) names.push_back(trouble.first);
  app->add_option("--trouble", o->troubles, "what happens on the drives")
      ->check(CLI::IsMember(names))
      ->capture_default_str();
  app->add_option("--drives", o->drives, "per map and trouble")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--seed", o->seed, "of the first drive; each has its own")->capture_default_str();
  app->add_option("--speed", o->speed, "m/s")->capture_default_str();
  app->add_option("--before", o->before, "s, driven before the trouble")->capture_default_str();
  app->add_option("--after", o->after, "s, driven with it")->capture_default_str();
  addParameterOptions(&o->parameters, app);
  app->add_option("--out", o->out, "a CSV file with a row per drive");
  app->add_flag("--verbose", o->verbose, "a line per scan");
}

/// What is seen of one drive, in s since its trouble began.
class Watch {
 public:
  void see(double seconds, const Observation& seen) {
    const bool right = seen.error <= kWrong;
    const bool trusted = seen.result.verdict.state == VerdictState::kLocalized;
    const bool alarmed = seen.result.verdict.state == VerdictState::kDegraded ||
                         seen.result.verdict.state == VerdictState::kLost;
    ++scans;
    right_scans += right ? 1 : 0;
    false_alarms += right && alarmed ? 1 : 0;
    if (right || !trusted) wrongly_trusted_since_.reset();
    if (!right && trusted) {
      if (!wrongly_trusted_since_) wrongly_trusted_since_ = last_seconds_;
      longest_wrong_trust = std::max(longest_wrong_trust, seconds - *wrongly_trusted_since_);
    }
    last_seconds_ = seconds;
    if (seconds < 0.0) return;
    if (!trusted && !noticed) noticed = seconds;
    if (!right) arrived.reset();
    if (seen.error <= kRight && !arrived) arrived = seconds;
  }

  std::optional<double> arrived;     ///< the first error below 15 cm that none above 50 cm follows
  std::optional<double> noticed;     ///< when it was first not trusted
  double longest_wrong_trust = 0.0;  ///< localized, it said, while wrong by more than 50 cm
  long scans = 0;
  long right_scans = 0;
  long false_alarms = 0;

 private:
  double last_seconds_ = 0.0;
  std::optional<double> wrongly_trusted_since_;
};

Pose2 somewhereElse(const Course& course, const Pose2& here, Random& random) {
  for (;;) {
    const Pose2 pose = sim::randomFreePose(*course.world, {}, random, kClearance);
    if (distance(pose, here) >= kFarAway) return pose;
  }
}

PoseEstimate certainlyAt(const Pose2& pose) {
  PoseEstimate start{pose, Eigen::Matrix3d::Zero()};
  start.covariance.diagonal() << 0.01, 0.01, 0.0025;
  return start;
}

void begin(Trouble trouble, const Course& course, Random& random, SimulatedDrive* drive) {
  sim::SimulatorParameters parameters = drive->simulator().parameters();
  switch (trouble) {
    case Trouble::kKidnap:
      drive->simulator().place(
          somewhereElse(course, drive->simulator().truth().base_in_map, random));
      break;
    case Trouble::kWrongStart:
      drive->localizer().initialize(
          certainlyAt(somewhereElse(course, drive->simulator().truth().base_in_map, random)));
      break;
    case Trouble::kCovered:
      drive->on_scan = [](Scan* scan) {
        scan->ranges.setConstant(static_cast<float>(kCoverRange));
        return true;
      };
      break;
    case Trouble::kFrozen:
      drive->on_odometry = [](OdometrySample* sample) {
        sample->twist = {};
        return true;
      };
      break;
    case Trouble::kScale:
      parameters.odometry.speed_scale_error = random.uniform() < 0.5 ? 0.5 : -0.4;
      drive->simulator().setParameters(parameters);
      break;
    default:
      break;
  }
}

Watch driveThrough(Trouble trouble, const Course& course, const LocalizerParameters& parameters,
                   const Options& options, std::uint64_t seed) {
  Random random(seed);
  const Pose2 pose = sim::randomFreePose(*course.world, {}, random, kClearance);
  SimulatedDrive drive(course, parameters, {}, pose, options.speed, seed);
  if (trouble == Trouble::kObstacles) {
    drive.simulator().setObstacles(sim::scatterObstacles(*course.world, 10, 4, pose, random));
  }
  double begun = drive.simulator().time();
  Watch watch;
  const auto see = [&](const Observation& seen) {
    watch.see(seen.result.stamp - begun, seen);
    if (!options.verbose) return;
    std::printf("  %7.3f s, %6.3f m: %s, %s\n", seen.result.stamp - begun, seen.error,
                describe(seen.result.verdict.state).c_str(), seen.result.verdict.reason.c_str());
  };
  if (trouble == Trouble::kGlobalStart) {
    drive.localizer().initializeGlobally();
  } else {
    drive.localizer().initialize(certainlyAt(pose));
    begun += options.before;
    drive.drive(options.before, see);
    begin(trouble, course, random, &drive);
  }
  drive.drive(options.after, see);
  return watch;
}

void report(const std::string& what, const std::vector<Watch>& watches) {
  const auto drives = static_cast<long>(watches.size());
  long arrived = 0, noticed = 0, trusted = 0, false_alarms = 0, right_scans = 0;
  std::vector<double> times;
  for (const Watch& watch : watches) {
    times.push_back(watch.arrived.value_or(1e9));
    arrived += times.back() <= 5.0 ? 1 : 0;
    noticed += watch.noticed.value_or(1e9) <= 1.0 ? 1 : 0;
    trusted += watch.longest_wrong_trust > 1.0 ? 1 : 0;
    false_alarms += watch.false_alarms;
    right_scans += watch.right_scans;
  }
  std::sort(times.begin(), times.end());
  char median[32] = "none";
  if (times[times.size() / 2] < 1e9) {
    std::snprintf(median, sizeof(median), "%.2f s", times[times.size() / 2]);
  }
  std::printf(
      "%s: of %ld drives %ld localized within 5 s (median %s), %ld noticed within 1 s, %ld "
      "wrongly trusted for over 1 s; false alarms %.2f %% of the time\n",
      what.c_str(), drives, arrived, median, noticed, trusted,
      100.0 * static_cast<double>(false_alarms) / static_cast<double>(std::max(1L, right_scans)));
}

constexpr const char* kTableHeader = "map,trouble,seed,localized,noticed,longest_wrong_trust\n";

/// What became of a drive; times in s since the trouble began, empty where it never happened.
std::string tableRow(const std::string& map, const std::string& trouble, int seed,
                     const Watch& watch) {
  const auto seconds = [](const std::optional<double>& value) {
    char text[32] = "";
    if (value) std::snprintf(text, sizeof(text), "%.3f", *value);
    return std::string(text);
  };
  return map + ',' + trouble + ',' + std::to_string(seed) + ',' + seconds(watch.arrived) + ',' +
         seconds(watch.noticed) + ',' + seconds(watch.longest_wrong_trust) + '\n';
}

void run(const Options& options) {
  const LocalizerParameters parameters = readParameters(options.parameters);
  std::string table = kTableHeader;
  // After every drive, and before the first: what is wrong with the path shows at once.
  const auto keepTable = [&] {
    if (!options.out.empty()) writeFile(options.out, table);
  };
  keepTable();
  for (const std::string& map : options.maps) {
    const Course course = loadCourse(map, parameters);
    for (const std::string& name : options.troubles) {
      std::vector<Watch> watches;
      for (int i = 0; i < options.drives; ++i) {
        const auto seed = static_cast<std::uint64_t>(options.seed + i);
        watches.push_back(driveThrough(kTroubles.at(name), course, parameters, options, seed));
        const Watch& watch = watches.back();
        table += tableRow(map, name, options.seed + i, watch);
        keepTable();
        if (options.verbose || watch.longest_wrong_trust > 1.0) {
          std::printf("  %s, %s, seed %d: wrongly trusted for %.2f s\n", map.c_str(), name.c_str(),
                      options.seed + i, watch.longest_wrong_trust);
        }
        if (!watch.arrived && (name == "start" || name == "kidnap")) {
          std::printf("  %s, %s, seed %d: not localized\n", map.c_str(), name.c_str(),
                      options.seed + i);
        }
        std::fflush(stdout);
      }
      report(map + ", " + name, watches);
    }
  }
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram(
      argc, argv, "evaluate_drives",
      "Simulated drives with trouble: whether the localizer finds itself, and says so.",
      racecar_mcl::addOptions, racecar_mcl::run);
}
