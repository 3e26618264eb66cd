// What a localizer makes of trouble and of wrong maps, on many simulated drives: whether it finds
// itself, how soon, how accurate it is, and whether its verdict is right. The numbers of
// bench/ are made with it.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/drive_watch.h"
#include "evaluation/simulated_drive.h"
#include "output_files.h"
#include "parameter_options.h"
#include "program.h"
#include "sim/map_faults.h"
#include "sim/map_files.h"
#include "sim/traffic.h"

namespace racecar_mcl {
namespace {

constexpr double kClearance = 0.3;                 // m, about the car where it starts
constexpr double kFarAway = 2.0;                   // m, that a kidnapped car is carried at least
constexpr double kCoverRange = 0.05;               // m, where the beams of a covered lidar end
constexpr std::uint64_t kFaultSeed = 0x6d6170ULL;  // parts the map's faults drawn from the rest

enum class Trouble {
  kNone,
  kGlobalStart,
  kKidnap,
  kObstacles,
  kCrowd,
  kOpponent,
  kCovered,
  kFrozen,
  kPush,
  kScale,
  kWrongStart
};

const std::map<std::string, Trouble> kTroubles = {
    {"none", Trouble::kNone},
    {"start", Trouble::kGlobalStart},
    {"kidnap", Trouble::kKidnap},
    {"obstacles", Trouble::kObstacles},
    {"push", Trouble::kPush},
    {"crowd", Trouble::kCrowd},
    {"opponent", Trouble::kOpponent},
    {"covered", Trouble::kCovered},
    {"frozen_odometry", Trouble::kFrozen},
    {"wrong_scale", Trouble::kScale},
    {"wrong_start", Trouble::kWrongStart},
};

struct Options {
  std::vector<std::string> maps;
  std::vector<std::string> troubles{"start"};
  std::vector<std::string> faults{"none"};
  ParameterOptions parameters;
  int drives = 100;
  int seed = 1;
  double speed = 3.0;   // m/s
  double before = 4.0;  // s driven before the trouble
  double after = 8.0;   // s driven with it
  std::string out;
  std::string maps_out;
  bool verbose = false;
};

void addOptions(Options* o, CLI::App* app) {
  app->add_option("--map", o->maps, "YAML files of maps; each is driven on")->required();
  std::vector<std::string> names;
  for (const auto& trouble : kTroubles) names.push_back(trouble.first);
  app->add_option("--trouble", o->troubles, "what happens on the drives")
      ->check(CLI::IsMember(names))
      ->capture_default_str();
  names.clear();
  for (const auto& fault : sim::mapFaults()) names.push_back(fault.first);
  app->add_option("--map-fault", o->faults,
                  "what is wrong with the map that the localizer gets; each with each trouble")
      ->check(CLI::IsMember(names))
      ->capture_default_str();
  app->add_option("--drives", o->drives, "per map, fault and trouble")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--seed", o->seed, "of the first drive; each has its own")->capture_default_str();
  app->add_option("--speed", o->speed, "m/s")->capture_default_str();
  app->add_option("--before", o->before, "s, driven before the trouble")->capture_default_str();
  app->add_option("--after", o->after, "s, driven with it")->capture_default_str();
  addParameterOptions(&o->parameters, app);
  app->add_option("--out", o->out, "a CSV file with a row per drive");
  app->add_option("--write-map", o->maps_out,
                  "a folder for the maps that the localizer gets, as YAML and PGM");
  app->add_flag("--verbose", o->verbose, "a line per scan");
}

/// Clear of what stands there that no map shows.
Pose2 somewhereElse(const Course& course, const Pose2& here,
                    const std::vector<sim::Obstacle>& standing, Random& random) {
  for (;;) {
    const Pose2 pose = sim::randomFreePose(*course.world, {}, random, kClearance);
    if (distance(pose, here) < kFarAway) continue;
    if (!sim::overlaps(pose, {}, *course.world, standing, 0.0, kClearance)) return pose;
  }
}

/// Shoved aside by 0.2 to 0.6 m and turned by up to 0.3 rad, as by another car.
Pose2 pushedFrom(const Pose2& here, const Course& course,
                 const std::vector<sim::Obstacle>& standing, Random& random) {
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const double direction = random.uniform(-kPi, kPi);
    const double way = random.uniform(0.2, 0.6);
    const Pose2 pose{here.x + way * std::cos(direction), here.y + way * std::sin(direction),
                     wrapAngle(here.yaw + random.uniform(-0.3, 0.3))};
    if (!sim::overlaps(pose, {}, *course.world, standing, 0.0, 0.0)) return pose;
  }
  return here;
}

PoseEstimate certainlyAt(const Pose2& pose) {
  PoseEstimate start{pose, Eigen::Matrix3d::Zero()};
  start.covariance.diagonal() << 0.01, 0.01, 0.0025;
  return start;
}

void begin(Trouble trouble, const Course& course, const std::vector<sim::Obstacle>& standing,
           Random& random, SimulatedDrive* drive) {
  sim::SimulatorParameters parameters = drive->simulator().parameters();
  switch (trouble) {
    case Trouble::kKidnap:
      drive->simulator().place(
          somewhereElse(course, drive->simulator().truth().base_in_map, standing, random));
      break;
    case Trouble::kPush:
      drive->simulator().place(
          pushedFrom(drive->simulator().truth().base_in_map, course, standing, random));
      break;
    case Trouble::kWrongStart:
      drive->localizer().initialize(certainlyAt(
          somewhereElse(course, drive->simulator().truth().base_in_map, standing, random)));
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

/// Before each look of the driver `others(truth)` says what moves about besides what stands.
template <typename Others>
void surround(SimulatedDrive* drive, const std::vector<sim::Obstacle>& standing, Others others) {
  drive->before_look = [standing, others](sim::Simulator* simulator) mutable {
    std::vector<sim::Obstacle> all = others(simulator->truth());
    all.insert(all.end(), standing.begin(), standing.end());
    simulator->setObstacles(std::move(all));
  };
}

/// What is about that no map shows, besides what stands in the world anyway.
void fillWorld(Trouble trouble, const Course& course, const std::vector<sim::Obstacle>& standing,
               std::uint64_t seed, Random& random, SimulatedDrive* drive) {
  const Pose2 pose = drive->simulator().truth().base_in_map;
  std::vector<sim::Obstacle> obstacles;
  if (trouble == Trouble::kObstacles) {
    obstacles = sim::scatterObstacles(*course.world, 10, 4, pose, random, standing);
  }
  obstacles.insert(obstacles.end(), standing.begin(), standing.end());
  drive->simulator().setObstacles(obstacles);
  if (trouble == Trouble::kCrowd) {
    surround(drive, standing,
             [crowd = sim::Crowd(*course.world, pose, random)](const sim::Truth& car) mutable {
               return crowd.walk(car.base_in_map, car.stamp);
             });
  }
  if (trouble == Trouble::kOpponent) {
    surround(
        drive, standing,
        [opponent = sim::Opponent(seed), world = course.world](const sim::Truth& car) mutable {
          return std::vector<sim::Obstacle>{opponent.follow(car.base_in_map, car.stamp, *world)};
        });
  }
}

/// What is the same on all drives of a map and a fault.
struct Setting {
  std::string map_path;
  std::string fault;
  Course course;
};

/// "maps/track.yaml" and "grey" to "track_grey".
std::string wrongMapName(const Setting& setting, std::uint64_t seed) {
  return std::filesystem::path(setting.map_path).stem().string() + '_' + setting.fault + '_' +
         std::to_string(seed);
}

DriveWatch driveThrough(Trouble trouble, const Setting& setting,
                        const LocalizerParameters& parameters, const Options& options,
                        std::uint64_t seed) {
  Random random(seed);
  Course course = setting.course;
  const Pose2 pose = sim::randomFreePose(*course.world, {}, random, kClearance);
  Random fault_random(seed ^ kFaultSeed);
  const sim::WrongMap wrong = sim::makeWrongMap(
      sim::mapFaults().at(setting.fault), course.map->grid, *course.world, pose, fault_random);
  if (setting.fault != "none") course.map = makeMapModel(wrong.map, parameters);
  if (!options.maps_out.empty()) {
    const std::string name = wrongMapName(setting, seed);
    writeFolder(options.maps_out, {{name + ".yaml", sim::toMapYaml(wrong.map, name + ".pgm")},
                                   {name + ".pgm", sim::toPgm(wrong.map)}});
  }
  SimulatedDrive drive(course, parameters, {}, pose, options.speed, seed);
  fillWorld(trouble, course, wrong.boxes, seed, random, &drive);
  double begun = drive.simulator().time();
  DriveWatch watch;
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
    begin(trouble, course, wrong.boxes, random, &drive);
  }
  drive.drive(options.after, see);
  return watch;
}

void report(const std::string& what, const std::vector<DriveWatch>& watches) {
  const auto drives = static_cast<long>(watches.size());
  long arrived = 0, noticed = 0, trusted = 0, false_alarms = 0, right_scans = 0;
  std::vector<double> times;
  for (const DriveWatch& watch : watches) {
    times.push_back(watch.arrived.value_or(1e9));
    arrived += times.back() <= 5.0 ? 1 : 0;
    noticed += watch.noticed.value_or(1e9) <= 1.0 ? 1 : 0;
    trusted += watch.wrongly_trusted.longest() > 1.0 ? 1 : 0;
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

/// The errors of all drives together, since their trouble began.
void reportErrors(const std::vector<DriveWatch>& watches) {
  PositionErrors errors, errors_where_mapped;
  double longest_lost = 0.0;
  long far_off = 0;
  for (const DriveWatch& watch : watches) {
    errors.add(watch.errors);
    errors_where_mapped.add(watch.errors_where_mapped);
    longest_lost = std::max(longest_lost, watch.lost_while_right.longest());
    far_off += watch.errors.max() > DriveWatch::kFarOff ? 1 : 0;
  }
  const double mapped = static_cast<double>(errors_where_mapped.count()) /
                        static_cast<double>(std::max<std::size_t>(1, errors.count()));
  std::printf(
      "  error: mean %.3f m, 99 %% %.3f m, max %.3f m; mean %.3f m where mapped (%.1f %% of the "
      "time); over 0.5 m %.2f %% of the time; ever over 2 m in %ld drives; called lost while right "
      "for up to %.2f s\n",
      errors.mean(), errors.quantile(0.99), errors.max(), errors_where_mapped.mean(),
      100.0 * mapped, 100.0 * errors.shareAbove(DriveWatch::kWrong), far_off, longest_lost);
}

constexpr const char* kTableHeader =
    "map,trouble,seed,localized,noticed,longest_wrong_trust,map_fault,mean_error,p99_error,"
    "max_error,mean_error_where_mapped,wrong_share,longest_lost_while_right,ever_far_off\n";

/// What became of a drive; times in s since the trouble began, empty where it never happened;
/// errors in m.
std::string tableRow(const Setting& setting, const std::string& trouble, int seed,
                     const DriveWatch& watch) {
  std::string row = setting.map_path + ',' + trouble + ',' + std::to_string(seed);
  const auto add = [&](const std::optional<double>& value) {
    char text[32] = "";
    if (value) std::snprintf(text, sizeof(text), "%.3f", *value);
    row += std::string(",") + text;
  };
  const PositionErrors& errors = watch.errors;
  const PositionErrors& mapped = watch.errors_where_mapped;
  add(watch.arrived);
  add(watch.noticed);
  add(watch.wrongly_trusted.longest());
  row += ',' + setting.fault;
  add(errors.mean());
  add(errors.quantile(0.99));
  add(errors.max());
  add(mapped.count() > 0 ? std::optional<double>(mapped.mean()) : std::nullopt);
  add(errors.shareAbove(DriveWatch::kWrong));
  add(watch.lost_while_right.longest());
  return row + ',' + (errors.max() > DriveWatch::kFarOff ? '1' : '0') + '\n';
}

std::string nameOf(const Setting& setting, const std::string& trouble) {
  const std::string wrong_map = setting.fault == "none" ? "" : ", map " + setting.fault;
  return setting.map_path + wrong_map + ", " + trouble;
}

/// A line for a drive that is worth a look.
void reportDrive(const Setting& setting, const std::string& trouble, int seed,
                 const DriveWatch& watch, bool verbose) {
  const std::string drive = nameOf(setting, trouble) + ", seed " + std::to_string(seed);
  const double trusted = watch.wrongly_trusted.longest();
  if (verbose || trusted > 1.0) {
    std::printf("  %s: wrongly trusted for %.2f s\n", drive.c_str(), trusted);
  }
  if (!watch.arrived && (trouble == "start" || trouble == "kidnap" || trouble == "push")) {
    std::printf("  %s: not localized\n", drive.c_str());
  }
  std::fflush(stdout);
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
    Setting setting{map, "", loadCourse(map, parameters)};
    for (const std::string& fault : options.faults) {
      setting.fault = fault;
      for (const std::string& trouble : options.troubles) {
        std::vector<DriveWatch> watches;
        for (int i = 0; i < options.drives; ++i) {
          const int seed = options.seed + i;
          watches.push_back(driveThrough(kTroubles.at(trouble), setting, parameters, options,
                                         static_cast<std::uint64_t>(seed)));
          table += tableRow(setting, trouble, seed, watches.back());
          keepTable();
          reportDrive(setting, trouble, seed, watches.back(), options.verbose);
        }
        report(nameOf(setting, trouble), watches);
        reportErrors(watches);
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram(
      argc, argv, "evaluate_drives",
      "Simulated drives with trouble and wrong maps: whether the localizer finds itself, and says "
      "so.",
      racecar_mcl::addOptions, racecar_mcl::run);
}
