// Changes between a map and what a drive saw, and the map with the changes applied.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "map_changes/cell_evidence.h"
#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl {

enum class CellChange : std::uint8_t {
  kNotSeen,    ///< by too few views
  kUnclear,    ///< views contradict each other, as at moving obstacles
  kConfirmed,  ///< as the map says
  kNew,        ///< occupied, but free or unknown in the map
  kGone,       ///< free, but occupied in the map
  kExplored,   ///< free, but unknown in the map
};

/// "not seen", "unclear", "confirmed", "new", "gone" or "explored".
std::string toString(CellChange change);

/// The values were chosen on simulated drives (bench/2026-11-29-map-changes.md).
struct MapChangeParameters {
  std::uint32_t min_views = 4;         ///< of a changed cell, from different places
  double min_seconds = 1.5;            ///< s, between the first and the last end in a new cell
  double min_agreement = 0.8;          ///< fraction of the views of a cell that agree
  std::uint32_t max_passed_after = 1;  ///< views through a new cell after the last end in it
  int min_region_cells = 4;            ///< smaller regions are unclear
  std::uint32_t min_region_views = 7;  ///< of the cell of a region with the most views
};

/// Changed cells of one kind, kNew or kGone, at most one other cell apart.
struct ChangedRegion {
  CellChange kind = CellChange::kNew;
  Eigen::Vector2d centre_in_map = Eigen::Vector2d::Zero();  ///< m, mean of the cells' centres
  Eigen::Vector2d size = Eigen::Vector2d::Zero();  ///< m, along the grid's columns and rows
  int cells = 0;
  std::uint32_t views = 0;  ///< maximum over the cells of the views that agree
};

struct MapChanges {
  std::vector<CellChange> cells;       ///< row-major like the cells of the grid
  std::vector<ChangedRegion> regions;  ///< largest first

  std::size_t count(CellChange change) const;
};

/// `evidence`: about the cells of this grid.
MapChanges findChanges(const OccupancyGrid& grid, const CellEvidence& evidence,
                       const MapChangeParameters& parameters = {});

/// The map with new cells occupied, and gone and explored ones free.
OccupancyGrid applyChanges(const OccupancyGrid& grid, const MapChanges& changes);

}  // namespace racecar_mcl
