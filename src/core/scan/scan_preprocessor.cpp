#include "racecar_mcl/scan/scan_preprocessor.h"

#include <utility>

#include "racecar_mcl/common/validation.h"
#include "racecar_mcl/scan/beam_selection.h"

namespace racecar_mcl {
namespace {

constexpr float kMinRange = 0.01f;  // m, after the correction

}  // namespace

void validate(const ScanParameters& p) {
  requireWithin("num_beams_per_particle", p.num_beams_per_particle, 1, 10000);
  require(p.min_beams >= 1 && p.min_beams <= p.num_beams_per_particle, "min_beams", p.min_beams,
          "between 1 and num_beams_per_particle");
  require(p.scan_field_of_view > 0.0 && p.scan_field_of_view <= 2.0 * kPi + 1e-3,
          "scan_field_of_view", p.scan_field_of_view, "positive and at most 2 pi", "rad");
  requireWithin("beam_box_aspect", p.beam_box_aspect, 0.1, 100.0);
}

ScanPreprocessor::ScanPreprocessor(const ScanParameters& parameters)
    : parameters_((validate(parameters), parameters)) {}

Scan ScanPreprocessor::select(const Scan& scan) const {
  const ScanParameters& p = parameters_;
  if (p.beam_layout == BeamLayout::kEven) {
    return selectBeams(scan, p.num_beams_per_particle, p.scan_field_of_view);
  }
  return selectBeamsBoxed(scan, p.num_beams_per_particle, p.scan_field_of_view, p.beam_box_aspect);
}

PreprocessedScan ScanPreprocessor::correct(Scan selected, const ScanCorrection& correction,
                                           const BaseAfter& base_after) const {
  PreprocessedScan scan;
  scan.sweep = std::move(selected);
  if (correction.range_bias != 0.0) {
    scan.sweep.ranges =
        (scan.sweep.ranges - static_cast<float>(correction.range_bias)).max(kMinRange);
  }
  Eigen::ArrayXf& seconds = scan.sweep.seconds_after_stamp;
  const bool at_once = !parameters_.deskew || (seconds == 0.0f).all();
  if (at_once && !correction.moves) {
    scan.beams = scan.sweep;
    return scan;
  }
  if (at_once) seconds.setZero();
  if (correction.reversed) seconds = -seconds;
  const Pose2 first = base_after(static_cast<double>(seconds.minCoeff()));
  const Pose2 last = base_after(static_cast<double>(seconds.maxCoeff()));
  scan.turned = between(first, last).yaw;
  scan.beams = deskew(scan.sweep, base_after);
  return scan;
}

}  // namespace racecar_mcl
