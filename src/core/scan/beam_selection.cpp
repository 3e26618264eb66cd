#include "racecar_mcl/scan/beam_selection.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

namespace racecar_mcl {

namespace {

/// The valid beams inside the field of view, as in selectBeams. Throws as selectBeams.
std::vector<Eigen::Index> usableBeams(const Scan& scan, double field_of_view) {
  const Eigen::Index beams = scan.bearings.size();
  if (scan.ranges.size() != beams || scan.seconds_after_stamp.size() != beams) {
    throw std::invalid_argument("the scan holds " + std::to_string(beams) + " bearings, " +
                                std::to_string(scan.ranges.size()) + " ranges and " +
                                std::to_string(scan.seconds_after_stamp.size()) +
                                " times; expected equal numbers");
  }
  const bool all_round = field_of_view >= 2.0 * kPi;
  const float limit = static_cast<float>(field_of_view / 2.0);
  std::vector<Eigen::Index> usable;
  usable.reserve(static_cast<std::size_t>(scan.size()));
  for (Eigen::Index i = 0; i < scan.size(); ++i) {
    const bool valid = scan.ranges[i] > 0.0f && std::isfinite(scan.bearings[i]) &&
                       std::isfinite(scan.seconds_after_stamp[i]);
    if (valid && (all_round || std::abs(scan.bearings[i]) <= limit)) usable.push_back(i);
  }
  return usable;
}

/// The arc length along a box of half-width 1 and half-length `aspect` from the middle of its front
/// to the point at this bearing, positive to the left.
double boxArcLength(double bearing, double aspect) {
  const double turn = std::min(std::abs(bearing), kPi);
  const double corner = std::atan2(1.0, aspect);
  double length;
  if (turn <= corner) {
    length = aspect * std::tan(turn);  // on the front
  } else if (turn < kPi - corner) {
    length = 1.0 + aspect - 1.0 / std::tan(turn);  // on a side
  } else {
    length = 2.0 + 2.0 * aspect - aspect * std::tan(kPi - turn);  // on the back
  }
  return std::copysign(length, bearing);
}

/// The inverse of boxArcLength: the bearing of the point at this arc length.
double boxBearing(double length, double aspect) {
  const double distance = std::abs(length);
  double turn;
  if (distance <= 1.0) {
    turn = std::atan2(distance, aspect);
  } else if (distance < 1.0 + 2.0 * aspect) {
    turn = std::atan2(1.0, 1.0 + aspect - distance);
  } else {
    turn = std::atan2(2.0 + 2.0 * aspect - distance, -aspect);
  }
  return std::copysign(turn, length);
}

constexpr double kGapTolerance = 1e-6;  // rad; gaps that differ by less count as equal

struct Beam {
  double bearing;  ///< rad, from the car's x axis
  Eigen::Index index;
};

/// The valid beams in the order of their bearings from the car's x axis, starting after the widest
/// gap (the lidar's blind sector).
std::vector<Beam> usableBeamsAboutCar(const Scan& scan, double field_of_view) {
  std::vector<Beam> beams;
  for (const Eigen::Index i : usableBeams(scan, field_of_view)) {
    beams.push_back({wrapAngle(static_cast<double>(scan.bearings[i]) + scan.laser_in_base.yaw), i});
  }
  const auto by_bearing = [](const Beam& a, const Beam& b) { return a.bearing < b.bearing; };
  // Most scans are sorted already.
  if (!std::is_sorted(beams.begin(), beams.end(), by_bearing)) {
    std::stable_sort(beams.begin(), beams.end(), by_bearing);
  }
  if (beams.empty()) return beams;
  double widest = 2.0 * kPi - (beams.back().bearing - beams.front().bearing);  // behind the car
  auto first = beams.begin();
  for (auto next = beams.begin() + 1; next < beams.end(); ++next) {
    const double gap = next->bearing - std::prev(next)->bearing;
    if (gap <= widest + kGapTolerance) continue;
    widest = gap;
    first = next;
  }
  std::rotate(beams.begin(), first, beams.end());
  return beams;
}

}  // namespace

Scan selectBeams(const Scan& scan, int count, double field_of_view) {
  const std::vector<Eigen::Index> usable = usableBeams(scan, field_of_view);
  const std::size_t available = usable.size();
  std::vector<Eigen::Index> chosen(
      std::min(static_cast<std::size_t>(std::max(count, 0)), available));
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    // The first and the last beam are included, the others evenly spaced between them.
    const std::size_t gaps = chosen.size() - 1;
    chosen[k] = usable[gaps == 0 ? available / 2 : (k * (available - 1) + gaps / 2) / gaps];
  }
  return takeBeams(scan, chosen);
}

Scan selectBeamsBoxed(const Scan& scan, int count, double field_of_view, double aspect) {
  const std::vector<Beam> usable = usableBeamsAboutCar(scan, field_of_view);
  std::vector<Eigen::Index> chosen(
      std::min(static_cast<std::size_t>(std::max(count, 0)), usable.size()));
  if (chosen.empty()) return takeBeams(scan, chosen);
  const double perimeter = 4.0 + 4.0 * aspect;
  const double first = boxArcLength(usable.front().bearing, aspect);
  double whole = boxArcLength(usable.back().bearing, aspect) - first;
  if (whole < 0.0) whole += perimeter;
  std::size_t next = 0;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const double ratio =
        chosen.size() == 1 ? 0.5 : static_cast<double>(k) / static_cast<double>(chosen.size() - 1);
    const double length = first + ratio * whole;
    const double target =
        boxBearing(length > perimeter / 2.0 ? length - perimeter : length, aspect);
    const auto error = [&](std::size_t i) {
      return std::abs(wrapAngle(usable[i].bearing - target));
    };
    // The nearest beam that leaves enough others for the remaining choices, so that none is taken
    // twice.
    const std::size_t last = usable.size() - (chosen.size() - k);
    while (next < last && error(next + 1) <= error(next)) ++next;
    chosen[k] = usable[next++].index;
  }
  return takeBeams(scan, chosen);
}

}  // namespace racecar_mcl
