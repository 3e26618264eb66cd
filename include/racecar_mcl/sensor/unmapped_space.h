// Places where a map lacks the surfaces that a lidar sees.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "racecar_mcl/geometry/pose2.h"
#include "racecar_mcl/map/occupancy_grid.h"
#include "racecar_mcl/map/surfaces.h"
#include "racecar_mcl/scan/scan.h"
#include "racecar_mcl/sensor/likelihood_field.h"

namespace racecar_mcl {

/// The cells of findUnmapped, and a likelihood field for scans that end in them.
///
/// In the plain field a missing surface pulls the pose: the more of its beams end on the surfaces
/// beside it, the more likely the pose. Here the beams that end in unmapped cells have at least
/// unmapped_likelihood, that of an average beam at the right pose, so that they are evidence
/// neither for nor against a pose. The plain field is for all other scans: where beams pass through
/// an opening, the ends of the walls beside it do show the pose.
class UnmappedSpace {
 public:
  /// `surfaces`, `unmapped`: the results of findSurfaces and findUnmapped for a grid with this
  /// geometry. Precondition: a cell is unmapped.
  UnmappedSpace(const GridGeometry& grid, const Surfaces& surfaces,
                const std::vector<std::uint8_t>& unmapped,
                const LikelihoodFieldParameters& parameters);

  /// Whether beams from this pose (map frame) end at an opening side by side along at least 0.5 m:
  /// a surface is missing there. The bearings are in order.
  bool hasMissingSurface(const Pose2& lidar_in_map, const Scan& beams) const;

  const LikelihoodField& field() const { return field_; }

 private:
  bool isAtOpening(const Eigen::Vector2d& point_in_map) const;

  GridGeometry geometry_;            ///< of the window of the unmapped cells
  std::vector<std::uint8_t> cells_;  ///< those of findUnmapped
  LikelihoodField field_;
};

/// The unmapped space of a grid. None without openings, or if unmapped_likelihood is not above
/// z_rand.
std::optional<UnmappedSpace> findUnmappedSpace(const OccupancyGrid& grid, const Surfaces& surfaces,
                                               const LikelihoodFieldParameters& parameters);

}  // namespace racecar_mcl
