// Largest magnitudes of the numbers of an input. A larger number is an error of its source, and
// computing with it loses precision or overflows.
#pragma once

#include <cmath>

namespace racecar_mcl {

constexpr double kMaxCoordinate = 1e7;     ///< m; the northings of UTM end there
constexpr double kMaxStamp = 1e10;         ///< s; ros::Time ends at 4.3e9 s
constexpr double kMaxInputAngle = 13.0;    ///< rad, about two turns
constexpr double kMaxMountOffset = 100.0;  ///< m, of the lidar from base_link along x and y
constexpr double kMinCellSize = 1e-4;      ///< m per cell of a map
constexpr double kMaxCellSize = 1e3;       ///< m per cell of a map

/// |value| <= max; false for NaN.
inline bool isWithin(double value, double max) { return std::abs(value) <= max; }

}  // namespace racecar_mcl
