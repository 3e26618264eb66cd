// Evaluation of the likelihood field at beam end points.
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "racecar_mcl/sensor/likelihood_field.h"
#include "simd/vector_math.h"

namespace racecar_mcl {
namespace {

constexpr int kLanes = 16;  // of the widest vectors

/// The field in the form that the inner loops need.
struct FieldView {
  FieldView(const std::vector<std::uint16_t>& cells, const GridGeometry& geometry)
      : values(cells.data()),
        width(geometry.width),
        last_column(static_cast<float>(geometry.width - 2)),
        last_row(static_cast<float>(geometry.height - 2)),
        resolution(geometry.resolution),
        map_in_field(inverse(geometry.origin)),
        cosine(std::cos(map_in_field.yaw)),
        sine(std::sin(map_in_field.yaw)) {}

  const std::uint16_t* values;
  int width;
  float last_column, last_row;  ///< with neighbours to the right and above
  double resolution;            ///< m per cell
  Pose2 map_in_field;
  double cosine, sine;  ///< of its yaw
};

/// Pose of the lidar in cells, relative to the centre of the field's first cell.
struct LidarInField {
  RACECAR_MCL_INLINE LidarInField(const FieldView& field, const Pose2& in_map) {
    const double x = field.map_in_field.x + field.cosine * in_map.x - field.sine * in_map.y;
    const double y = field.map_in_field.y + field.sine * in_map.x + field.cosine * in_map.y;
    double yaw_sine, yaw_cosine;
    sinCos(in_map.yaw + field.map_in_field.yaw, &yaw_sine, &yaw_cosine);
    column = static_cast<float>(x / field.resolution - 0.5);
    row = static_cast<float>(y / field.resolution - 0.5);
    cosine = static_cast<float>(yaw_cosine);
    sine = static_cast<float>(yaw_sine);
  }

  float column, row;  ///< cells
  float cosine, sine;
};

/// End points of a block of beams in the lidar's frame, in cells; poses only rotate and translate
/// them. Takes beams shorter than `max_range` (m) from index `first` on, up to the size of the
/// block. Up to a multiple of kLanes it is filled with NaN, which ends outside the field, so that
/// loops over `lanes` need no remainder.
struct EndPoints {
  RACECAR_MCL_INLINE EndPoints(const Scan& beams, Eigen::Index first, float max_range,
                               double resolution)
      : end(first) {
    alignas(64) std::array<float, kBlockSize> range, bearing;
    for (; end < beams.size() && count < kBlockSize; ++end) {
      if (!(beams.ranges[end] < max_range)) continue;
      range[count] = beams.ranges[end];
      bearing[count] = beams.bearings[end];
      index[count++] = end;
    }
    for (int k = count; k < lanes(); ++k) {
      range[k] = std::numeric_limits<float>::quiet_NaN();
      bearing[k] = 0.0F;
    }
    const auto cells_per_metre = static_cast<float>(1.0 / resolution);
    for (int k = 0; k < lanes(); ++k) {
      double sine, cosine;
      sinCos(static_cast<double>(bearing[k]), &sine, &cosine);
      x[k] = range[k] * static_cast<float>(cosine) * cells_per_metre;
      y[k] = range[k] * static_cast<float>(sine) * cells_per_metre;
    }
  }

  int lanes() const { return (count + kLanes - 1) / kLanes * kLanes; }

