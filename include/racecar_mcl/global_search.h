// Where on the whole map a scan fits: the poses a global start and a recovery begin from.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "racecar_mcl/likelihood_field.h"
#include "racecar_mcl/occupancy_grid.h"
#include "racecar_mcl/particles.h"
#include "racecar_mcl/random.h"
#include "racecar_mcl/scan.h"

namespace racecar_mcl {

struct GlobalSearchParameters {
  double search_spacing = 0.2;       ///< m, between the positions of the lattice
  double search_yaw_spacing = 0.06;  ///< rad, between its directions
  int search_beams = 60;             ///< compared with the whole lattice
  double search_max_range = 30.0;    ///< m, longer beams are not compared
  int search_poses = 20000000;       ///< at most; on a larger map the lattice is wider
};

/// Throws ParameterError on a value out of range.
void validate(const GlobalSearchParameters& parameters);

/// The likelihood field that tells places apart: wider than one that measures a pose to the
/// centimetre, and content with a beam that ends anywhere within a blurred wall.
LikelihoodFieldParameters fieldOfPlaces(const GlobalSearchParameters& parameters);

/// A lattice of poses over the free cells of a map, compared with a scan from coarse to fine.
///
/// For one direction of the car, the end points of a scan are the same offsets from every position.
/// So whole rows of positions are scored at once by adding rows of a field that is as coarse as the
/// lattice: 60 beams from ten million poses take a few hundred million additions of neighbours.
class GlobalSearch {
 public:
  GlobalSearch(const OccupancyGrid& grid, const GlobalSearchParameters& parameters);
  /// The same, with what freeCells and findSurfaces gave of the grid.
  GlobalSearch(const GridGeometry& geometry, const std::vector<Cell>& free_cells,
               const Surfaces& surfaces, const GlobalSearchParameters& parameters);

  /// `count` poses of the car, equally likely, from where it could have seen the scan. They are
  /// drawn from the lattice by how well they fit, jittered within its cells, and drawn again by the
  /// field of places. Both draws are tempered, so that thousands of lattice cells matter in the
  /// first and a tenth of the poses in the second: the place that fits best at first sight is often
  /// the wrong one.
  ParticleSet candidates(const Scan& beams, Eigen::Index count, Random& random) const;

  /// Made by fieldOfPlaces.
  const LikelihoodField& field() const { return field_; }
  /// Of the lattice.
  std::size_t poses() const { return positions_.size() * static_cast<std::size_t>(directions_); }
  double spacing() const { return stride_ * map_.resolution; }
  std::size_t memoryBytes() const;

 private:
  /// Neighbouring cells of one row of the lattice that hold free space.
  struct Run {
    Cell first;
    int count;
  };

  void layLattice(const std::vector<Cell>& free_cells);
  void buildCoarseField(const std::vector<float>& surface_distances);
  std::vector<std::ptrdiff_t> endOffsets(const Scan& beams, double yaw_in_grid) const;
  Eigen::ArrayXf coarseScores(const Scan& beams) const;
  ParticleSet bestOfLattice(const Eigen::ArrayXf& scores) const;

  double yawOf(long direction) const {
    return 2.0 * kPi * static_cast<double>(direction) / static_cast<double>(directions_);
  }
  std::size_t coarseIndex(const Cell& cell) const {
    return static_cast<std::size_t>(cell.row + margin_) * static_cast<std::size_t>(padded_width_) +
           static_cast<std::size_t>(cell.column + margin_);
  }

  GlobalSearchParameters parameters_;
  LikelihoodField field_;
  GridGeometry map_;
  long directions_;
  int stride_ = 1;                   ///< map cells per lattice cell
  int width_ = 0;                    ///< of the lattice
  int height_ = 0;                   ///< of the lattice
  int margin_ = 0;                   ///< lattice cells around the map, as far as ends matter
  int padded_width_ = 0;             ///< of the coarse field
  std::vector<float> coarse_field_;  ///< row by row, a value per lattice cell, margins included
  std::vector<Run> runs_;
  std::vector<Cell> positions_;  ///< in the order of the runs
};

}  // namespace racecar_mcl
