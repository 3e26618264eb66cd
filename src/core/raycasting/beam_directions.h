// Bearings of a cast as unit vectors: the direction of a ray is then a rotation, without a sine.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "simd/vector_math.h"

namespace racecar_mcl {

/// A block of consecutive bearings of a cast; its fixed size avoids allocations.
template <typename Scalar>
struct BeamDirections {
  /// Takes up to kBlockSize finite bearings from index `from` on; `end` is the index after the
  /// last.
  BeamDirections(const Eigen::ArrayXf& bearings, Eigen::Index from) : end(from) {
    for (; end < bearings.size() && size < kBlockSize; ++end) {
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
  std::array<Eigen::Index, kBlockSize> index;  ///< of the bearing in the cast
  std::array<Scalar, kBlockSize> cosine;
  std::array<Scalar, kBlockSize> sine;
};

}  // namespace racecar_mcl
