#include "racecar_mcl/sensor/likelihood_field.h"

#include <algorithm>
#include <cmath>

#include "racecar_mcl/common/validation.h"
#include "racecar_mcl/map/distance_field.h"

namespace racecar_mcl {
namespace {

// Margin of the field around the map, since a wall may be at the edge of the map.
constexpr double kMarginScales = 4.0;  // in field_scale
constexpr double kMaxMargin = 200.0;   // cells
// Cells at the edge of the field that have the value of the outside; the second one is the right or
// upper neighbour of the first.
constexpr int kEdge = 2;
constexpr double kSteps = 255.0;  // of the stored values

/// A mask with a margin of zeros, row by row.
std::vector<std::uint8_t> withMargin(const std::vector<std::uint8_t>& mask,
                                     const GridGeometry& geometry, int margin) {
  const auto width = static_cast<std::size_t>(geometry.width);
  const std::size_t padded_width = width + 2 * static_cast<std::size_t>(margin);
  std::vector<std::uint8_t> padded(
      padded_width * static_cast<std::size_t>(geometry.height + 2 * margin), 0);
  for (int row = 0; row < geometry.height; ++row) {
    std::copy_n(
        mask.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(row) * width), width,
        padded.begin() +
            static_cast<std::ptrdiff_t>(static_cast<std::size_t>(row + margin) * padded_width) +
            margin);
  }
  return padded;
}

}  // namespace

void validate(const LikelihoodFieldParameters& p) {
  requireWithin("field_scale", p.field_scale, 1e-3, 1e3, "m");
  require(p.z_rand > 0.0 && p.z_rand < 1.0, "z_rand", p.z_rand, "above 0 and below 1");
  requirePositiveUpTo("field_max_range", p.field_max_range, 1e4, "m");
  requireWithin("likelihood_exponent", p.likelihood_exponent, 1e-5, 1e3);
  requireShare("inside_wall_factor", p.inside_wall_factor);
}

LikelihoodField::LikelihoodField(const OccupancyGrid& grid,
                                 const LikelihoodFieldParameters& parameters)
    : LikelihoodField(grid.geometry(), findSurfaces(grid), parameters) {}

LikelihoodField::LikelihoodField(const GridGeometry& geometry, const Surfaces& surfaces,
                                 const LikelihoodFieldParameters& parameters)
    : parameters_((validate(parameters), parameters)),
      geometry_(geometry),
      max_range_(static_cast<float>(parameters.field_max_range)),
      exponent_(static_cast<float>(parameters.likelihood_exponent)),
      log_rand_(static_cast<float>(std::log(parameters.z_rand))),
      log_step_(static_cast<float>(-std::log(parameters.z_rand) / kSteps)) {
  const double cells_per_scale = parameters.field_scale / geometry_.resolution;
  const int margin =
      kEdge + static_cast<int>(std::ceil(std::min(kMarginScales * cells_per_scale, kMaxMargin)));
  const double shift = -margin * geometry_.resolution;
  geometry_.origin = compose(geometry_.origin, {shift, shift, 0.0});
  geometry_.width += 2 * margin;
  geometry_.height += 2 * margin;
  const std::vector<float> distances = obstacleDistances(
      withMargin(surfaces.visible, geometry, margin), geometry_.width, geometry_.height);
  const std::vector<std::uint8_t> blurred = withMargin(surfaces.blurred, geometry, margin);
  cells_.assign(distances.size(), 0);
  const double log_rand = std::log(parameters.z_rand);
  // Beyond it the values round to that of the outside.
  const double reach = distanceOf(log_rand + 0.5 * static_cast<double>(log_step_));
  const auto width = static_cast<std::size_t>(geometry_.width);
  for (int row = kEdge; row < geometry_.height - kEdge; ++row) {
    for (int column = kEdge; column < geometry_.width - kEdge; ++column) {
      const std::size_t cell =
          static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column);
      const double factor = blurred[cell] != 0 ? parameters.inside_wall_factor : 1.0;
      const double distance = factor * static_cast<double>(distances[cell]) * geometry_.resolution;
      if (!(distance < reach)) continue;
      const double above_rand = logLikelihoodAt(distance) - log_rand;
      const auto steps =
          static_cast<unsigned>(std::lround(above_rand / static_cast<double>(log_step_)));
      cells_[cell] = static_cast<std::uint16_t>(cells_[cell] | steps);
      cells_[cell - width] = static_cast<std::uint16_t>(cells_[cell - width] | steps << 8U);
    }
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