  int count = 0;
  Eigen::Index end;  ///< index of the first beam after the block
  alignas(64) std::array<float, kBlockSize> x, y;
  std::array<Eigen::Index, kBlockSize> index;  ///< of the beam in the scan
};

/// One value per end point.
using EndValues = std::array<float, kBlockSize>;

/// Bits of the four corners in the word that holds two neighbouring cells.
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
enum Corner { kLowerLeft = 0, kUpperLeft = 8, kLowerRight = 16, kUpperRight = 24 };
#else
enum Corner { kLowerLeft = 16, kUpperLeft = 24, kLowerRight = 0, kUpperRight = 8 };
#endif

RACECAR_MCL_INLINE float byteOf(std::uint32_t corners, Corner corner) {
  return static_cast<float>(static_cast<int>(corners >> corner & 0xffU));
}

/// The index limited to [0, last]; 0 for NaN.
RACECAR_MCL_INLINE float within(float index, float last) {
  const float above = index > 0.0F ? index : 0.0F;
  return above < last ? above : last;
}

/// The bilinearly interpolated field at the end points, in steps above the value of the outside,
/// which cells at the edge of the field have. NaN counts as outside. Three loops, so that the
/// arithmetic is vectorized where the loads from scattered cells are not.
RACECAR_MCL_INLINE void stepsAt(const FieldView& field, const LidarInField& lidar,
                                const EndPoints& ends, EndValues& steps) {
  alignas(64) std::array<float, kBlockSize> across, up;
  alignas(64) std::array<int, kBlockSize> cell;
  alignas(64) std::array<std::uint32_t, kBlockSize> corners;
  const int count = ends.lanes();
  const int cells_per_row = field.width;
  for (int k = 0; k < count; ++k) {
    const float column =
        within(lidar.column + lidar.cosine * ends.x[k] - lidar.sine * ends.y[k], field.last_column);
    const float row =
        within(lidar.row + lidar.sine * ends.x[k] + lidar.cosine * ends.y[k], field.last_row);
    const int left = static_cast<int>(column);
    const int below = static_cast<int>(row);
    across[k] = column - static_cast<float>(left);
    up[k] = row - static_cast<float>(below);
    cell[k] = below * cells_per_row + left;
  }
  for (int k = 0; k < count; ++k) {
    std::memcpy(&corners[k], field.values + cell[k], sizeof(corners[k]));
  }
  for (int k = 0; k < count; ++k) {
    const float lower_left = byteOf(corners[k], kLowerLeft);
    const float upper_left = byteOf(corners[k], kUpperLeft);
    const float lower = lower_left + across[k] * (byteOf(corners[k], kLowerRight) - lower_left);
    const float upper = upper_left + across[k] * (byteOf(corners[k], kUpperRight) - upper_left);
    steps[k] = lower + up[k] * (upper - lower);
  }
}

/// Partial sums in the same order for every instruction set. `count`: a multiple of kLanes.
RACECAR_MCL_INLINE float sumOf(const EndValues& values, int count) {
  // A vector type, since compilers keep an array of partial sums in memory.
  using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));
  Lanes sums = {};
  for (int k = 0; k < count; k += kLanes) {
    Lanes next;
    std::memcpy(&next, &values[k], sizeof(next));
    sums += next;
  }
  std::array<float, kLanes / 2> halves;
  for (int lane = 0; lane < kLanes / 2; ++lane) halves[lane] = sums[lane] + sums[lane + kLanes / 2];
  std::array<float, kLanes / 4> quarters;
  for (int lane = 0; lane < kLanes / 4; ++lane) {
    quarters[lane] = halves[lane] + halves[lane + kLanes / 4];
  }
  return (quarters[0] + quarters[2]) + (quarters[1] + quarters[3]);
}

}  // namespace

Eigen::ArrayXf LikelihoodField::beamLogLikelihoods(const Pose2& lidar_in_map,
                                                   const Scan& beams) const {
  Eigen::ArrayXf log_likelihoods(beams.size());
  beamLogLikelihoods(batchOf(lidar_in_map), beams, log_likelihoods);
  return log_likelihoods;
}

void LikelihoodField::beamLogLikelihoods(const PoseBatch& lidar_in_map, const Scan& beams,
                                         Eigen::Ref<Eigen::ArrayXXf> log_likelihoods) const {
  log_likelihoods.setConstant(std::numeric_limits<float>::quiet_NaN());
  const FieldView field(cells_, geometry_);
  for (Eigen::Index first = 0; first < beams.size();) {
    runWith(fastestInstructionSet(), [&]() RACECAR_MCL_INLINE_LAMBDA {
      const EndPoints ends(beams, first, max_range_, geometry_.resolution);
      first = ends.end;
      alignas(64) EndValues steps;
      for (Eigen::Index i = 0; i < lidar_in_map.size; ++i) {
        stepsAt(field, LidarInField(field, lidar_in_map.pose(i)), ends, steps);
        for (int k = 0; k < ends.count; ++k) {
          log_likelihoods(ends.index[k], i) = log_rand_ + log_step_ * steps[k];
        }
      }
    });
  }
}

void LikelihoodField::logLikelihood(const PoseBatch& lidar_in_map, const Scan& beams,
                                    Eigen::Ref<Eigen::ArrayXd> log_likelihood) const {
  log_likelihood.setZero();
  const FieldView field(cells_, geometry_);
  for (Eigen::Index first = 0; first < beams.size();) {
    runWith(fastestInstructionSet(), [&]() RACECAR_MCL_INLINE_LAMBDA {
      const EndPoints ends(beams, first, max_range_, geometry_.resolution);
      first = ends.end;
      const float outside = static_cast<float>(ends.count) * log_rand_;
      alignas(64) EndValues steps;
      for (Eigen::Index i = 0; i < lidar_in_map.size; ++i) {
        stepsAt(field, LidarInField(field, lidar_in_map.pose(i)), ends, steps);
        const float sum = outside + log_step_ * sumOf(steps, ends.lanes());
        log_likelihood[i] += static_cast<double>(exponent_ * sum);
      }
    });
  }
}

}  // namespace racecar_mcl
