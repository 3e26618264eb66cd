// Checks a map: prints and draws its statistics and the surfaces that a lidar can see, or, with a
// recorded drive, what changed.
#include <iomanip>
#include <iostream>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "cli.h"
#include "file_options.h"
#include "image_file.h"
#include "map_change_picture.h"
#include "map_changes/map_change_detector.h"
#include "map_changes/map_change_report.h"
#include "offline/output_files.h"
#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/map/map_io.h"
#include "racecar_mcl/map/map_summary.h"
#include "racecar_mcl/map/map_writer.h"
#include "replay_run.h"

namespace racecar_mcl {
namespace {

struct Options : ReplayOptions {
  std::string out;
  std::string output;
};

void addOptions(Options* o, CLI::App* app) {
  app->add_option("map,--map", o->map, "map_server YAML")->required()->type_name("MAP.yaml");
  CLI::Option* out = app->add_option("--out", o->out,
                                     "draw the visible surfaces into this image, such as map.png");
  CLI::Option* bag = app->add_option("--bag", o->bags,
                                     "recorded drive; prints what it saw changed; may be repeated");
  bag->excludes(out);
  // One value per --bag: a map may follow.
  bag->allow_extra_args(false);
  const std::size_t common = app->get_options().size();
  app->add_option(
         "--output", o->output,
         "output folder for the proposed map.yaml and map.pgm, changes.png and changes.csv")
      ->type_name("FOLDER");
  addReplayOptions(o, app);
  const std::vector<CLI::Option*> options = app->get_options();
  for (std::size_t i = common; i < options.size(); ++i) options[i]->needs(bag);
}

void print(const MapSummary& s, std::ostream& out) {
  const Pose2& origin = s.geometry.origin;
  out << describe(s) << '\n' << std::fixed;
  out << std::setprecision(3) << "  origin    x " << origin.x << " m, y " << origin.y << " m, yaw "
      << origin.yaw << " rad\n";
  out << std::setprecision(1) << "  cells     " << 100.0 * s.free_share << " % free, "
      << 100.0 * s.occupied_share << " % occupied, " << 100.0 * s.unknown_share << " % unknown\n";
  out << "  free      " << s.free_area << " m2; areas larger than 0.5 m2: " << s.free_areas;
  if (s.free_area > 0.0) {
    out << ", the largest has " << 100.0 * s.largest_free_area / s.free_area << " %";
  }
  out << "\n  surfaces  " << s.surface_cells << " cells, about " << s.surface_length << " m\n"
      << "  blurred   " << s.blurred_area << " m2 of walls; of the surfaces "
      << 100.0 * s.blurred_surface_share << " %\n"
      << "  hidden    " << 100.0 * s.hidden_share << " % of the obstacle cells\n"
      << "  openings  " << 100.0 * s.opening_share << " % of the border of free space\n";
  for (const std::string& line : s.warnings) out << "warning: " << line << '\n';
  out.flush();
}

// BGR.
const cv::Vec3b kFree(255, 255, 255);
const cv::Vec3b kUnknown(205, 205, 205);
const cv::Vec3b kUnmapped(240, 200, 160);
const cv::Vec3b kSurface(0, 0, 0);
const cv::Vec3b kHidden(110, 110, 110);
const cv::Vec3b kBlurred(0, 140, 255);
const cv::Vec3b kOpening(230, 90, 0);

/// One pixel per cell, highest row first.
cv::Mat drawCells(const OccupancyGrid& grid, const Surfaces& surfaces) {
  const GridGeometry& geometry = grid.geometry();
  const std::vector<std::uint8_t> openings = findOpenings(grid);
  const std::vector<std::uint8_t> unmapped = findUnmapped(grid, surfaces);
  cv::Mat picture(geometry.height, geometry.width, CV_8UC3);
  std::size_t i = 0;
  for (int row = 0; row < geometry.height; ++row) {
    for (int column = 0; column < geometry.width; ++column, ++i) {
      cv::Vec3b& pixel = picture.at<cv::Vec3b>(geometry.height - 1 - row, column);
      if (grid.cells()[i] < 0) {
        pixel = unmapped[i] != 0 ? kUnmapped : kUnknown;
      } else if (grid.isFree({column, row})) {
        pixel = openings[i] != 0 ? kOpening : kFree;
      } else {
        pixel = surfaces.visible[i] != 0 ? kSurface : surfaces.blurred[i] != 0 ? kBlurred : kHidden;
      }
    }
  }
  return picture;
}

/// The cells, magnified by a whole number, with a legend below.
cv::Mat drawMap(const OccupancyGrid& grid) {
  const cv::Mat cells = drawCells(grid, findSurfaces(grid));
  const int scale = magnificationOf(cells.size());
  cv::Mat picture;
  cv::resize(cells, picture, {}, scale, scale, cv::INTER_NEAREST);
  return withLegend(picture, drawLegend({{kFree, "free"},
                                         {kUnknown, "unknown"},
                                         {kUnmapped, "missing"},
                                         {kSurface, "surface"},
                                         {kBlurred, "blurred"},
                                         {kHidden, "hidden"},
                                         {kOpening, "opening"}},
                                        picture.cols));
}

void checkMap(const Options& o) {
  requireSeparateFiles({o.out}, mapFiles(o.map));
  const OccupancyGrid grid = loadMap(o.map);
  const MapSummary summary = summarize(grid);
  print(summary, std::cout);
  if (!std::cout) throw std::runtime_error("stdout: cannot write the whole summary");
  if (!o.out.empty()) writeImage(drawMap(grid), o.out);
  if (!summary.usable()) throw MapError(o.map + ": the localizer cannot use this map");
}

class ChangeObserver : public ReplayObserver {
 public:
  explicit ChangeObserver(const OccupancyGrid& grid) : detector_(grid) {}

