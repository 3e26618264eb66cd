#include <utility>

#include "racecar_mcl/localizer.h"
#include "racecar_mcl/require.h"

namespace racecar_mcl {

void validate(const LocalizerParameters& p) {
  validate(p.filter);
  validate(p.motion);
  validate(p.sensor);
  validate(p.odometry);
  validate(p.calibration);
  validate(p.range_bias);
  validate(p.verdict);
  validate(p.protection);
  requireWithin("map_error_distance", p.map_error_distance, 0.0, 1000.0, "m");
  requireWithin("num_beams_per_particle", p.num_beams_per_particle, 1, 10000);
  require(p.min_beams >= 1 && p.min_beams <= p.num_beams_per_particle, "min_beams", p.min_beams,
          "between 1 and num_beams_per_particle");
  require(p.scan_field_of_view > 0.0 && p.scan_field_of_view <= 2.0 * kPi + 1e-3,
          "scan_field_of_view", p.scan_field_of_view, "positive and at most 2 pi", "rad");
  requireWithin("beam_box_aspect", p.beam_box_aspect, 0.1, 100.0);
  require(p.parked_updates >= 1, "parked_updates", p.parked_updates, "at least 1");
}

std::shared_ptr<MapModel> makeMapModel(OccupancyGrid grid, const LocalizerParameters& parameters) {
  return makeMapModel(std::move(grid), parameters.sensor);
}

Scan chooseBeams(const LocalizerParameters& p, const Scan& scan) {
  if (p.beam_layout == BeamLayout::kBoxed) {
    return selectBeamsBoxed(scan, p.num_beams_per_particle, p.scan_field_of_view,
                            p.beam_box_aspect);
  }
  return selectBeams(scan, p.num_beams_per_particle, p.scan_field_of_view);
}

}  // namespace racecar_mcl
