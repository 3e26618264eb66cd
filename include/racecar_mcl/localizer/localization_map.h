// Data derived from a map: ray caster, likelihood field, global scan matcher and free cells.
#pragma once

#include <memory>
#include <optional>

#include "racecar_mcl/map/cell_runs.h"
#include "racecar_mcl/map/occupancy_grid.h"
#include "racecar_mcl/raycasting/range_caster.h"
#include "racecar_mcl/relocalization/global_scan_matcher.h"
#include "racecar_mcl/sensor/beam_model.h"
#include "racecar_mcl/sensor/likelihood_field.h"
#include "racecar_mcl/sensor/map_view.h"
#include "racecar_mcl/sensor/sensor_model.h"
#include "racecar_mcl/sensor/unmapped_space.h"

namespace racecar_mcl {

enum class SensorModelType {
  kBeam,             ///< ray casting and the beam table (the report)
  kLikelihoodField,  ///< end points on the map's distance field
};

struct SensorParameters {
  SensorModelType sensor_model = SensorModelType::kLikelihoodField;
  RangeCasterParameters caster{"simd", 0.0, UnknownIs::kFree};
  BeamModelParameters beam;
  LikelihoodFieldParameters field;
  GlobalScanMatcherParameters search;
};

/// Throws ParameterError on a value out of range.
void validate(const SensorParameters& parameters);

/// Built once per map and immutable: several localizers and threads may share it.
struct LocalizationMap {
  OccupancyGrid grid;
  std::unique_ptr<const RangeCaster> caster;        ///< exact, for single beams and visualization
  std::optional<LikelihoodField> likelihood_field;  ///< set if the sensor model uses it
  GlobalScanMatcher matcher;
  CellRuns free_cells;
  std::optional<UnmappedSpace> unmapped_space{};  ///< with openings and the likelihood field

  /// The field to use instead of the sensor model for a scan from (about) this pose: the coarse one
  /// before convergence, that of the unmapped space if a surface is missing. Null for none.
  const LikelihoodField* fieldInstead(bool converged, const Pose2& lidar_in_map,
                                      const Scan& beams) const;

  MapView view() const { return {grid, *caster, matcher.field()}; }
};

/// Throws MapError for a map without a free cell. caster.max_range = 0 stands for the range of the
/// sensor model: field_max_range, or that of the beam table. Throws ParameterError if the maximum
/// range is shorter than the beam table's, since expected ranges would end before measured ones.
/// Time and memory are those of the part of the map that holds its known cells, apart from the
/// grid.
std::shared_ptr<const LocalizationMap> makeLocalizationMap(OccupancyGrid grid,
                                                           const SensorParameters& sensor);

/// The sensor model that a map was built for, with caches of its own. The map must outlive it.
/// `threads`: 0 = one per core; results are bit-identical for any number. To add a model, add a
/// class to sensor_model.h, a value to SensorModelType and a case here.
std::unique_ptr<SensorModel> makeSensorModel(const LocalizationMap& map,
                                             const SensorParameters& sensor, int threads = 1);

/// Poses drawn uniformly from the free space of the map, with equal weights.
ParticleSet sampleFreeSpace(const LocalizationMap& map, Eigen::Index count, Random& random);

}  // namespace racecar_mcl
