#include "racecar_mcl/localizer/localization_map.h"

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "map/known_part.h"
#include "racecar_mcl/common/errors.h"

namespace racecar_mcl {

void validate(const SensorParameters& p) {
  validate(p.beam);
  validate(p.field);
  validate(p.search);
  if (p.caster.max_range != 0.0) return validate(p.caster);
  RangeCasterParameters filled = p.caster;  // 0 stands for the range of the sensor model
  filled.max_range = 1.0;
  validate(filled);
}

namespace {

/// The maximum range of the caster, m. Throws as makeLocalizationMap.
double casterRange(const SensorParameters& sensor, double resolution) {
  const double max_range = sensor.caster.max_range;
  if (sensor.sensor_model == SensorModelType::kLikelihoodField) {
    return max_range == 0.0 ? sensor.field.field_max_range : max_range;
  }
  const double table_range = beamTableRange(sensor.beam, resolution);
  if (max_range == 0.0) return table_range;
  if (max_range < table_range - resolution / 2.0) {
    std::ostringstream problem;
    problem << "max_range is " << max_range << " m but the beam table reaches " << table_range
            << " m on a map of " << resolution
            << " m per cell; expected at least that, or 0 for the range of the table";
    throw ParameterError(problem.str());
  }
  return max_range;
}

std::unique_ptr<RangeCaster> makeCaster(const OccupancyGrid& grid, const SensorParameters& sensor,
                                        const std::string& method) {
  RangeCasterParameters parameters = sensor.caster;
  parameters.range_method = method;
  parameters.max_range = casterRange(sensor, grid.geometry().resolution);
  return makeRangeCaster(grid, parameters);
}

}  // namespace

std::shared_ptr<const LocalizationMap> makeLocalizationMap(OccupancyGrid grid,
                                                           const SensorParameters& sensor) {
  CellRuns free_cells = freeCells(grid);
  const std::string size = "the map of " + std::to_string(grid.geometry().width) + " x " +
                           std::to_string(grid.geometry().height) + " cells ";
  if (free_cells.empty()) throw MapError(size + "has no free cell: no pose on it is possible");
  if (!hasObstacle(grid)) {
    throw MapError(size +
                   "has no occupied cell: a scan matches it anywhere; expected walls, see "
                   "the map's negate, occupied_thresh and mode");
  }
  std::unique_ptr<const RangeCaster> caster;
  std::optional<LikelihoodField> field;
  std::optional<UnmappedSpace> unmapped_space;
  std::optional<GlobalScanMatcher> matcher;
  {
    const KnownPart known(grid);
    const OccupancyGrid& part = known.grid();
    caster = makeCaster(part, sensor, "simd");
    const Surfaces surfaces = findSurfaces(part);
    if (sensor.sensor_model == SensorModelType::kLikelihoodField) {
      field.emplace(part.geometry(), surfaces, sensor.field);
      unmapped_space = findUnmappedSpace(part, surfaces, sensor.field);
    }
    matcher.emplace(part.geometry(), freeCells(part), surfaces, sensor.search);
  }
  return std::make_shared<const LocalizationMap>(
      LocalizationMap{std::move(grid), std::move(caster), std::move(field), std::move(*matcher),
                      std::move(free_cells), std::move(unmapped_space)});
}

const LikelihoodField* LocalizationMap::fieldInstead(bool converged, const Pose2& lidar_in_map,
                                                     const Scan& beams) const {
  if (!converged) return &matcher.field();
  const bool is_missing = unmapped_space && unmapped_space->hasMissingSurface(lidar_in_map, beams);
  return is_missing ? &unmapped_space->field() : nullptr;
}

std::unique_ptr<SensorModel> makeSensorModel(const LocalizationMap& map,
                                             const SensorParameters& sensor, int threads) {
  if (sensor.sensor_model == SensorModelType::kLikelihoodField) {
    if (!map.likelihood_field) {
      throw std::invalid_argument(
          "the map has no likelihood field: it was built for another model");
    }
    return std::make_unique<LikelihoodFieldModel>(*map.likelihood_field, threads);
  }
  return std::make_unique<RayCastingModel>(
      BeamModel(sensor.beam, map.grid.geometry().resolution),
      makeCaster(KnownPart(map.grid).grid(), sensor, sensor.caster.range_method), threads);
}

ParticleSet sampleFreeSpace(const LocalizationMap& map, Eigen::Index count, Random& random) {
  ParticleSet particles;
  particles.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Cell cell = map.free_cells[random.index(map.free_cells.size())];
    const double across = random.uniform();
    const double up = random.uniform();
    const Eigen::Vector2d point =
        gridToWorld(map.grid.geometry(), {cell.column + across, cell.row + up});
    particles.setPose(i, {point.x(), point.y(), random.uniform(-kPi, kPi)});
  }
  particles.log_weight.setConstant(-std::log(static_cast<double>(count)));
  return particles;
}

}  // namespace racecar_mcl
