#include <sstream>
#include <utility>

#include "racecar_mcl/errors.h"
#include "racecar_mcl/localizer.h"

namespace racecar_mcl {

void validate(const LocalizerParameters& p) {
  validate(p.filter);
  validate(p.motion);
  validate(p.sensor);
  validate(p.odometry);
  validate(p.calibration);
  validate(p.verdict);
  std::ostringstream problem;
  if (p.num_beams_per_particle < 1 || p.num_beams_per_particle > 10000) {
    problem << "num_beams_per_particle is " << p.num_beams_per_particle
            << "; it must lie in [1, 10000]";
  } else if (p.min_beams < 1 || p.min_beams > p.num_beams_per_particle) {
    problem << "min_beams is " << p.min_beams
            << "; it must lie in [1, num_beams_per_particle = " << p.num_beams_per_particle << "]";
  } else if (!(p.scan_field_of_view > 0.0 && p.scan_field_of_view <= 2.0 * kPi + 1e-3)) {
    problem << "scan_field_of_view is " << p.scan_field_of_view << " rad; it must lie in (0, 2 pi]";
  } else if (!(p.beam_box_aspect >= 0.1 && p.beam_box_aspect <= 100.0)) {
    problem << "beam_box_aspect is " << p.beam_box_aspect << "; it must lie in [0.1, 100]";
  } else if (p.parked_updates < 1) {
    problem << "parked_updates is " << p.parked_updates << "; it must be at least 1";
  }
  if (!problem.str().empty()) throw ParameterError(problem.str());
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
