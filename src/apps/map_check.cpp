// Reads a map as the localizer does; says, and draws, what a lidar can see of it.
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "program.h"
#include "racecar_mcl/errors.h"
#include "racecar_mcl/map_io.h"
#include "racecar_mcl/map_summary.h"

namespace racecar_mcl {
namespace {

struct Options {
  std::string map;
  std::string out;
};

void addOptions(Options* o, CLI::App* app) {
  app->add_option("map", o->map, "map_server YAML")->required()->type_name("MAP.yaml");
  app->add_option("--out", o->out, "draw what is seen of the map into this image, e.g. map.png");
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

// Blue first, as OpenCV has them.
const cv::Vec3b kFree(255, 255, 255);
const cv::Vec3b kUnknown(205, 205, 205);
const cv::Vec3b kSurface(0, 0, 0);
const cv::Vec3b kHidden(110, 110, 110);
const cv::Vec3b kBlurred(0, 140, 255);
const cv::Vec3b kOpening(230, 90, 0);

/// A pixel per cell, the highest row first.
cv::Mat drawCells(const OccupancyGrid& grid, const Surfaces& surfaces) {
  const GridGeometry& geometry = grid.geometry();
  const std::vector<std::uint8_t> openings = findOpenings(grid);
  cv::Mat picture(geometry.height, geometry.width, CV_8UC3);
  std::size_t i = 0;
  for (int row = 0; row < geometry.height; ++row) {
    for (int column = 0; column < geometry.width; ++column, ++i) {
      cv::Vec3b& pixel = picture.at<cv::Vec3b>(geometry.height - 1 - row, column);
      if (grid.cells()[i] < 0) {
        pixel = kUnknown;
      } else if (grid.isFree({column, row})) {
        pixel = openings[i] != 0 ? kOpening : kFree;
      } else {
        pixel = surfaces.visible[i] != 0 ? kSurface : surfaces.blurred[i] != 0 ? kBlurred : kHidden;
      }
    }
  }
  return picture;
}

constexpr int kWideEnough = 1200;   // pixels, to which small maps are magnified
constexpr int kMostMagnified = 40;  // pixels per cell

/// The legend's size follows the picture's, for it is looked at as a whole.
cv::Mat drawLegend(int width) {
  const double unit = std::max(1.0, width / 1600.0);
  const auto pixels = [&](double count) { return cvRound(count * unit); };
  const std::pair<cv::Vec3b, const char*> entries[] = {
      {kFree, "free"},       {kUnknown, "unknown"}, {kSurface, "surface"},
      {kBlurred, "blurred"}, {kHidden, "hidden"},   {kOpening, "opening"}};
  cv::Mat legend(pixels(30), std::max(width, pixels(690)), CV_8UC3, cv::Scalar::all(255));
  cv::line(legend, {0, 0}, {legend.cols, 0}, cv::Scalar::all(150));
  int x = pixels(10);
  for (const auto& [colour, name] : entries) {
    const cv::Rect box(x, pixels(9), pixels(14), pixels(14));
    cv::rectangle(legend, box, cv::Scalar(colour), cv::FILLED);
    cv::rectangle(legend, box, cv::Scalar::all(90), 1);
    cv::putText(legend, name, {x + pixels(21), pixels(21)}, cv::FONT_HERSHEY_SIMPLEX, 0.5 * unit,
                cv::Scalar(48, 36, 28), pixels(1), cv::LINE_AA);
    x += pixels(113);
  }
  return legend;
}

/// Cells are squares of whole pixels from the left upper corner on; below them is the legend.
cv::Mat drawMap(const OccupancyGrid& grid, const Surfaces& surfaces) {
  const cv::Mat cells = drawCells(grid, surfaces);
  const int scale =
      std::clamp(cvRound(1.0 * kWideEnough / std::max(cells.cols, cells.rows)), 1, kMostMagnified);
  const cv::Size size(cells.cols * scale, cells.rows * scale);
  const cv::Mat legend = drawLegend(size.width);
  cv::Mat picture(size.height + legend.rows, legend.cols, CV_8UC3, cv::Scalar::all(255));
  cv::resize(cells, picture(cv::Rect({0, 0}, size)), size, 0.0, 0.0, cv::INTER_NEAREST);
  legend.copyTo(picture.rowRange(size.height, picture.rows));
  return picture;
}

void write(const cv::Mat& picture, const std::string& path) {
  bool written = false;
  try {
    written = cv::imwrite(path, picture);
  } catch (const cv::Exception&) {  // no known ending
  }
  if (!written) {
    throw std::runtime_error(path +
                             ": the picture could not be written; expected a name such as map.png "
                             "in a folder that exists");
  }
}

void run(const Options& o) {
  const OccupancyGrid grid = loadMap(o.map);
  const Surfaces surfaces = findSurfaces(grid);
  const MapSummary summary = summarize(grid, surfaces);
  print(summary, std::cout);
  if (!std::cout) throw std::runtime_error("stdout: the summary could not be written whole");
  if (!o.out.empty()) write(drawMap(grid, surfaces), o.out);
  if (!summary.usable()) throw MapError(o.map + ": a localizer cannot use this map");
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram(
      argc, argv, "map_check",
      "Reads a map as the localizer does; says, and with --out draws, what a lidar can see of it. "
      "Exit code 1 where a localizer cannot use the map.",
      racecar_mcl::addOptions, racecar_mcl::run);
}
