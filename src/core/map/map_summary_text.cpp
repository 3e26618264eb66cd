// Texts about maps: kind, one-line description and warnings.
#include "map/map_summary_text.h"

#include <iomanip>
#include <sstream>

namespace racecar_mcl {
namespace {

// Thresholds of the warnings. That of the openings is from complete maps (docs/decisions.md).
constexpr double kMinLargestAreaRatio = 0.95;  // largest free area, fraction of all free space
constexpr double kMaxBlurredRatio = 0.3;       // fraction of the surface cells
constexpr double kMaxOpeningRatio = 0.3;       // fraction of the border of free space
constexpr double kMaxResolution = 0.15;        // m per cell

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

std::vector<std::string> warningsOf(const MapSummary& s, bool has_visible_walls) {
  std::vector<std::string> lines;
  if (s.kind == MapKind::kNoFreeCells) {
    lines.push_back(
        "no free cell: no pose is possible; check the map's negate, free_thresh and mode");
  }
  if (s.occupied_share == 0.0) {
    lines.push_back(
        "no obstacle cell: scans fit everywhere; check the map's negate, occupied_thresh and mode");
  }
  if (s.usable() && !has_visible_walls) {
    lines.push_back("no obstacle is next to free space: all obstacle cells are taken as surfaces");
  }
  if (s.free_areas > 1 && s.largest_free_area < kMinLargestAreaRatio * s.free_area) {
    lines.push_back("free space is in " + std::to_string(s.free_areas) +
                    " separate areas, the largest " + percent(s.largest_free_area / s.free_area) +
                    " of it: a global start searches all of them; paint over where no car can be");
  }
  if (s.kind == MapKind::kOpen) {
    lines.push_back(
        "free space surrounds the walls, out to the border of the image: a global start searches "
        "there too; paint the outside unknown or solid");
  } else if (s.free_cells_at_border > 0) {
    lines.push_back("free space reaches the border of the image along " +
                    metres(static_cast<double>(s.free_cells_at_border) * s.geometry.resolution) +
                    ": no wall is known there; if the image was cropped, keep the walls");
  }
  if (s.blurred_surface_share > kMaxBlurredRatio) {
    lines.push_back(percent(s.blurred_surface_share) +
                    " of the surfaces are of blurred walls, 0.45 to 1.3 m thick: the pose is less "
                    "certain beside them; map again, more slowly");
  }
  if (s.opening_share > kMaxOpeningRatio && s.kind != MapKind::kOpen) {
    lines.push_back(percent(s.opening_share) +
                    " of the border of free space is unknown instead of a wall: what the lidar "
                    "sees there is not on the map; map again, up to the walls");
  }
  if (s.geometry.resolution > kMaxResolution) {
    std::ostringstream line;
    line << "cells of " << s.geometry.resolution << " m are coarse: expected 0.15 m or less";
    lines.push_back(line.str());
  }
  return lines;
}

}  // namespace racecar_mcl
