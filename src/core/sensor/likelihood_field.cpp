#include "racecar_mcl/sensor/likelihood_field.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "map/cell_window.h"
#include "map/distance_transform.h"
#include "racecar_mcl/common/validation.h"

namespace racecar_mcl {
namespace {

// Margin of the field around the map, since a wall may be at the edge of the map.
constexpr double kMarginScales = 4.0;  // in field_scale
constexpr double kMaxMargin = 200.0;   // cells
// Cells at the edge of the field that have the value of the outside; the second one is the right or
// upper neighbour of the first.
constexpr int kEdge = 2;
// Maximum distance of a cell in a blurred wall from a visible surface.
constexpr double kMaxBlurredDepth = 2.0 * kMaxBlurredThickness;
constexpr int kSteps = 255;  // of the stored values

/// The cells of the map, with `margin` cells around it, that are at most `reach` cells from the
/// columns and rows of a window.
CellWindow extended(CellWindow set, const GridGeometry& geometry, int margin, int reach) {
  if (set.empty()) set = {0, 0, 1, 1};
  return {std::max(set.left - reach, -margin), std::max(set.bottom - reach, -margin),
          std::min(set.right + reach, geometry.width + margin),
          std::min(set.top + reach, geometry.height + margin)};
}

}  // namespace

void validate(const LikelihoodFieldParameters& p) {
  requireWithin("field_scale", p.field_scale, 1e-3, 1e3, "m");
  require(p.z_rand > 0.0 && p.z_rand < 1.0, "z_rand", p.z_rand, "above 0 and below 1");
  requirePositiveUpTo("field_max_range", p.field_max_range, 1e4, "m");
  requireWithin("likelihood_exponent", p.likelihood_exponent, 1e-5, 1e3);
  requireShare("inside_wall_factor", p.inside_wall_factor);
  requireShare("unmapped_likelihood", p.unmapped_likelihood);
}

LikelihoodField::LikelihoodField(const OccupancyGrid& grid,
                                 const LikelihoodFieldParameters& parameters)
    : LikelihoodField(grid.geometry(), findSurfaces(grid), parameters) {}

LikelihoodField::LikelihoodField(const GridGeometry& geometry, const Surfaces& surfaces,
                                 const LikelihoodFieldParameters& parameters)
    : LikelihoodField(geometry, surfaces, {}, parameters) {}

LikelihoodField::LikelihoodField(const GridGeometry& geometry, const Surfaces& surfaces,
                                 const std::vector<std::uint8_t>& unmapped,
                                 const LikelihoodFieldParameters& parameters)
    : parameters_((validate(parameters), parameters)),
      geometry_(geometry),
      max_range_(static_cast<float>(parameters.field_max_range)),
      exponent_(static_cast<float>(parameters.likelihood_exponent)),
      log_rand_(static_cast<float>(std::log(parameters.z_rand))),
      log_step_(static_cast<float>(-std::log(parameters.z_rand) / kSteps)) {
  // limits[n]: squared distance, in cells, up to which a value is at least n steps above the
  // outside.
  std::array<double, kSteps + 1> limits;
  const double log_rand = std::log(parameters.z_rand);
  for (int steps = 0; steps <= kSteps; ++steps) {
    const double value = log_rand + (steps - 0.5) * static_cast<double>(log_step_);
    const double cells = distanceOf(value) / geometry.resolution;
    limits[static_cast<std::size_t>(steps)] = cells * cells;
  }
  const double blurred_reach = std::min(kMaxBlurredDepth / geometry.resolution,
                                        std::sqrt(limits[1]) / parameters.inside_wall_factor);
  const int reach = wholeCells(std::max(std::sqrt(limits[1]), blurred_reach));
  const int margin = wholeCells(
      std::min(kMarginScales * parameters.field_scale / geometry.resolution, kMaxMargin));
  CellWindow set = windowOfSet(surfaces.visible, geometry);
  if (!unmapped.empty()) set = hull(set, windowOfSet(unmapped, geometry));
  const CellWindow window = extended(set, geometry, kEdge + margin, kEdge + reach);
  geometry_ = geometryOf(window, geometry);
  const std::vector<std::uint8_t> blurred = cut(surfaces.blurred, geometry, window);
  cells_.assign(blurred.size(), 0);
  const DistanceTransform distances(cut(surfaces.visible, geometry, window), window.width(),
                                    window.height(), reach);
  distances.forEachRow([&](const DistanceTransform::Row& row) {
    if (row.row < kEdge || row.row >= window.height() - kEdge) return;
    std::size_t steps = 0;
    for (int column = kEdge; column < window.width() - kEdge; ++column) {
      if (row.squared[column] == DistanceTransform::kFar) continue;
      const std::size_t cell = row.first + static_cast<std::size_t>(column);
      const double factor = blurred[cell] != 0 ? parameters.inside_wall_factor : 1.0;
      const double distance = factor * factor * row.squared[column];
      while (steps > 0 && distance > limits[steps]) --steps;
      while (steps < kSteps && distance <= limits[steps + 1]) ++steps;
      cells_[cell] = static_cast<std::uint16_t>(steps);
    }
  });
  if (!unmapped.empty()) {
    const double likelihood = std::max(parameters.unmapped_likelihood, parameters.z_rand);
    const auto steps =
        static_cast<std::uint16_t>(std::lround((std::log(likelihood) - log_rand) / log_step_));
    const std::vector<std::uint8_t> inside = cut(unmapped, geometry, window);
    for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
      if (inside[cell] != 0) cells_[cell] = std::max(cells_[cell], steps);
    }
  }
  const auto width = static_cast<std::size_t>(window.width());
  for (std::size_t cell = 0; cell + width < cells_.size(); ++cell) {
    const auto above = static_cast<unsigned>(cells_[cell + width]) & 0xffU;
    cells_[cell] = static_cast<std::uint16_t>(cells_[cell] | above << 8U);
  }
}

double LikelihoodField::logLikelihoodAt(double distance) const {
  const double scaled = distance / parameters_.field_scale;
  return std::log((1.0 - parameters_.z_rand) / (1.0 + scaled * scaled) + parameters_.z_rand);
}

double LikelihoodField::distanceOf(double log_likelihood) const {
  const double above_rand = std::exp(log_likelihood) - parameters_.z_rand;
  const double ratio = (1.0 - parameters_.z_rand) / std::max(1e-12, above_rand);
  return parameters_.field_scale * std::sqrt(std::max(0.0, ratio - 1.0));
}

}  // namespace racecar_mcl
