// Correlative scan matcher over the whole map (Olson 2009): candidate poses for global starts and
// recoveries.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "racecar_mcl/common/random.h"
#include "racecar_mcl/geometry/particle_set.h"
#include "racecar_mcl/map/cell_runs.h"
#include "racecar_mcl/map/occupancy_grid.h"
#include "racecar_mcl/map/surfaces.h"
#include "racecar_mcl/scan/scan.h"
#include "racecar_mcl/sensor/likelihood_field.h"

namespace racecar_mcl {

struct GlobalScanMatcherParameters {
  double search_spacing = 0.2;       ///< m, between positions of the lattice
  double search_yaw_spacing = 0.06;  ///< rad, between directions of the lattice
  int search_beams = 60;             ///< beams evaluated at every pose of the lattice
  double search_max_range = 30.0;    ///< m, longer beams are not used
  int search_poses = 20000000;       ///< maximum; the lattice of larger maps gets a wider spacing
  double likelihood_exponent = 37.0 / 240.0;  ///< of the coarse field
};

/// Throws ParameterError on a value out of range.
void validate(const GlobalScanMatcherParameters& parameters);

/// The likelihood field of the global search: wider than that for tracking, and with the full
/// likelihood anywhere inside a blurred wall (up to 2.6 m from a visible surface).
LikelihoodFieldParameters coarseFieldParameters(const GlobalScanMatcherParameters& parameters);

/// Evaluates a scan at a lattice of poses over the free cells of a map, from coarse to fine.
///
/// For one direction of the car, the end points of a scan have the same offsets from every
/// position. Rows of positions are therefore scored by adding rows of a likelihood field with the
/// resolution of the lattice: 60 beams at ten million poses take a few hundred million contiguous
/// additions.
class GlobalScanMatcher {
 public:
  GlobalScanMatcher(const OccupancyGrid& grid, const GlobalScanMatcherParameters& parameters);
  /// The same, with the results of freeCells and findSurfaces for the grid.
  GlobalScanMatcher(const GridGeometry& geometry, const CellRuns& free_cells,
                    const Surfaces& surfaces, const GlobalScanMatcherParameters& parameters);

  /// `count` poses of the car (base in map), with equal weights, drawn from the likelihood of the
  /// scan. They are drawn from the lattice by their coarse scores, jittered within its cells, and
  /// drawn again by the likelihood of `field`. Both draws are tempered, to 3000 effective lattice
  /// poses and to a tenth of the poses drawn, since the best match of a single scan is often a
  /// wrong place.
  ParticleSet candidates(const Scan& beams, Eigen::Index count, Random& random) const;

  /// The likelihood field with coarseFieldParameters.
  const LikelihoodField& field() const { return field_; }
  /// Number of lattice poses.
  std::size_t poses() const { return positions_.size() * static_cast<std::size_t>(directions_); }
  /// Between positions of the lattice, m.
  double spacing() const { return stride_ * map_.resolution; }
  std::size_t memoryBytes() const;

 private:
  void buildLattice(const CellRuns& free_cells);
  void buildCoarseField(const Surfaces& surfaces);
  std::vector<std::ptrdiff_t> endPointOffsets(const Scan& beams, double yaw_in_grid) const;
  Eigen::ArrayXf coarseScores(const Scan& beams) const;
  ParticleSet bestPoses(const Eigen::ArrayXf& scores) const;

  double yawOf(long direction) const {
    return 2.0 * kPi * static_cast<double>(direction) / static_cast<double>(directions_);
  }
  std::size_t coarseIndex(const Cell& cell) const {
    return static_cast<std::size_t>(cell.row + margin_) * static_cast<std::size_t>(padded_width_) +
           static_cast<std::size_t>(cell.column + margin_);
  }

  GlobalScanMatcherParameters parameters_;
  LikelihoodField field_;
  GridGeometry map_;
  long directions_;
  int stride_ = 1;                   ///< map cells per lattice cell
  int width_ = 0;                    ///< of the lattice, cells
  int height_ = 0;                   ///< of the lattice, cells
  int margin_ = 0;                   ///< lattice cells around the map in the coarse field
  int padded_width_ = 0;             ///< of the coarse field, cells
  std::vector<float> coarse_field_;  ///< row by row, one value per lattice cell, margins included
  CellRuns positions_;               ///< cells of the lattice with free space
};

}  // namespace racecar_mcl