  void onScan(const Scan& scan, const ScanRow& row, const Localizer& localizer) override {
    detector_.add(localizer, scan, row.result);
  }
  void onMessage(const Localizer& /*localizer*/) override {}

  MapChangeDetector& detector() { return detector_; }

 private:
  MapChangeDetector detector_;
};

constexpr char kYaml[] = "map.yaml";
constexpr char kPgm[] = "map.pgm";
constexpr char kPicture[] = "changes.png";
constexpr char kTable[] = "changes.csv";

void validateDrive(const Options& o) {
  std::vector<std::string> inputs = mapFiles(o.map);
  inputs.insert(inputs.end(), o.bags.begin(), o.bags.end());
  inputs.insert(inputs.end(), {o.truth, o.parameters.config});
  requireSeparateFiles(filesIn(o.output, {kYaml, kPgm, kPicture, kTable}), inputs);
  validateSpan(o.span);
}

void findMapChanges(const Options& o) {
  validateDrive(o);
  const PreparedReplay prepared = prepareReplay(o, "map_check");
  const OccupancyGrid& grid = prepared.localizer->map()->grid;
  ChangeObserver observer(grid);
  const ReplayRecord record = runReplay(o, "map_check", prepared, {&observer});
  const MapChanges changes = observer.detector().finish();
  const std::uint32_t views = observer.detector().views();
  if (views < MapChangeParameters().min_views) {
    throw BagError(std::to_string(views) + " of " + std::to_string(record.scans_seen) +
                   " scans were taken by a moving and localized car, too few to find changes; "
                   "expected " +
                   std::to_string(MapChangeParameters().min_views) + "; no map is proposed");
  }
  std::cout << views << " of " << record.scans_seen << " scans compared with the map\n"
            << changesText(changes);
  if (o.output.empty()) return;
  writeFolder(o.output, {{kPgm, toPgm(applyChanges(grid, changes), MapMode::kTrinary)},
                         {kYaml, toMapYaml(grid.geometry(), kPgm, MapMode::kTrinary)},
                         {kPicture, toPng(drawChanges(grid, changes))},
                         {kTable, changesCsv(changes)}});
}

void run(const Options& o) { o.bags.empty() ? checkMap(o) : findMapChanges(o); }

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram(argc, argv, "map_check",
                                 "Checks a map: prints statistics and warnings; with --out draws "
                                 "the surfaces that a lidar can "
                                 "see. Exit code 1 if the localizer cannot use the map. With --bag "
                                 "localizes over the recorded "
                                 "drive and prints the cells that changed since the map was made; "
                                 "with --output proposes a map. "
                                 "Exit code 1 if the car was not localized.",
                                 racecar_mcl::addOptions, racecar_mcl::run);
}
