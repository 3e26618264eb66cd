// Elementary functions without branches and tables, which compilers can vectorize. Results are
// bit-identical for every instruction set. Taylor series, long enough for double precision (errors
// of one to two units in the last place).
#pragma once

#include <cstdint>
#include <cstring>

#include "racecar_mcl/geometry/pose2.h"
#include "simd/cpu_dispatch.h"

namespace racecar_mcl {

template <typename To, typename From>
RACECAR_MCL_INLINE To bitsAs(From from) {
  static_assert(sizeof(To) == sizeof(From), "both have the same bits");
  To to;
  std::memcpy(&to, &from, sizeof(To));
  return to;
}

/// Elements that a loop handles at once: temporary arrays of this size stay in the first-level
/// cache.
constexpr int kBlockSize = 256;

/// Added to a double with magnitude below 2^51, it leaves that number rounded to nearest in the
/// lowest bits of the mantissa.
constexpr double kRounder = 0x1.8p52;

/// The angle wrapped into (-pi, pi], for angles of up to about 1e5 turns.
RACECAR_MCL_INLINE double wrapAngleFast(double angle) {
  constexpr double kTurn = 2.0 * kPi;
  const double turns = (angle * (1.0 / kTurn) + kRounder) - kRounder;
  const double wrapped = angle - turns * kTurn;
  return wrapped <= -kPi ? kPi : wrapped;
}

/// Sine and cosine of an angle within (-pi/4, pi/4) plus `quarters` quarter turns, of which the
/// lowest two bits count.
RACECAR_MCL_INLINE void sinCosOfQuarter(double angle, std::uint64_t quarters, double* sine,
                                        double* cosine) {
  const double r2 = angle * angle;
  const double s =
      angle +
      angle * r2 *
          (-1.0 / 6.0 +
           r2 * (1.0 / 120.0 +
                 r2 * (-1.0 / 5040.0 +
                       r2 * (1.0 / 362880.0 +
                             r2 * (-1.0 / 39916800.0 +
                                   r2 * (1.0 / 6227020800.0 + r2 * (-1.0 / 1307674368000.0)))))));
  const double c =
      1.0 + r2 * (-0.5 + r2 * (1.0 / 24.0 +
                               r2 * (-1.0 / 720.0 +
                                     r2 * (1.0 / 40320.0 +
                                           r2 * (-1.0 / 3628800.0 +
                                                 r2 * (1.0 / 479001600.0 +
                                                       r2 * (-1.0 / 87178291200.0 +
                                                             r2 * (1.0 / 20922789888000.0))))))));
  const std::uint64_t odd = 0 - (quarters & 1U);  // all bits where sine and cosine swap
  const auto s_bits = bitsAs<std::uint64_t>(s);
  const auto c_bits = bitsAs<std::uint64_t>(c);
  const std::uint64_t sine_bits = (s_bits & ~odd) | (c_bits & odd);
  const std::uint64_t cosine_bits = (c_bits & ~odd) | (s_bits & odd);
  *sine = bitsAs<double>(sine_bits ^ ((quarters & 2U) << 62U));
  *cosine = bitsAs<double>(cosine_bits ^ (((quarters + 1U) & 2U) << 62U));
}

/// Sine and cosine of angles of up to about 1e5 rad.
RACECAR_MCL_INLINE void sinCos(double angle, double* sine, double* cosine) {
  // Cody-Waite reduction: pi / 2 in three parts, the first two short, so that their multiples are
  // exact.
  constexpr double kQuarter = 0x1.921fb544p0;
  constexpr double kQuarterNext = 0x1.0b4611a6p-34;
  constexpr double kQuarterRest = 0x1.3198a2e037073p-69;
  const double shifted = angle * (2.0 / kPi) + kRounder;
  const double n = shifted - kRounder;
  const double rest = ((angle - n * kQuarter) - n * kQuarterNext) - n * kQuarterRest;
  sinCosOfQuarter(rest, bitsAs<std::uint64_t>(shifted), sine, cosine);
}

/// e^x for x of at most 0; 0 below -708.
RACECAR_MCL_INLINE double expOfNegative(double x) {
  constexpr double kLog2 = 0x1.62e42feep-1;  // ln 2 in two parts, the first one short
  constexpr double kLog2Rest = 0x1.a39ef35793c76p-33;
  const double held = x < -708.0 ? -708.0 : x;
  const double shifted = held * 1.44269504088896340736 + kRounder;
  const double n = shifted - kRounder;
  const double r = (held - n * kLog2) - n * kLog2Rest;
  const double series =
      1.0 +
      r * (1.0 +
           r * (1.0 / 2.0 +
                r * (1.0 / 6.0 +
                     r * (1.0 / 24.0 +
                          r * (1.0 / 120.0 +
                               r * (1.0 / 720.0 +
                                    r * (1.0 / 5040.0 +
                                         r * (1.0 / 40320.0 +
                                              r * (1.0 / 362880.0 +
                                                   r * (1.0 / 3628800.0 +
                                                        r * (1.0 / 39916800.0 +
                                                             r * (1.0 / 479001600.0))))))))))));
  const double power = bitsAs<double>((bitsAs<std::uint64_t>(shifted) + 1023U) << 52U);
  return x < -708.0 ? 0.0 : series * power;
}

/// The natural logarithm of a positive, normal number.
RACECAR_MCL_INLINE double logOfPositive(double x) {
  constexpr std::uint64_t kRootHalf = 0x3fe6a09e667f3bcdU;  // the bits of sqrt(1/2)
  // x = m 2^e with m in [sqrt(1/2), sqrt(2))
  const std::uint64_t shifted = bitsAs<std::uint64_t>(x) + (0x3ff0000000000000U - kRootHalf);
  const double e = bitsAs<double>((shifted >> 52U) | 0x4330000000000000U) - (0x1p52 + 1023.0);
  const double m = bitsAs<double>((shifted & 0x000fffffffffffffU) + kRootHalf);
  const double s = (m - 1.0) / (m + 1.0);
  const double s2 = s * s;
  const double series =
      1.0 +
      s2 * (1.0 / 3.0 +
            s2 * (1.0 / 5.0 +
                  s2 * (1.0 / 7.0 +
                        s2 * (1.0 / 9.0 +
                              s2 * (1.0 / 11.0 +
                                    s2 * (1.0 / 13.0 + s2 * (1.0 / 15.0 + s2 * (1.0 / 17.0))))))));
  return e * 0.693147180559945309417 + 2.0 * s * series;
}

/// Sum whose order does not depend on the instruction set: eight interleaved partial sums.
class LaneSum {
 public:
  RACECAR_MCL_INLINE void add(const double* values, int count) {
    int i = 0;
    for (; i + kLanes <= count; i += kLanes) {
      for (int lane = 0; lane < kLanes; ++lane) lanes_[lane] += values[i + lane];
    }
    for (int lane = 0; i < count; ++i, ++lane) lanes_[lane] += values[i];
  }

  double total() const {
    return ((lanes_[0] + lanes_[4]) + (lanes_[2] + lanes_[6])) +
           ((lanes_[1] + lanes_[5]) + (lanes_[3] + lanes_[7]));
  }

 private:
  static constexpr int kLanes = 8;
  double lanes_[kLanes] = {};
};

}  // namespace racecar_mcl
