// Construction of the global scan matcher: lattice of poses and coarse likelihood field.
#include <algorithm>
#include <cmath>
#include <functional>

#include "map/distance_transform.h"
#include "racecar_mcl/common/validation.h"
#include "racecar_mcl/relocalization/global_scan_matcher.h"

namespace racecar_mcl {
namespace {

// Fraction of beams that end anywhere, in the coarse field. Its scale is one lattice spacing, the
// discretization error of the lattice.
constexpr double kCoarseRandRatio = 0.1;

}  // namespace

void validate(const GlobalScanMatcherParameters& p) {
  requireWithin("search_spacing", p.search_spacing, 0.01, 10.0, "m");
  requireWithin("search_yaw_spacing", p.search_yaw_spacing, 0.001, 1.0, "rad");
  requireWithin("search_beams", p.search_beams, 1, 10000);
  requirePositiveUpTo("search_max_range", p.search_max_range, 1000.0, "m");
  requireWithin("search_poses", p.search_poses, 100000, 1000000000);
}

LikelihoodFieldParameters coarseFieldParameters(const GlobalScanMatcherParameters& parameters) {
  LikelihoodFieldParameters field;
  field.field_scale = 0.12;  // m
  field.z_rand = 0.05;
  field.field_max_range = parameters.search_max_range;
  field.likelihood_exponent = parameters.likelihood_exponent;
  field.inside_wall_factor = 0.0;
  return field;
}

GlobalScanMatcher::GlobalScanMatcher(const OccupancyGrid& grid,
                                     const GlobalScanMatcherParameters& parameters)
    : GlobalScanMatcher(grid.geometry(), freeCells(grid), findSurfaces(grid), parameters) {}

GlobalScanMatcher::GlobalScanMatcher(const GridGeometry& geometry, const CellRuns& free_cells,
                                     const Surfaces& surfaces,
                                     const GlobalScanMatcherParameters& parameters)
    : parameters_((validate(parameters), parameters)),
      field_(geometry, surfaces, coarseFieldParameters(parameters)),
      map_(geometry),
      directions_(std::max(1L, std::lround(2.0 * kPi / parameters.search_yaw_spacing))) {
  buildLattice(free_cells);
  buildCoarseField(surfaces);
}

void GlobalScanMatcher::buildLattice(const CellRuns& free_cells) {
  std::vector<char> free;
  stride_ =
      std::max(1, static_cast<int>(std::lround(parameters_.search_spacing / map_.resolution)));
  for (;; stride_ *= 2) {
    width_ = (map_.width + stride_ - 1) / stride_;
    height_ = (map_.height + stride_ - 1) / stride_;
    free.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0);
    for (const CellRuns::Run& run : free_cells.runs()) {
      char* const row = free.data() + static_cast<std::ptrdiff_t>(run.first.row / stride_) * width_;
      const int last = run.first.column + run.count - 1;
      std::fill(row + run.first.column / stride_, row + last / stride_ + 1, 1);
    }
    const auto positions = std::count(free.begin(), free.end(), 1);
    if (positions * directions_ <= parameters_.search_poses || positions <= 1) break;
  }
  std::size_t i = 0;
  for (int row = 0; row < height_; ++row) {
    for (int column = 0; column < width_; ++column, ++i) {
      if (free[i] != 0) positions_.add({column, row});
    }
  }
}

void GlobalScanMatcher::buildCoarseField(const Surfaces& surfaces) {
  // End points are clamped to the margin, where the field is constant: at most the size of the map.
  margin_ = static_cast<int>(std::min(std::ceil(parameters_.search_max_range / spacing()) + 1.0,
                                      static_cast<double>(std::max(width_, height_))));
  padded_width_ = width_ + 2 * margin_;
  const auto size =
      static_cast<std::size_t>(padded_width_) * static_cast<std::size_t>(height_ + 2 * margin_);
  coarse_field_.assign(size, static_cast<float>(std::log(kCoarseRandRatio)));
  std::vector<std::uint8_t> occupied(surfaces.visible.size());
  std::transform(surfaces.visible.begin(), surfaces.visible.end(), surfaces.blurred.begin(),
                 occupied.begin(), std::bit_or<std::uint8_t>());
  const auto middleOf = [this](int lattice, int map_size) {
    return std::min(lattice * stride_ + stride_ / 2, map_size - 1);
  };
  std::vector<int> rows;
  rows.reserve(static_cast<std::size_t>(height_));
  for (int row = 0; row < height_; ++row) rows.push_back(middleOf(row, map_.height));
  const auto fillRow = [&](const DistanceTransform::Row& row) {
    float* const values = &coarse_field_[coarseIndex({0, row.row / stride_})];
    for (int column = 0; column < width_; ++column) {
      const double spacings =
          static_cast<double>(row.distance(middleOf(column, map_.width))) / stride_;
      values[column] = static_cast<float>(
          std::log((1.0 - kCoarseRandRatio) / (1.0 + spacings * spacings) + kCoarseRandRatio));
    }
  };
  DistanceTransform(occupied, map_.width, map_.height).forRows(rows, fillRow);
}

std::size_t GlobalScanMatcher::memoryBytes() const {
  return field_.memoryBytes() + coarse_field_.size() * sizeof(float) + positions_.memoryBytes();
}

}  // namespace racecar_mcl
