#include "racecar_mcl/scan.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

namespace racecar_mcl {

namespace {

/// The beams that can be weighed: with a range above zero (+inf included), a finite bearing inside
/// the field of view and a finite time. Throws std::invalid_argument as selectBeams.
std::vector<Eigen::Index> usableBeams(const Scan& scan, double field_of_view) {
  const Eigen::Index beams = scan.bearings.size();
  if (scan.ranges.size() != beams || scan.seconds_after_stamp.size() != beams) {
    throw std::invalid_argument("the scan holds " + std::to_string(beams) + " bearings, " +
                                std::to_string(scan.ranges.size()) + " ranges and " +
                                std::to_string(scan.seconds_after_stamp.size()) +
                                " times; expected as many of each");
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

/// How far round a box of half-width 1 and half-length `aspect` a bearing's end point lies from the
/// middle of the box's front: the way along its sides, left positive.
double wayRoundBox(double bearing, double aspect) {
  const double turn = std::min(std::abs(bearing), kPi);
  const double corner = std::atan2(1.0, aspect);
  double way;
  if (turn <= corner) {
    way = aspect * std::tan(turn);  // on the front
  } else if (turn < kPi - corner) {
    way = 1.0 + aspect - 1.0 / std::tan(turn);  // on a side
  } else {
    way = 2.0 + 2.0 * aspect - aspect * std::tan(kPi - turn);  // on the back
  }
  return std::copysign(way, bearing);
}

/// The other way about: the bearing whose end point lies so far round the box.
double bearingRoundBox(double way, double aspect) {
  const double far = std::abs(way);
  double turn;
  if (far <= 1.0) {
    turn = std::atan2(far, aspect);
  } else if (far < 1.0 + 2.0 * aspect) {
    turn = std::atan2(1.0, 1.0 + aspect - far);
  } else {
    turn = std::atan2(2.0 + 2.0 * aspect - far, -aspect);
  }
  return std::copysign(turn, way);
}

constexpr double kLeastGap = 1e-6;  // rad, by which gaps differ

struct Beam {
  double bearing;  ///< rad, from the car's x axis
  Eigen::Index index;
};

/// The beams that can be weighed, in the order of their bearings from the car's x axis, from the
/// widest gap between them on: the lidar's blind side, wherever that is.
std::vector<Beam> usableBeamsAboutCar(const Scan& scan, double field_of_view) {
  std::vector<Beam> beams;
  for (const Eigen::Index i : usableBeams(scan, field_of_view)) {
    beams.push_back({wrapAngle(static_cast<double>(scan.bearings[i]) + scan.laser_in_base.yaw), i});
  }
  const auto by_bearing = [](const Beam& a, const Beam& b) { return a.bearing < b.bearing; };
  // Most lidars list them so.
  if (!std::is_sorted(beams.begin(), beams.end(), by_bearing)) {
    std::stable_sort(beams.begin(), beams.end(), by_bearing);
  }
  if (beams.empty()) return beams;
  double widest = 2.0 * kPi - (beams.back().bearing - beams.front().bearing);  // behind the car
  auto first = beams.begin();
  for (auto next = beams.begin() + 1; next < beams.end(); ++next) {
    const double gap = next->bearing - std::prev(next)->bearing;
    if (gap <= widest + kLeastGap) continue;
    widest = gap;
    first = next;
  }
  std::rotate(beams.begin(), first, beams.end());
  return beams;
}

}  // namespace

Scan takeBeams(const Scan& scan, const std::vector<Eigen::Index>& chosen) {
  const auto count = static_cast<Eigen::Index>(chosen.size());
  Scan taken;
  taken.stamp = scan.stamp;
  taken.laser_in_base = scan.laser_in_base;
  taken.bearings.resize(count);
  taken.ranges.resize(count);
  taken.seconds_after_stamp.resize(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index i = chosen[static_cast<std::size_t>(k)];
    taken.bearings[k] = scan.bearings[i];
    taken.ranges[k] = scan.ranges[i];
    taken.seconds_after_stamp[k] = scan.seconds_after_stamp[i];
  }
  return taken;
}

Scan selectBeams(const Scan& scan, int count, double field_of_view) {
  const std::vector<Eigen::Index> usable = usableBeams(scan, field_of_view);
  const std::size_t available = usable.size();
  std::vector<Eigen::Index> chosen(
      std::min(static_cast<std::size_t>(std::max(count, 0)), available));
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    // The first and the last beam are both taken, the others lie evenly between them.
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
  const double round = 4.0 + 4.0 * aspect;  // the way round the box
  const double first = wayRoundBox(usable.front().bearing, aspect);
  double whole = wayRoundBox(usable.back().bearing, aspect) - first;
  if (whole < 0.0) whole += round;
  std::size_t next = 0;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const double share =
        chosen.size() == 1 ? 0.5 : static_cast<double>(k) / static_cast<double>(chosen.size() - 1);
    const double target = bearingRoundBox(std::remainder(first + share * whole, round), aspect);
    const auto miss = [&](std::size_t i) {
      return std::abs(wrapAngle(usable[i].bearing - target));
    };
    // The nearest that leaves enough beams for those still to be chosen: none is taken twice.
    const std::size_t last = usable.size() - (chosen.size() - k);
    while (next < last && miss(next + 1) <= miss(next)) ++next;
    chosen[k] = usable[next++].index;
  }
  return takeBeams(scan, chosen);
}

}  // namespace racecar_mcl
