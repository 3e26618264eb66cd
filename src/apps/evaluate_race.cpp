// Laps of the simulated car on the estimate of the localizer and on the true pose, at several
// speeds. Prints a table; the reports in bench/ use it.
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "cli.h"
#include "offline/race_drive.h"
#include "parameter_options.h"

namespace racecar_mcl {
namespace {

struct Options {
  std::vector<std::string> maps;
  std::vector<double> speeds{3.0, 5.0, 7.0, 7.6};  // m/s
  std::vector<std::string> grips{"high", "low"};
  std::vector<std::string> opponents{"none", "one"};
  double slip = kLowGrip.slip;
  ParameterOptions parameters;
  int laps = 20;
  int drives = 1;
  int seed = 1;
};

void addOptions(Options* o, CLI::App* app) {
  app->add_option("--map", o->maps, "map YAML files of closed courses; each is raced on")
      ->required();
  app->add_option("--speed", o->speeds, "m/s, maximum of the speed profile")
      ->check(CLI::Range(0.1, 20.0))
      ->capture_default_str();
  app->add_option(
         "--grip", o->grips,
         "high: 7 m/s^2, wheels do not slip; low: 5 m/s^2, wheels slip by --slip in bursts")
      ->check(CLI::IsMember({"high", "low"}))
      ->capture_default_str();
  app->add_option("--opponent", o->opponents, "one: a car stays beside or ahead of ours")
      ->check(CLI::IsMember({"none", "one"}))
      ->capture_default_str();
  app->add_option("--laps", o->laps, "laps of a drive, after the first one, from standing")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--drives", o->drives, "drives per row")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--seed", o->seed, "seed of the first drive; the next drives count up")
      ->capture_default_str();
  app->add_option("--slip", o->slip, "fraction, at low grip")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  addParameterOptions(&o->parameters, app);
}

void printHeader() {
  std::printf(
      "| map | limit | grip | opponent | laps | max speed "
      "| lateral error on the truth, mean / max | lateral error on the estimate, mean / max "
      "| error along, mean / max | error across, mean / max "
      "| localized | of these beyond the protection level "
      "| lap time on the truth | lap time on the estimate | scan at the bounds | collisions |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
}

void printRow(const std::string& map, const RaceSettings& settings, const std::string& grip,
              const RaceScore& truth, const RaceScore& estimate) {
  const auto centimetres = [](const PositionErrors& errors) {
    char text[48];
    std::snprintf(text, sizeof(text), "%.2f / %.1f cm", 100.0 * errors.mean(),
                  100.0 * errors.max());
    return std::string(text);
  };
  std::printf(
      "| %s | %.1f m/s | %s | %s | %zu | %.2f m/s | %s | %s | %s | %s | %.2f %% | %.2f %% | "
      "%.3f ± %.3f s | %.3f ± %.3f s | %.1f %% | %d |\n",
      map.c_str(), settings.max_speed, grip.c_str(), settings.has_opponent ? "one" : "none",
      estimate.lap_times.size(), estimate.max_speed, centimetres(truth.lateral).c_str(),
      centimetres(estimate.lateral).c_str(), centimetres(estimate.along).c_str(),
      centimetres(estimate.across).c_str(), 100.0 * estimate.shareLocalized(),
      100.0 * estimate.shareBeyondLevel(), truth.meanLapTime(), truth.lapTimeDeviation(),
      estimate.meanLapTime(), estimate.lapTimeDeviation(), 100.0 * estimate.shareAtBounds(),
      estimate.collisions);
  std::fflush(stdout);
}

void run(const Options& options) {
  const LocalizerParameters parameters = readParameters(options.parameters);
  for (const std::string& map : options.maps) {
    const RaceTrack track = loadRaceTrack(map, parameters);
    if (&map == &options.maps.front()) printHeader();
    for (const double speed : options.speeds) {
      for (const std::string& grip : options.grips) {
        RaceSettings settings;
        settings.max_speed = speed;
        settings.grip = grip == "high" ? kHighGrip : kLowGrip;
        if (grip == "low") settings.grip.slip = options.slip;
        settings.laps = options.laps;
        const RaceScore truth = raceOnTruth(track, settings);
        for (const std::string& opponent : options.opponents) {
          settings.has_opponent = opponent == "one";
          RaceScore estimate;
          for (int i = 0; i < options.drives; ++i) {
            settings.seed = static_cast<std::uint64_t>(options.seed + i);
            estimate += raceOnEstimate(track, parameters, settings);
          }
          printRow(std::filesystem::path(map).stem().string(), settings, grip, truth, estimate);
        }
      }
    }
  }
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram(
      argc, argv, "evaluate_race",
      "Laps of the simulated car along a raceline, steered on the localizer's estimate and, for "
      "comparison, on the true pose. Prints a Markdown table.",
      racecar_mcl::addOptions, racecar_mcl::run);
}
