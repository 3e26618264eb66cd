// Standard normal random numbers for whole arrays.
#pragma once

#include <cmath>

#include "racecar_mcl/common/random.h"
#include "simd/vector_math.h"

namespace racecar_mcl {

/// Sixteen parallel xoshiro256++ generators (see Random), so that their steps can be vectorized.
/// The same seed gives the same numbers for every instruction set.
class NoiseLanes {
 public:
  /// `fillGaussian` fills multiples of this.
  static constexpr int kBatch = 32;

  explicit NoiseLanes(std::uint64_t seed) {
    // The lanes are seeded by a generator, as its authors recommend.
    Random random(seed);
    for (auto& word : state_) {
      for (std::uint64_t& lane : word) lane = random();
    }
  }

  /// Independent standard normals (Box and Muller 1958), two from each random number: 32 bits for
  /// the radius, which so ends at 6.8 sigma, and 32 for the angle. `count` is a multiple of kBatch.
  RACECAR_MCL_INLINE void fillGaussian(double* values, int count) {
    for (int first = 0; first < count; first += kBatch) {
      std::uint64_t bits[kLanes];
      step(bits);
      double* const one = values + first;
      double* const other = one + kLanes;
      for (int i = 0; i < kLanes; ++i) {
        // An integer under 2^52 as a double's lowest bits is that double less 2^52.
        const double high = bitsAs<double>((bits[i] >> 32U) | 0x4330000000000000U) - 0x1p52;
        const double low = bitsAs<double>((bits[i] & 0xffffffffU) | 0x4330000000000000U) - 0x1p52;
        const double radius = std::sqrt(-2.0 * logOfPositive((high + 0.5) * 0x1p-32));
        const double quarters = low * 0x1p-30;  // [0, 4)
        const double shifted = quarters + kRounder;
        double sine, cosine;
        sinCosOfQuarter((quarters - (shifted - kRounder)) * (kPi / 2.0),
                        bitsAs<std::uint64_t>(shifted), &sine, &cosine);
        one[i] = radius * cosine;
        other[i] = radius * sine;
      }
    }
  }

 private:
  static constexpr int kLanes = kBatch / 2;

  RACECAR_MCL_INLINE void step(std::uint64_t* result) {
    for (int i = 0; i < kLanes; ++i) {
      const std::uint64_t sum = state_[0][i] + state_[3][i];
      result[i] = ((sum << 23U) | (sum >> 41U)) + state_[0][i];
      const std::uint64_t shifted = state_[1][i] << 17U;
      state_[2][i] ^= state_[0][i];
      state_[3][i] ^= state_[1][i];
      state_[1][i] ^= state_[2][i];
      state_[0][i] ^= state_[3][i];
      state_[2][i] ^= shifted;
      state_[3][i] = (state_[3][i] << 45U) | (state_[3][i] >> 19U);
    }
  }

  std::uint64_t state_[4][kLanes];
};

}  // namespace racecar_mcl
