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
  RACECAR_MCL_INLINE BeamDirections(const Eigen::ArrayXf& bearings, Eigen::Index from) : end(from) {
    std::array<float, kBlockSize> bearing;
    for (; end < bearings.size() && size < kBlockSize; ++end) {
      if (!std::isfinite(bearings[end])) continue;
      const auto k = static_cast<std::size_t>(size++);
      index[k] = end;
      bearing[k] = bearings[end];
    }
    for (std::size_t k = 0; k < static_cast<std::size_t>(size); ++k) {
      double s, c;
      sinCos(static_cast<double>(bearing[k]), &s, &c);
      cosine[k] = static_cast<Scalar>(c);
      sine[k] = static_cast<Scalar>(s);
    }
  }

  Eigen::Index size = 0;
  Eigen::Index end;
  std::array<Eigen::Index, kBlockSize> index;  ///< of the bearing in the cast
  std::array<Scalar, kBlockSize> cosine;
  std::array<Scalar, kBlockSize> sine;
};

}  // namespace racecar_mcl
