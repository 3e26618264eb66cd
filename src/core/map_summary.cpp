#include "racecar_mcl/map_summary.h"

#include <algorithm>
#include <iomanip>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <utility>

namespace racecar_mcl {
namespace {

constexpr double kSmallestArea = 0.5;  // m^2, of a free area that counts
constexpr double kRoom = 0.5;          // m, the side of a square of free space that a car can be in
constexpr double kGreyFrom = 0.01;     // share of the known cells
constexpr double kOutsideFrom = 0.02;  // share of all cells that makes an outside
constexpr double kOneAreaFrom = 0.95;  // share of the largest free area
constexpr double kMuchBlurred = 0.3;   // share of the surface cells
constexpr double kManyOpenings = 0.3;  // share of the border of free space
constexpr double kCoarseFrom = 0.15;   // m per cell

/// Masks over the cells.
struct FreeSpace {
  std::vector<std::uint8_t> free;
  /// The free cells and the unknown specks between them, up to two cells wide.
  std::vector<std::uint8_t> without_specks;
  /// Of these, the cells of squares with the side kRoom. What a lidar saw through a door, between
  /// far beams and through glass is thinner, and has hardly any wall.
  std::vector<std::uint8_t> roomy;
};

std::size_t indexOf(const GridGeometry& geometry, const Cell& cell) {
  return static_cast<std::size_t>(cell.row) * static_cast<std::size_t>(geometry.width) +
         static_cast<std::size_t>(cell.column);
}

FreeSpace findFreeSpace(const OccupancyGrid& grid) {
  const GridGeometry& geometry = grid.geometry();
  const std::size_t size = grid.cells().size();
  FreeSpace space{std::vector<std::uint8_t>(size), std::vector<std::uint8_t>(size),
                  std::vector<std::uint8_t>(size)};
  std::transform(
      grid.cells().begin(), grid.cells().end(), space.free.begin(),
      [](std::int8_t value) { return value >= 0 && value < OccupancyGrid::kObstacleFrom ? 1 : 0; });
  const auto asImage = [&](std::vector<std::uint8_t>* mask) {
    return cv::Mat(geometry.height, geometry.width, CV_8U, mask->data());
  };
  const auto square = [](int side) {
    return cv::getStructuringElement(cv::MORPH_RECT, {side, side});
  };
  const cv::Mat closed = asImage(&space.without_specks);
  cv::morphologyEx(asImage(&space.free), closed, cv::MORPH_CLOSE, square(3));
  for (std::size_t i = 0; i < size; ++i) {
    if (grid.cells()[i] >= 0) space.without_specks[i] = space.free[i];
  }
  // Odd, for the square has a middle; where cells are below 5 mm, smaller for the sake of time.
  const double half = std::min(0.5 * kRoom / geometry.resolution, 50.0);
  cv::morphologyEx(closed, asImage(&space.roomy), cv::MORPH_OPEN,
                   square(2 * static_cast<int>(half) + 1));
  return space;
}

/// What lies beside a free cell: 0 to 4 sides each, the rest is free or a speck.
struct Sides {
  int walls = 0;
  int openings = 0;
};

Sides sidesOf(const OccupancyGrid& grid, const FreeSpace& space, const Cell& cell) {
  constexpr Cell kSteps[] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
  Sides sides;
  for (const Cell& step : kSteps) {
    const Cell beside{cell.column + step.column, cell.row + step.row};
    if (grid.isFree(beside)) continue;
    if (grid.at(beside) >= 0) {
      ++sides.walls;
      continue;
    }
    // One grey cell between white and black is a smoothed wall.
    const Cell beyond{beside.column + step.column, beside.row + step.row};
    if (grid.at(beyond) >= OccupancyGrid::kObstacleFrom) {
      ++sides.walls;
    } else if (!contains(grid.geometry(), beside) ||
               space.without_specks[indexOf(grid.geometry(), beside)] == 0) {
      ++sides.openings;
    }
  }
  return sides;
}

/// Sizes, in cells, of the parts of a mask that no side of a cell connects; takes the mask apart.
std::vector<std::size_t> partsOf(std::vector<std::uint8_t> waiting, std::size_t width) {
  const std::size_t size = waiting.size();
  std::vector<std::size_t> parts, stack;
  const auto visit = [&](std::size_t i) {
    if (waiting[i] == 0) return;
    waiting[i] = 0;
    stack.push_back(i);
    ++parts.back();
  };
  for (std::size_t start = 0; start < size; ++start) {
    if (waiting[start] == 0) continue;
    parts.push_back(0);
    visit(start);
    while (!stack.empty()) {
      const std::size_t i = stack.back();
      stack.pop_back();
      const std::size_t column = i % width;
      if (column > 0) visit(i - 1);
      if (column + 1 < width) visit(i + 1);
      if (i >= width) visit(i - width);
      if (i + width < size) visit(i + width);
    }
  }
  return parts;
}

/// What is counted, in cells and sides of cells.
struct Counts {
  std::size_t free = 0, occupied = 0, unknown = 0, grey = 0;
  std::size_t surface = 0, blurred = 0, blurred_surface = 0, hidden = 0;
  std::size_t border = 0, free_at_border = 0;
  std::size_t wall_sides = 0;                                 ///< of all free cells
  std::size_t roomy_wall_sides = 0, roomy_opening_sides = 0;  ///< of those with room
};

Counts count(const OccupancyGrid& grid, const Surfaces& surfaces, const FreeSpace& space) {
  const GridGeometry& geometry = grid.geometry();
  Counts n;
  std::size_t i = 0;
  for (int row = 0; row < geometry.height; ++row) {
    const bool at_end = row == 0 || row == geometry.height - 1;
    for (int column = 0; column < geometry.width; ++column, ++i) {
      const bool at_border = at_end || column == 0 || column == geometry.width - 1;
      const std::int8_t value = grid.cells()[i];
      if (at_border) ++n.border;
      if (value > OccupancyGrid::kFree && value < OccupancyGrid::kOccupied) ++n.grey;
      if (value < 0) {
        ++n.unknown;
      } else if (value < OccupancyGrid::kObstacleFrom) {
        ++n.free;
        if (at_border) ++n.free_at_border;
        const Sides sides = sidesOf(grid, space, {column, row});
        n.wall_sides += static_cast<std::size_t>(sides.walls);
        if (space.roomy[i] != 0) {
          n.roomy_wall_sides += static_cast<std::size_t>(sides.walls);
          n.roomy_opening_sides += static_cast<std::size_t>(sides.openings);
        }
      } else {
        const bool visible = surfaces.visible[i] != 0, blurred = surfaces.blurred[i] != 0;
        ++n.occupied;
        if (visible) ++n.surface;
        if (blurred) ++n.blurred;
        if (visible && blurred) ++n.blurred_surface;
        if (!visible && !blurred) ++n.hidden;
      }
    }
  }
  return n;
}

/// 0 of nothing.
double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

MapKind kindOf(const Counts& n) {
  const std::size_t cells = n.free + n.occupied + n.unknown;
  if (n.free == 0) return MapKind::kNoFreeCells;
  if (n.occupied == 0) return MapKind::kNoObstacles;
  if (share(n.grey, n.free + n.occupied) >= kGreyFrom) return MapKind::kGrey;
  if (share(n.free_at_border, n.border) > 0.5) return MapKind::kOpen;
  if (share(n.unknown + n.hidden, cells) < kOutsideFrom) return MapKind::kWalls;
  return n.unknown >= n.hidden ? MapKind::kSlam : MapKind::kFilled;
}

std::string percent(double share) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(share < 0.0995 ? 1 : 0) << 100.0 * share << " %";
  return text.str();
}

std::string metres(double length) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(length < 100.0 ? 1 : 0) << length << " m";
  return text.str();
}

