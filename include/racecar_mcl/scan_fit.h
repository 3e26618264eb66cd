// How well a map explains a scan taken from a pose.
#pragma once

#include "racecar_mcl/pose.h"
#include "racecar_mcl/scan.h"

namespace racecar_mcl {

struct MapModel;

struct ScanFit {
  /// Share of the beams that end at a surface or in a wall, within 0.2 m or a cell, and that have
  /// not gone 0.5 m beyond the first wall in their way.
  double explained = 0.0;
  int beams = 0;  ///< that could be judged: their range lies between 0.3 m and search_max_range
};

ScanFit fitScan(MapModel* map, const Pose2& base_in_map, const Scan& beams);

}  // namespace racecar_mcl
