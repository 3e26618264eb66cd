// Everything that is derived from a map: what rays meet, how scans are weighed, where a scan fits.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "racecar_mcl/beam_model.h"
#include "racecar_mcl/global_search.h"
#include "racecar_mcl/likelihood_field.h"
#include "racecar_mcl/occupancy_grid.h"
#include "racecar_mcl/range_caster.h"
#include "racecar_mcl/surfaces.h"

namespace racecar_mcl {

enum class SensorModel {
  kBeam,             ///< cast rays, weighed by the sensor table (the report)
  kLikelihoodField,  ///< end points on the map's distance field
};

struct SensorParameters {
  SensorModel sensor_model = SensorModel::kLikelihoodField;
  RangeCasterParameters caster{"simd", 0.0, UnknownIs::kFree};
  BeamModelParameters beam;
  LikelihoodFieldParameters field;
  GlobalSearchParameters search;
};

/// Throws ParameterError on a value out of range.
void validate(const SensorParameters& parameters);

/// Built once per map, off to the side.
struct MapModel {
  OccupancyGrid grid;
  std::unique_ptr<RangeCaster> caster;
  float max_range;  ///< m, the caster's
  BeamModel beam_model;
  std::optional<LikelihoodField>
      likelihood_field;  ///< weighs in place of the beam model where it is there
  GlobalSearch search;
  std::vector<Cell> free_cells;
};

/// Throws MapError for a map without a free cell. A caster.max_range of 0 takes the range of the
/// sensor model: field_max_range, or that of the sensor table. With the beam model less than that
/// is a ParameterError, for expected ranges would end before measured ones.
std::shared_ptr<MapModel> makeMapModel(OccupancyGrid grid, const SensorParameters& sensor);

/// The same, with what findSurfaces gave of the grid.
std::shared_ptr<MapModel> makeMapModel(OccupancyGrid grid, const Surfaces& surfaces,
                                       const SensorParameters& sensor);

}  // namespace racecar_mcl
