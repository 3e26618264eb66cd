#include "one_place.h"

#include <algorithm>
#include <array>

#include "vector_math.h"

namespace racecar_mcl {
namespace {

constexpr int kWide = 64;  // bins each way about the first particle
constexpr int kMostYawBins = 32;

/// A square of bins, the yaws of each as bits.
using Occupied = std::array<std::uint32_t, kWide * kWide>;

/// Marks the bins of all particles; false where one lies beyond the square.
RACECAR_MCL_INLINE bool mark(const ParticleSet& particles, const PoseBins& bins, Occupied& square) {
  constexpr int kBlock = 256;
  alignas(64) std::array<int, kBlock> cell;
  alignas(64) std::array<int, kBlock> yaw_bin;
  const int size = static_cast<int>(particles.size());
  const double* const x = particles.x.data();
  const double* const y = particles.y.data();
  const double* const yaw = particles.yaw.data();
  const PoseBin middle = binOf(particles.pose(0), bins);
  const double left = middle.x - kWide / 2;
  const double below = middle.y - kWide / 2;
  const double bin_length = bins.position;
  const int yaw_bins = yawBinCount(bins);
  const double yaw_bins_per_rad = yaw_bins / (2.0 * kPi);
  for (int first = 0; first < size; first += kBlock) {
    const int count = std::min(kBlock, size - first);
    int outside = 0;
    for (int k = 0; k < count; ++k) {
      const double column = x[first + k] / bin_length - left;
      const double row = y[first + k] / bin_length - below;
      const double turned = (wrapAngleFast(yaw[first + k]) + kPi) * yaw_bins_per_rad;
      // Written so that NaN, too, lies outside.
      const bool inside = (column >= 0.0) & (column < kWide) & (row >= 0.0) & (row < kWide) &
                          (turned >= 0.0) & (turned < kMostYawBins + 1.0);
      outside += inside ? 0 : 1;
      const int whole_column = static_cast<int>(inside ? column : 0.0);
      const int whole_row = static_cast<int>(inside ? row : 0.0);
      cell[k] = whole_row * kWide + whole_column;
      const int whole_yaw = static_cast<int>(inside ? turned : 0.0);
      yaw_bin[k] = whole_yaw < yaw_bins ? whole_yaw : yaw_bins - 1;
    }
    if (outside > 0) return false;
    for (int k = 0; k < count; ++k) square[cell[k]] |= 1U << static_cast<unsigned>(yaw_bin[k]);
  }
  return true;
}

/// The yaws and their neighbours.
std::uint32_t widened(std::uint32_t yaws, int yaw_bins) {
  const std::uint32_t up = yaws << 1U | yaws >> static_cast<unsigned>(yaw_bins - 1);
  const std::uint32_t down = yaws >> 1U | yaws << static_cast<unsigned>(yaw_bins - 1);
  const std::uint32_t all = 0xffffffffU >> static_cast<unsigned>(kMostYawBins - yaw_bins);
  return (yaws | up | down) & all;
}

}  // namespace

bool lieInOnePlace(const ParticleSet& particles, const PoseBins& bins) {
  const int yaw_bins = yawBinCount(bins);
  if (yaw_bins > kMostYawBins) return false;
  Occupied occupied = {};
  bool within = false;
  runWith(fastestInstructionSet(),
          [&]() RACECAR_MCL_INLINE_LAMBDA { within = mark(particles, bins, occupied); });
  if (!within) return false;

  // From the first particle's bin to all that touch, until nothing more is reached.
  Occupied reached = {};
  constexpr int kMiddle = kWide / 2 * kWide + kWide / 2;
  reached[kMiddle] = occupied[kMiddle] & (0U - occupied[kMiddle]);  // one yaw there
  for (bool grows = true; grows;) {
    grows = false;
    for (int cell = 0; cell < kWide * kWide; ++cell) {
      if ((occupied[cell] & ~reached[cell]) == 0) continue;
      const int column = cell % kWide;
      const int row = cell / kWide;
      std::uint32_t near = 0;
      for (int r = std::max(0, row - 1); r <= std::min(kWide - 1, row + 1); ++r) {
        for (int c = std::max(0, column - 1); c <= std::min(kWide - 1, column + 1); ++c) {
          near |= reached[r * kWide + c];
        }
      }
      const std::uint32_t more = widened(near, yaw_bins) & occupied[cell] & ~reached[cell];
      reached[cell] |= more;
      grows = grows || more != 0;
    }
  }
  return reached == occupied;
}

}  // namespace racecar_mcl
