#include "racecar_mcl/scan.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

namespace racecar_mcl {

Scan selectBeams(const Scan& scan, int count, double field_of_view) {
  const Eigen::Index beams = scan.bearings.size();
  if (scan.ranges.size() != beams || scan.seconds_after_stamp.size() != beams) {
    throw std::invalid_argument("the scan holds " + std::to_string(beams) + " bearings, " +
                                std::to_string(scan.ranges.size()) + " ranges and " +
                                std::to_string(scan.seconds_after_stamp.size()) +
                                " times; expected as many of each");
  }
  const bool all_round = field_of_view >= 2.0 * kPi;
  const float limit = static_cast<float>(field_of_view / 2.0);
  std::vector<Eigen::Index> inside;
  inside.reserve(static_cast<std::size_t>(scan.size()));
  for (Eigen::Index i = 0; i < scan.size(); ++i) {
    const bool valid = scan.ranges[i] > 0.0f && std::isfinite(scan.bearings[i]) &&
                       std::isfinite(scan.seconds_after_stamp[i]);
    if (valid && (all_round || std::abs(scan.bearings[i]) <= limit)) inside.push_back(i);
  }

  const auto available = static_cast<Eigen::Index>(inside.size());
  const Eigen::Index chosen = std::min<Eigen::Index>(std::max(count, 0), available);
  Scan selected;
  selected.stamp = scan.stamp;
  selected.laser_in_base = scan.laser_in_base;
  selected.bearings.resize(chosen);
  selected.ranges.resize(chosen);
  selected.seconds_after_stamp.resize(chosen);
  for (Eigen::Index k = 0; k < chosen; ++k) {
    // The first and the last beam are both taken, the others lie evenly between them.
    const Eigen::Index slot =
        chosen == 1 ? available / 2 : (k * (available - 1) + (chosen - 1) / 2) / (chosen - 1);
    const Eigen::Index i = inside[static_cast<std::size_t>(slot)];
    selected.bearings[k] = scan.bearings[i];
    selected.ranges[k] = scan.ranges[i];
    selected.seconds_after_stamp[k] = scan.seconds_after_stamp[i];
  }
  return selected;
}

}  // namespace racecar_mcl
