// The bearings of a cast as unit vectors, so that a ray costs an angle addition and no sine.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

namespace racecar_mcl {

/// Some consecutive bearings of a cast. A fixed number, so that casting allocates nothing.
template <typename Scalar>
struct BeamDirections {
  static constexpr Eigen::Index kMost = 256;

  /// Takes up to kMost finite bearings from index `from` on; `end` is the first one left over.
  BeamDirections(const Eigen::ArrayXf& bearings, Eigen::Index from) : end(from) {
    for (; end < bearings.size() && size < kMost; ++end) {
      if (!std::isfinite(bearings[end])) continue;
      const double bearing = static_cast<double>(bearings[end]);
      const auto k = static_cast<std::size_t>(size++);
      index[k] = end;
      cosine[k] = static_cast<Scalar>(std::cos(bearing));
      sine[k] = static_cast<Scalar>(std::sin(bearing));
    }
  }

  Eigen::Index size = 0;
  Eigen::Index end;
  std::array<Eigen::Index, kMost> index;  ///< which bearing of the cast
  std::array<Scalar, kMost> cosine;
  std::array<Scalar, kMost> sine;
};

}  // namespace racecar_mcl
