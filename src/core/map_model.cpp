#include "racecar_mcl/map_model.h"

#include <sstream>
#include <string>
#include <utility>

#include "racecar_mcl/errors.h"

namespace racecar_mcl {

void validate(const SensorParameters& p) {
  validate(p.beam);
  validate(p.field);
  validate(p.search);
  if (p.caster.max_range != 0.0) return validate(p.caster);
  RangeCasterParameters filled = p.caster;  // 0 stands for the range of the sensor table
  filled.max_range = 1.0;
  validate(filled);
}

namespace {

RangeCasterParameters casterParameters(const SensorParameters& sensor, const BeamModel& beam_model,
                                       double resolution) {
  RangeCasterParameters caster = sensor.caster;
  if (sensor.sensor_model == SensorModel::kLikelihoodField) {
    if (caster.max_range == 0.0) caster.max_range = sensor.field.field_max_range;
    return caster;
  }
  if (caster.max_range == 0.0) caster.max_range = beam_model.maxRange();
  if (caster.max_range < beam_model.maxRange() - resolution / 2.0) {
    std::ostringstream problem;
    problem << "max_range is " << caster.max_range << " m but the sensor table reaches to "
            << beam_model.maxRange() << " m on a map of " << resolution
            << " m per cell; expected at least that, or 0 for exactly that";
    throw ParameterError(problem.str());
  }
  return caster;
}

}  // namespace

std::shared_ptr<MapModel> makeMapModel(OccupancyGrid grid, const SensorParameters& sensor) {
  const Surfaces surfaces = findSurfaces(grid);
  return makeMapModel(std::move(grid), surfaces, sensor);
}

std::shared_ptr<MapModel> makeMapModel(OccupancyGrid grid, const Surfaces& surfaces,
                                       const SensorParameters& sensor) {
  std::vector<Cell> free_cells = freeCells(grid);
  if (free_cells.empty()) {
    throw MapError("the map of " + std::to_string(grid.geometry().width) + " x " +
                   std::to_string(grid.geometry().height) +
                   " cells has no free cell: a car can be nowhere on it");
  }
  const double resolution = grid.geometry().resolution;
  BeamModel beam_model(sensor.beam, resolution);
  const RangeCasterParameters caster = casterParameters(sensor, beam_model, resolution);
  std::unique_ptr<RangeCaster> made = makeRangeCaster(grid, caster);
  std::optional<LikelihoodField> field;
  if (sensor.sensor_model == SensorModel::kLikelihoodField) {
    field.emplace(grid.geometry(), surfaces, sensor.field);
  }
  GlobalSearch search(grid.geometry(), free_cells, surfaces, sensor.search);
  return std::make_shared<MapModel>(
      MapModel{std::move(grid), std::move(made), static_cast<float>(caster.max_range),
               std::move(beam_model), std::move(field), std::move(search), std::move(free_cells)});
}

}  // namespace racecar_mcl
