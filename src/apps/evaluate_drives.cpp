// How a localizer that is told nothing finds itself: many simulated drives, each from another
// random pose. The numbers of bench/ are made with it.
#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/simulated_drive.h"
#include "parameter_options.h"
#include "program.h"

namespace racecar_mcl {
namespace {

constexpr double kRight = 0.15;     // m
constexpr double kWrong = 0.5;      // m
constexpr double kDriven = 8.0;     // s, after the start
constexpr double kClearance = 0.3;  // m, about the car where it starts

struct Options {
  std::vector<std::string> maps;
  std::string config;
  std::vector<std::string> settings;
  int drives = 100;
  int seed = 1;
  double speed = 3.0;   // m/s
  double within = 5.0;  // s
};

/// When a drive was localized: the first error below 15 cm that none above 50 cm follows.
class Arrival {
 public:
  void see(double seconds, double error) {
    if (!(error <= kWrong)) seconds_.reset();
    if (error <= kRight && !seconds_) seconds_ = seconds;
  }
  std::optional<double> seconds() const { return seconds_; }

 private:
  std::optional<double> seconds_;
};

std::optional<double> findItself(const Course& course, const LocalizerParameters& parameters,
                                 double speed, std::uint64_t seed) {
  Random random(seed);
  const Pose2 pose = sim::randomFreePose(*course.world, {}, random, kClearance);
  SimulatedDrive drive(course, parameters, {}, pose, speed, seed);
  drive.localizer().initializeGlobally();
  const double begin = drive.simulator().time();
  Arrival arrival;
  drive.drive(kDriven,
              [&](const Observation& seen) { arrival.see(seen.result.stamp - begin, seen.error); });
  return arrival.seconds();
}

void report(const std::string& map, std::vector<double> times, double within) {
  std::sort(times.begin(), times.end());
  const auto in_time =
      std::count_if(times.begin(), times.end(), [&](double seconds) { return seconds <= within; });
  std::printf("%s: %ld of %zu localized within %.1f s; median %.2f s, 90 %% within %.2f s\n",
              map.c_str(), static_cast<long>(in_time), times.size(), within,
              times[times.size() / 2], times[times.size() * 9 / 10]);
}

void run(const Options& options) {
  const LocalizerParameters parameters = readParameters(options.config, options.settings);
  for (const std::string& map : options.maps) {
    const Course course = loadCourse(map, parameters);
    std::vector<double> times;
    for (int i = 0; i < options.drives; ++i) {
      const int seed = options.seed + i;
      const std::optional<double> seconds =
          findItself(course, parameters, options.speed, static_cast<std::uint64_t>(seed));
      times.push_back(seconds.value_or(kDriven));
      if (!seconds) std::printf("%s: not with seed %d\n", map.c_str(), seed);
    }
    report(map, std::move(times), options.within);
  }
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  racecar_mcl::Options options;
  CLI::App app(
      "Starts the localizer anywhere on simulated drives: how many find themselves, how soon.",
      "evaluate_drives");
  app.add_option("--map", options.maps, "YAML files of maps; each is driven on")->required();
  app.add_option("--drives", options.drives, "per map")->capture_default_str();
  app.add_option("--seed", options.seed, "of the first drive; each has its own")
      ->capture_default_str();
  app.add_option("--speed", options.speed, "m/s")->capture_default_str();
  app.add_option("--within", options.within, "s, to be localized")->capture_default_str();
  app.add_option("--config", options.config, "parameters as a YAML file");
  app.add_option("--set", options.settings, "a parameter as name:=value; after --config");
  return racecar_mcl::runProgram(app, argc, argv, [&] { racecar_mcl::run(options); });
}
