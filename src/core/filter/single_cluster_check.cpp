#include "filter/single_cluster_check.h"

#include <algorithm>
#include <array>

#include "simd/vector_math.h"

namespace racecar_mcl {
namespace {

constexpr int kGridSize = 64;    // bins along x and y, centred on the first particle
constexpr int kMaxYawBins = 32;  // one bit each in a 32-bit word

/// A square of bins; the bits of a word are the yaw bins.
using Occupied = std::array<std::uint32_t, kGridSize * kGridSize>;

/// Marks the bins of all particles; false if one lies outside the square.
RACECAR_MCL_INLINE bool mark(const ParticleSet& particles, const PoseBins& bins, Occupied& square) {
  alignas(64) std::array<int, kBlockSize> cell;
  alignas(64) std::array<int, kBlockSize> yaw_bin;
  const int size = static_cast<int>(particles.size());
  const double* const x = particles.x.data();
  const double* const y = particles.y.data();
  const double* const yaw = particles.yaw.data();
  const PoseBin middle = binOf(particles.pose(0), bins);
  const int left = middle.x - kGridSize / 2;
  const int below = middle.y - kGridSize / 2;
  const double bin_length = bins.position;
  const int yaw_bins = yawBinCount(bins);
  const double yaw_bins_per_rad = yaw_bins / (2.0 * kPi);
  for (int first = 0; first < size; first += kBlockSize) {
    const int count = std::min(kBlockSize, size - first);
    int outside = 0;
    for (int k = 0; k < count; ++k) {
      const double column = x[first + k] / bin_length - left;
      const double row = y[first + k] / bin_length - below;
      const double turned = (wrapAngleFast(yaw[first + k]) + kPi) * yaw_bins_per_rad;
      // Written so that NaN counts as outside.
      const bool inside = (column >= 0.0) & (column < kGridSize) & (row >= 0.0) &
                          (row < kGridSize) & (turned >= 0.0) & (turned < kMaxYawBins + 1.0);
      outside += inside ? 0 : 1;
      const int whole_column = static_cast<int>(inside ? column : 0.0);
      const int whole_row = static_cast<int>(inside ? row : 0.0);
      cell[k] = whole_row * kGridSize + whole_column;
      const int whole_yaw = static_cast<int>(inside ? turned : 0.0);
      yaw_bin[k] = whole_yaw < yaw_bins ? whole_yaw : yaw_bins - 1;
    }
    if (outside > 0) return false;
    for (int k = 0; k < count; ++k) square[cell[k]] |= 1U << static_cast<unsigned>(yaw_bin[k]);
  }
  return true;
}

/// The yaw bins and their neighbours; a cyclic dilation by one.
std::uint32_t dilated(std::uint32_t yaws, int yaw_bins) {
  const std::uint32_t up = yaws << 1U | yaws >> static_cast<unsigned>(yaw_bins - 1);
  const std::uint32_t down = yaws >> 1U | yaws << static_cast<unsigned>(yaw_bins - 1);
  const std::uint32_t all = 0xffffffffU >> static_cast<unsigned>(kMaxYawBins - yaw_bins);
  return (yaws | up | down) & all;
}

}  // namespace

bool formSingleCluster(const ParticleSet& particles, const PoseBins& bins) {
  const int yaw_bins = yawBinCount(bins);
  if (yaw_bins > kMaxYawBins) return false;
  Occupied occupied = {};
  bool within = false;
  runWith(fastestInstructionSet(),
          [&]() RACECAR_MCL_INLINE_LAMBDA { within = mark(particles, bins, occupied); });
  if (!within) return false;

  // Flood fill from the first particle's bin.
  Occupied reached = {};
  constexpr int kCentre = kGridSize / 2 * kGridSize + kGridSize / 2;
  reached[kCentre] = occupied[kCentre] & (0U - occupied[kCentre]);  // its lowest bit
  for (bool grows = true; grows;) {
    grows = false;
    for (int cell = 0; cell < kGridSize * kGridSize; ++cell) {
      if ((occupied[cell] & ~reached[cell]) == 0) continue;
      const int column = cell % kGridSize;
      const int row = cell / kGridSize;
      std::uint32_t near = 0;
      for (int r = std::max(0, row - 1); r <= std::min(kGridSize - 1, row + 1); ++r) {
        for (int c = std::max(0, column - 1); c <= std::min(kGridSize - 1, column + 1); ++c) {
          near |= reached[r * kGridSize + c];
        }
      }
      const std::uint32_t more = dilated(near, yaw_bins) & occupied[cell] & ~reached[cell];
      reached[cell] |= more;
      grows = grows || more != 0;
    }
  }
  return reached == occupied;
}

}  // namespace racecar_mcl