std::vector<std::string> warningsOf(const MapSummary& s, const Counts& n) {
  std::vector<std::string> lines;
  if (n.free == 0) {
    lines.push_back(
        "no free cell: a car can be nowhere on it; check the map's negate, free_thresh and mode");
  }
  if (n.occupied == 0) {
    lines.push_back(
        "no obstacle cell: scans fit everywhere; check the map's negate, occupied_thresh and mode");
  }
  if (s.usable() && n.wall_sides == 0) {
    lines.push_back("no obstacle is beside free space: all of them are taken as surfaces");
  }
  if (s.free_areas > 1 && s.largest_free_area < kOneAreaFrom * s.free_area) {
    lines.push_back("free space is in " + std::to_string(s.free_areas) +
                    " separate areas, the largest " + percent(s.largest_free_area / s.free_area) +
                    " of it: a global start searches all of them; paint over where no car can be");
  }
  if (s.kind == MapKind::kOpen) {
    lines.push_back(
        "free space surrounds the walls, out to the border of the image: a global start searches "
        "there too; paint the outside unknown, or solid");
  } else if (n.free_at_border > 0) {
    lines.push_back("free space reaches the border of the image along " +
                    metres(static_cast<double>(n.free_at_border) * s.geometry.resolution) +
                    ": no wall is known there; where the image was cropped, leave the walls in");
  }
  if (s.blurred_surface_share > kMuchBlurred) {
    lines.push_back(percent(s.blurred_surface_share) +
                    " of the surfaces are of blurred walls, 0.45 to 1.3 m thick: the pose is less "
                    "certain beside them; map again, more slowly");
  }
  if (s.opening_share > kManyOpenings && s.kind != MapKind::kOpen) {
    lines.push_back(percent(s.opening_share) +
                    " of the border of free space is unknown instead of a wall: what the lidar "
                    "sees there is not on the map; map again, up to the walls");
  }
  if (s.geometry.resolution > kCoarseFrom) {
    std::ostringstream line;
    line << "cells of " << s.geometry.resolution << " m are coarse: expected 0.15 m or less";
    lines.push_back(line.str());
  }
  return lines;
}

}  // namespace

