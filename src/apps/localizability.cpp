// Draws how well a lidar can localize on a map, before anyone drives.
#include "racecar_mcl/monitoring/localizability.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "cli.h"
#include "file_options.h"
#include "image_file.h"
#include "parameter_options.h"
#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/common/validation.h"
#include "racecar_mcl/localizer/localizer_parameters.h"
#include "racecar_mcl/map/map_io.h"

namespace racecar_mcl {
namespace {

struct Options {
  std::string map;
  std::string out;
  ParameterOptions parameters;
  double spacing = 0.25;
  double blind = 0.1;
  double field_of_view = 270.0;
};

void addOptions(Options* o, CLI::App* app) {
  app->add_option("map", o->map, "map_server YAML")->required()->type_name("MAP.yaml");
  app->add_option("--out", o->out, "draw the map with its blind places into this image");
  app->add_option("--spacing", o->spacing, "distance between the evaluated places, m")
      ->capture_default_str();
  app->add_option("--blind", o->blind,
                  "standard deviation of a scan's position from which on a place is blind, m")
      ->capture_default_str();
  app->add_option("--field-of-view", o->field_of_view, "of the lidar, degrees")
      ->capture_default_str();
  addParameterOptions(&o->parameters, app);
}

/// A place on the map and the position error of a scan there.
struct Place {
  Cell cell;
  double sigma = 0.0;      ///< m, standard deviation in the worst direction
  double direction = 0.0;  ///< rad, that direction in the frame of the cells
};

/// The heading of the car is unknown: beams in all directions, each counted by the field of view.
std::vector<Place> evaluate(const Options& o, const LocalizerParameters& parameters,
                            const LocalizationMap& map) {
  const int step =
      std::max(1, static_cast<int>(std::lround(o.spacing / map.grid.geometry().resolution)));
  const int beams = parameters.scan.num_beams_per_particle;
  Eigen::ArrayXf bearings(beams);
  for (int k = 0; k < beams; ++k)
    bearings[k] = static_cast<float>(2.0 * kPi * (k + 0.5) / beams - kPi);
  const LikelihoodField& field = map.likelihood_field ? *map.likelihood_field : map.matcher.field();
  std::vector<Place> places;
  for (const Cell& cell : map.free_cells.cells()) {
    if (cell.column % step != step / 2 || cell.row % step != step / 2) continue;
    const Eigen::Vector2d point = cellCentre(map.grid.geometry(), cell);
    const Eigen::Matrix3d information =
        o.field_of_view / 360.0 *
        expectedInformation(map.view(), field, {point.x(), point.y(), 0.0}, bearings);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(
        Eigen::Matrix2d(covarianceOf(information).topLeftCorner<2, 2>()));
    const Eigen::Vector2d worst = axes.eigenvectors().col(1);
    places.push_back({cell, std::sqrt(axes.eigenvalues()[1]),
                      std::atan2(worst.y(), worst.x()) - map.grid.geometry().origin.yaw});
  }
  return places;
}

// BGR, from well localized to blind.
struct Level {
  double sigma;  // m, upper limit
  cv::Vec3b colour;
};

std::vector<Level> levelsOf(double blind) {
  return {{0.25 * blind, {150, 200, 120}},
          {0.5 * blind, {140, 225, 215}},
          {blind, {100, 190, 255}},
          {std::numeric_limits<double>::infinity(), {80, 80, 220}}};
}

cv::Mat draw(const Options& o, const OccupancyGrid& grid, const std::vector<Place>& places) {
  const GridGeometry& geometry = grid.geometry();
  cv::Mat cells(geometry.height, geometry.width, CV_8UC3);
  for (int row = 0; row < geometry.height; ++row) {
    for (int column = 0; column < geometry.width; ++column) {
      const bool is_free = grid.isFree({column, row});
      cells.at<cv::Vec3b>(geometry.height - 1 - row, column) =
          is_free ? cv::Vec3b::all(255) : cv::Vec3b::all(grid.at({column, row}) > 0 ? 40 : 205);
    }
  }
  const std::vector<Level> levels = levelsOf(o.blind);
  const int half = std::max(1, static_cast<int>(std::lround(o.spacing / geometry.resolution))) / 2;
  for (const Place& place : places) {
    const auto level = std::find_if(levels.begin(), levels.end(),
                                    [&](const Level& l) { return place.sigma <= l.sigma; });
    for (int row = place.cell.row - half; row <= place.cell.row + half; ++row) {
      for (int column = place.cell.column - half; column <= place.cell.column + half; ++column) {
        if (!contains(geometry, {column, row}) || !grid.isFree({column, row})) continue;
        cells.at<cv::Vec3b>(geometry.height - 1 - row, column) = level->colour;
      }
    }
  }
  const int scale = magnificationOf(cells.size());
  cv::Mat picture;
  cv::resize(cells, picture, {}, scale, scale, cv::INTER_NEAREST);
  const double length = 0.5 * o.spacing / geometry.resolution * scale;
  for (const Place& place : places) {
    if (place.sigma <= o.blind) continue;
    const cv::Point2d centre((place.cell.column + 0.5) * scale,
                             (geometry.height - place.cell.row - 0.5) * scale);
    const cv::Point2d reach(length * std::cos(place.direction),
                            -length * std::sin(place.direction));
    cv::line(picture, centre - reach, centre + reach, cv::Scalar(30, 30, 90), 1, cv::LINE_AA);
  }
  std::vector<std::pair<cv::Vec3b, std::string>> entries;
  for (const Level& level : levels) {
    std::ostringstream name;
    name << std::setprecision(3);
    if (std::isfinite(level.sigma)) {
      name << "to " << 100.0 * level.sigma << " cm";
    } else {
      name << "blind";
    }
    entries.emplace_back(level.colour, name.str());
  }
  return withLegend(picture, drawLegend(entries, picture.cols));
}

void print(const Options& o, const std::vector<Place>& places) {
  std::vector<double> sigmas;
  sigmas.reserve(places.size());
  for (const Place& place : places) sigmas.push_back(place.sigma);
  std::sort(sigmas.begin(), sigmas.end());
  const auto quantile = [&](double share) {
    return 100.0 * sigmas[static_cast<std::size_t>(share * static_cast<double>(sigmas.size() - 1))];
  };
  const auto blind =
      std::count_if(sigmas.begin(), sigmas.end(), [&](double sigma) { return sigma > o.blind; });
  std::cout << std::fixed << std::setprecision(1)
            << "position error of one scan, worst direction: median " << quantile(0.5)
            << " cm, 95 % " << quantile(0.95) << " cm, worst " << quantile(1.0)
            << " cm\nblind (over " << 100.0 * o.blind
            << " cm): " << 100.0 * static_cast<double>(blind) / static_cast<double>(places.size())
            << " % of " << places.size() << " places\n";
}

void run(const Options& o) {
  requireWithin("--spacing", o.spacing, 0.01, 100.0, "m");
  requirePositive("--blind", o.blind, "m");
  std::vector<std::string> inputs = mapFiles(o.map);
  inputs.push_back(o.parameters.config);
  requireSeparateFiles({o.out}, inputs);
  requireWithin("--field-of-view", o.field_of_view, 1.0, 360.0, "degrees");
  const LocalizerParameters parameters = readParameters(o.parameters);
  const auto map = makeLocalizationMap(loadMap(o.map), parameters);
  const std::vector<Place> places = evaluate(o, parameters, *map);
  if (places.empty()) {
    throw MapError(
        o.map +
        ": no free place at this --spacing; expected one below the width of the free space");
  }
  print(o, places);
  if (!o.out.empty()) writeImage(draw(o, map->grid, places), o.out);
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram(
      argc, argv, "localizability",
      "Computes how well one scan determines the position everywhere on a "
      "map; with --out draws it. Blind places, such as long corridors "
      "without doors, are marked by a line in the direction that the "
      "scans do not determine.",
      racecar_mcl::addOptions, racecar_mcl::run);
}
