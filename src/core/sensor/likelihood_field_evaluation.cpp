// Evaluation of the likelihood field at beam end points.
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "racecar_mcl/sensor/likelihood_field.h"
#include "simd/vector_math.h"

namespace racecar_mcl {
namespace {

/// The field in the form that the inner loops need.
struct FieldView {
  FieldView(const std::vector<float>& log_field, const GridGeometry& geometry, float log_outside)
      : values(log_field.data()),
        width(geometry.width),
        height(geometry.height),
        outside(log_outside),
        resolution(geometry.resolution),
        map_in_field(inverse(geometry.origin)),
        cosine(std::cos(map_in_field.yaw)),
        sine(std::sin(map_in_field.yaw)) {}

  const float* values;
  int width;
  int height;
  float outside;      ///< the value beyond the field
  double resolution;  ///< m per cell
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
/// block.
struct EndPoints {
  EndPoints(const Scan& beams, Eigen::Index first, float max_range, double resolution)
      : end(first) {
    const auto cells_per_metre = static_cast<float>(1.0 / resolution);
    for (; end < beams.size() && count < kBlockSize; ++end) {
      if (!(beams.ranges[end] < max_range)) continue;
      x[count] = beams.ranges[end] * std::cos(beams.bearings[end]) * cells_per_metre;
      y[count] = beams.ranges[end] * std::sin(beams.bearings[end]) * cells_per_metre;
      index[count++] = end;
    }
  }

  int count = 0;
  Eigen::Index end;  ///< index of the first beam after the block
  alignas(64) std::array<float, kBlockSize> x, y;
  std::array<Eigen::Index, kBlockSize> index;  ///< of the beam in the scan
};

/// One value per end point.
using EndValues = std::array<float, kBlockSize>;

/// The bilinearly interpolated field at the end points. Three loops, since the middle one, which
/// loads from memory, cannot be vectorized. NaN counts as outside.
RACECAR_MCL_INLINE void valuesAt(const FieldView& field, const LidarInField& lidar,
                                 const EndPoints& ends, EndValues& values) {
  alignas(64) std::array<float, kBlockSize> across, up;
  alignas(64) std::array<int, kBlockSize> cell;
  alignas(64) std::array<std::uint32_t, kBlockSize> is_inside;
  alignas(64) std::array<float, 4 * kBlockSize> corners;
  const int count = ends.count;
  const auto last_column = static_cast<float>(field.width - 1);
  const auto last_row = static_cast<float>(field.height - 1);
  const int cells_per_row = field.width;
  for (int k = 0; k < count; ++k) {
    const float column = lidar.column + lidar.cosine * ends.x[k] - lidar.sine * ends.y[k];
    const float row = lidar.row + lidar.sine * ends.x[k] + lidar.cosine * ends.y[k];
    const bool inside =
        (column >= 0.0F) & (row >= 0.0F) & (column < last_column) & (row < last_row);
    const float inside_column = inside ? column : 0.0F;
    const float inside_row = inside ? row : 0.0F;
    const int left = static_cast<int>(inside_column);
    const int below = static_cast<int>(inside_row);
    across[k] = inside_column - static_cast<float>(left);
    up[k] = inside_row - static_cast<float>(below);
    cell[k] = below * cells_per_row + left;
    is_inside[k] = inside ? 1U : 0U;
  }
  for (int k = 0; k < count; ++k) {
    const float* lower = field.values + cell[k];
    std::memcpy(&corners[4 * k], lower, 2 * sizeof(float));
    std::memcpy(&corners[4 * k + 2], lower + cells_per_row, 2 * sizeof(float));
  }
  for (int k = 0; k < count; ++k) {
    const float lower = corners[4 * k] + across[k] * (corners[4 * k + 1] - corners[4 * k]);
    const float upper = corners[4 * k + 2] + across[k] * (corners[4 * k + 3] - corners[4 * k + 2]);
    const float inside = lower + up[k] * (upper - lower);
    values[k] = is_inside[k] != 0 ? inside : field.outside;
  }
}

/// Sixteen partial sums, in the same order for every instruction set.
RACECAR_MCL_INLINE float sumOf(const EndValues& values, int count) {
  constexpr int kLanes = 16;
  alignas(64) std::array<float, kLanes> lanes = {};
  int k = 0;
  for (; k + kLanes <= count; k += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) lanes[lane] += values[k + lane];
  }
  for (int lane = 0; k < count; ++k, ++lane) lanes[lane] += values[k];
  for (int width = kLanes / 2; width > 0; width /= 2) {
    for (int lane = 0; lane < width; ++lane) lanes[lane] += lanes[lane + width];
  }
  return lanes[0];
}

}  // namespace

Eigen::ArrayXf LikelihoodField::beamLogLikelihoods(const Pose2& lidar_in_map,
                                                   const Scan& beams) const {
  Eigen::ArrayXf log_likelihoods(beams.size());
  beamLogLikelihoods(lidar_in_map, beams, log_likelihoods);
  return log_likelihoods;
}

void LikelihoodField::beamLogLikelihoods(const Pose2& lidar_in_map, const Scan& beams,
                                         Eigen::Ref<Eigen::ArrayXf> log_likelihoods) const {
  log_likelihoods.setConstant(std::numeric_limits<float>::quiet_NaN());
  const FieldView field(log_field_, geometry_, log_rand_);
  for (Eigen::Index first = 0; first < beams.size();) {
    const EndPoints ends(beams, first, max_range_, geometry_.resolution);
    first = ends.end;
    alignas(64) EndValues values;
    runWith(fastestInstructionSet(), [&]() RACECAR_MCL_INLINE_LAMBDA {
      valuesAt(field, LidarInField(field, lidar_in_map), ends, values);
    });
    for (int k = 0; k < ends.count; ++k) log_likelihoods[ends.index[k]] = values[k];
  }
}

void LikelihoodField::logLikelihood(const PoseBatch& lidar_in_map, const Scan& beams,
                                    Eigen::Ref<Eigen::ArrayXd> log_likelihood) const {
  log_likelihood.setZero();
  const FieldView field(log_field_, geometry_, log_rand_);
  for (Eigen::Index first = 0; first < beams.size();) {
    const EndPoints ends(beams, first, max_range_, geometry_.resolution);
    first = ends.end;
    runWith(fastestInstructionSet(), [&]() RACECAR_MCL_INLINE_LAMBDA {
      alignas(64) EndValues values;
      for (Eigen::Index i = 0; i < lidar_in_map.size; ++i) {
        valuesAt(field, LidarInField(field, lidar_in_map.pose(i)), ends, values);
        log_likelihood[i] += static_cast<double>(exponent_ * sumOf(values, ends.count));
      }
    });
  }
}

}  // namespace racecar_mcl