std::string toString(MapKind kind) {
  switch (kind) {
    case MapKind::kNoFreeCells:
      return "map without free cells";
    case MapKind::kNoObstacles:
      return "map without obstacles";
    case MapKind::kGrey:
      return "grey map (probabilities)";
    case MapKind::kSlam:
      return "SLAM map (unknown outside)";
    case MapKind::kFilled:
      return "filled map (solid outside)";
    case MapKind::kOpen:
      return "open map (free outside)";
    case MapKind::kWalls:
      return "walled map (nothing outside)";
  }
  return "map of an unknown kind";
}

MapSummary summarize(const OccupancyGrid& grid, const Surfaces& surfaces) {
  FreeSpace space = findFreeSpace(grid);
  const Counts n = count(grid, surfaces, space);
  const std::size_t cells = grid.cells().size();
  const double resolution = grid.geometry().resolution;
  const auto area = [&](std::size_t count) {
    return static_cast<double>(count) * resolution * resolution;
  };

  MapSummary s;
  s.geometry = grid.geometry();
  s.kind = kindOf(n);
  s.free_share = share(n.free, cells);
  s.occupied_share = share(n.occupied, cells);
  s.unknown_share = share(n.unknown, cells);
  s.free_area = area(n.free);
  for (const std::size_t part :
       partsOf(std::move(space.free), static_cast<std::size_t>(grid.geometry().width))) {
    if (area(part) > kSmallestArea) ++s.free_areas;
    s.largest_free_area = std::max(s.largest_free_area, area(part));
  }
  s.free_cells_at_border = n.free_at_border;
  s.surface_cells = n.surface;
  s.surface_length = static_cast<double>(n.surface) * resolution;
  s.blurred_area = area(n.blurred);
  s.blurred_surface_share = share(n.blurred_surface, n.surface);
  s.hidden_share = share(n.hidden, n.occupied);
  s.opening_share = share(n.roomy_opening_sides, n.roomy_opening_sides + n.roomy_wall_sides);
  s.warnings = warningsOf(s, n);
  return s;
}

std::string describe(const MapSummary& s) {
  const GridGeometry& geometry = s.geometry;
  std::ostringstream line;
  line << "map of " << geometry.width << " x " << geometry.height << " cells at "
       << geometry.resolution << " m, " << std::fixed << std::setprecision(1)
       << geometry.width * geometry.resolution << " x " << geometry.height * geometry.resolution
       << " m: " << toString(s.kind) << ", " << s.free_area << " m2 free, "
       << metres(s.surface_length) << " of surfaces";
  return line.str();
}

std::vector<std::uint8_t> findOpenings(const OccupancyGrid& grid) {
  const FreeSpace space = findFreeSpace(grid);
  std::vector<std::uint8_t> openings(grid.cells().size(), 0);
  std::size_t i = 0;
  for (int row = 0; row < grid.geometry().height; ++row) {
    for (int column = 0; column < grid.geometry().width; ++column, ++i) {
      const Cell cell{column, row};
      if (space.free[i] == 0 || space.roomy[i] == 0) continue;
      openings[i] = sidesOf(grid, space, cell).openings > 0 ? 1 : 0;
    }
  }
  return openings;
}

}  // namespace racecar_mcl
