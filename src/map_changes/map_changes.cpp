#include "map_changes/map_changes.h"

#include <algorithm>
#include <utility>

namespace racecar_mcl {
namespace {

constexpr int kMaxStep = 2;  // cells, between neighbours of a region

bool agree(std::uint32_t views, std::uint32_t others, const MapChangeParameters& p) {
  return views >= p.min_views && views >= p.min_agreement * (views + others);
}

bool isPassable(const CellViews& cell, const MapChangeParameters& p) {
  return agree(cell.passed, cell.ended_near, p);
}

CellChange classifyObstacle(const CellViews& cell, const MapChangeParameters& p) {
  if (isPassable(cell, p)) return CellChange::kGone;
  return agree(cell.ended_near, cell.passed, p) ? CellChange::kConfirmed : CellChange::kUnclear;
}

CellChange classifyOther(std::int8_t value, const CellViews& cell, const MapChangeParameters& p) {
  if (agree(cell.ended, cell.passed, p) && cell.last_end - cell.first_end >= p.min_seconds &&
      cell.passed_after <= p.max_passed_after) {
    return CellChange::kNew;
  }
  if (!isPassable(cell, p)) return CellChange::kUnclear;
  return value < 0 ? CellChange::kExplored : CellChange::kConfirmed;
}

CellChange classify(std::int8_t value, const CellViews& cell, const MapChangeParameters& p) {
  if (cell.ended_near + cell.passed < p.min_views) return CellChange::kNotSeen;
  return value >= OccupancyGrid::kObstacleFrom ? classifyObstacle(cell, p)
                                               : classifyOther(value, cell, p);
}

/// Takes the cells of one region out of `open`, from `seed` on.
std::vector<std::size_t> takeRegion(const GridGeometry& geometry,
                                    const std::vector<CellChange>& changes, std::size_t seed,
                                    std::vector<bool>* open) {
  const CellIndex index(geometry);
  std::vector<std::size_t> region{seed};
  (*open)[seed] = false;
  for (std::size_t next = 0; next < region.size(); ++next) {
    const Cell at = index.cell(region[next]);
    for (int row = at.row - kMaxStep; row <= at.row + kMaxStep; ++row) {
      for (int column = at.column - kMaxStep; column <= at.column + kMaxStep; ++column) {
        if (!contains(geometry, {column, row})) continue;
        const std::size_t i = index({column, row});
        if (!(*open)[i] || changes[i] != changes[seed]) continue;
        (*open)[i] = false;
        region.push_back(i);
      }
    }
  }
  return region;
}

ChangedRegion describe(const GridGeometry& geometry, CellChange kind,
                       const std::vector<std::size_t>& cells,
                       const std::vector<CellViews>& evidence) {
  ChangedRegion region;
  region.kind = kind;
  region.cells = static_cast<int>(cells.size());
  Eigen::Array2i low(geometry.width, geometry.height), high(-1, -1);
  for (const std::size_t i : cells) {
    const Cell cell = CellIndex(geometry).cell(i);
    low = low.min(Eigen::Array2i(cell.column, cell.row));
    high = high.max(Eigen::Array2i(cell.column, cell.row));
    region.centre_in_map += cellCentre(geometry, cell) / static_cast<double>(cells.size());
    region.views =
        std::max(region.views, kind == CellChange::kNew ? evidence[i].ended : evidence[i].passed);
  }
  region.size = (high - low + 1).cast<double>() * geometry.resolution;
  return region;
}

}  // namespace

std::string toString(CellChange change) {
  switch (change) {
    case CellChange::kNotSeen:
      return "not seen";
    case CellChange::kUnclear:
      return "unclear";
    case CellChange::kConfirmed:
      return "confirmed";
    case CellChange::kNew:
      return "new";
    case CellChange::kGone:
      return "gone";
    case CellChange::kExplored:
      return "explored";
  }
  return "";
}

std::size_t MapChanges::count(CellChange change) const {
  return static_cast<std::size_t>(std::count(cells.begin(), cells.end(), change));
}

MapChanges findChanges(const OccupancyGrid& grid, const CellEvidence& evidence,
                       const MapChangeParameters& parameters) {
  MapChanges changes;
  changes.cells.resize(grid.cells().size());
  std::vector<bool> open(grid.cells().size());
  for (std::size_t i = 0; i < changes.cells.size(); ++i) {
    changes.cells[i] = classify(grid.cells()[i], evidence.cells()[i], parameters);
    open[i] = changes.cells[i] == CellChange::kNew || changes.cells[i] == CellChange::kGone;
  }
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (!open[i]) continue;
    const CellChange kind = changes.cells[i];
    const std::vector<std::size_t> cells = takeRegion(grid.geometry(), changes.cells, i, &open);
    const ChangedRegion region = describe(grid.geometry(), kind, cells, evidence.cells());
    if (region.cells >= parameters.min_region_cells &&
        region.views >= parameters.min_region_views) {
      changes.regions.push_back(region);
    } else {
      for (const std::size_t cell : cells) changes.cells[cell] = CellChange::kUnclear;
    }
  }
  std::stable_sort(
      changes.regions.begin(), changes.regions.end(),
      [](const ChangedRegion& a, const ChangedRegion& b) { return a.cells > b.cells; });
  return changes;
}

OccupancyGrid applyChanges(const OccupancyGrid& grid, const MapChanges& changes) {
  std::vector<std::int8_t> cells = grid.cells();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellChange change = changes.cells[i];
    if (change == CellChange::kNew) cells[i] = OccupancyGrid::kOccupied;
    if (change == CellChange::kGone || change == CellChange::kExplored) {
      cells[i] = OccupancyGrid::kFree;
    }
  }
  return OccupancyGrid(grid.geometry(), std::move(cells));
}

}  // namespace racecar_mcl
