#include "racecar_mcl/likelihood_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "racecar_mcl/distance_field.h"
#include "racecar_mcl/require.h"
#include "vector_math.h"

namespace racecar_mcl {
namespace {

// The field goes on around the map for this many field_sigma, as a wall may stand at its very edge.
constexpr double kMarginSigmas = 4.0;
constexpr double kWidestMargin = 200.0;  // cells

/// A mask with a margin of zeros around it, row by row.
std::vector<std::uint8_t> withMargin(const std::vector<std::uint8_t>& mask,
                                     const GridGeometry& geometry, int margin) {
  const auto width = static_cast<std::size_t>(geometry.width);
  const std::size_t padded_width = width + 2 * static_cast<std::size_t>(margin);
  std::vector<std::uint8_t> padded(
      padded_width * static_cast<std::size_t>(geometry.height + 2 * margin), 0);
  for (int row = 0; row < geometry.height; ++row) {
    std::copy_n(
        mask.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(row) * width), width,
        padded.begin() +
            static_cast<std::ptrdiff_t>(static_cast<std::size_t>(row + margin) * padded_width) +
            margin);
  }
  return padded;
}

/// The field as the inner loops see it.
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

/// Where the lidar is, counted from the centre of the field's first cell, and its direction.
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

/// Where some beams end, in cells, seen from the lidar; each pose then only turns and shifts them.
/// Holds as many as it can of the beams from `first` on that are shorter than `max_range`, m.
struct EndPoints {
  static constexpr int kMost = 256;

  EndPoints(const Scan& beams, Eigen::Index first, float max_range, double resolution)
      : end(first) {
    const auto cells_per_metre = static_cast<float>(1.0 / resolution);
    for (; end < beams.size() && count < kMost; ++end) {
      if (!(beams.ranges[end] < max_range)) continue;
      x[count] = beams.ranges[end] * std::cos(beams.bearings[end]) * cells_per_metre;
      y[count] = beams.ranges[end] * std::sin(beams.bearings[end]) * cells_per_metre;
      index[count++] = end;
    }
  }

  int count = 0;
  Eigen::Index end;  ///< the first beam that was not looked at
  alignas(64) std::array<float, kMost> x, y;
  std::array<Eigen::Index, kMost> index;  ///< which beam of the scan
};

/// Per end point.
using EndValues = std::array<float, EndPoints::kMost>;

/// The field, interpolated, at the end points seen from a lidar. Three loops, for the middle one,
/// which fetches, cannot be vectorised. NaN counts as outside.
RACECAR_MCL_INLINE void valuesAt(const FieldView& field, const LidarInField& lidar,
                                 const EndPoints& ends, EndValues& values) {
  alignas(64) std::array<float, EndPoints::kMost> across, up;
  alignas(64) std::array<int, EndPoints::kMost> cell;
  alignas(64) std::array<std::uint32_t, EndPoints::kMost> is_inside;
  alignas(64) std::array<float, 4 * EndPoints::kMost> corners;
  const int count = ends.count;
  const auto last_column = static_cast<float>(field.width - 1);
  const auto last_row = static_cast<float>(field.height - 1);
  const int cells_per_row = field.width;
  for (int k = 0; k < count; ++k) {
    const float column = lidar.column + lidar.cosine * ends.x[k] - lidar.sine * ends.y[k];
    const float row = lidar.row + lidar.sine * ends.x[k] + lidar.cosine * ends.y[k];
    const bool inside =
        (column >= 0.0F) & (row >= 0.0F) & (column < last_column) & (row < last_row);
    const float held_column = inside ? column : 0.0F;
    const float held_row = inside ? row : 0.0F;
    const int left = static_cast<int>(held_column);
    const int below = static_cast<int>(held_row);
    across[k] = held_column - static_cast<float>(left);
    up[k] = held_row - static_cast<float>(below);
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

/// Sixteen sums side by side, in the same order with every instruction set.
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

void validate(const LikelihoodFieldParameters& p) {
  requireWithin("field_sigma", p.field_sigma, 1e-3, 1e3, "m");
  require(p.field_rand > 0.0 && p.field_rand < 1.0, "field_rand", p.field_rand,
          "above 0 and below 1");
  requirePositiveUpTo("field_max_range", p.field_max_range, 1e4, "m");
  requireWithin("field_squash", p.field_squash, 1e-3, 1e3);
  requireShare("field_inside", p.field_inside);
}

LikelihoodField::LikelihoodField(const OccupancyGrid& grid,
                                 const LikelihoodFieldParameters& parameters)
    : LikelihoodField(grid.geometry(), findSurfaces(grid), parameters) {}

LikelihoodField::LikelihoodField(const GridGeometry& geometry, const Surfaces& surfaces,
                                 const LikelihoodFieldParameters& parameters)
    : parameters_((validate(parameters), parameters)),
      geometry_(geometry),
      max_range_(static_cast<float>(parameters.field_max_range)),
      squash_(static_cast<float>(1.0 / parameters.field_squash)),
      log_rand_(static_cast<float>(std::log(parameters.field_rand))) {
  const double cells_per_sigma = parameters.field_sigma / geometry_.resolution;
  const int margin =
      static_cast<int>(std::ceil(std::min(kMarginSigmas * cells_per_sigma, kWidestMargin)));
  const double shift = -margin * geometry_.resolution;
  geometry_.origin = compose(geometry_.origin, {shift, shift, 0.0});
  geometry_.width += 2 * margin;
  geometry_.height += 2 * margin;
  log_field_ = obstacleDistances(withMargin(surfaces.visible, geometry, margin), geometry_.width,
                                 geometry_.height);
  const std::vector<std::uint8_t> blurred = withMargin(surfaces.blurred, geometry, margin);
  for (std::size_t i = 0; i < log_field_.size(); ++i) {
    const double share = blurred[i] != 0 ? parameters.field_inside : 1.0;
    const double distance = share * static_cast<double>(log_field_[i]) * geometry_.resolution;
    log_field_[i] = static_cast<float>(logLikelihoodAt(distance));
  }
}

double LikelihoodField::logLikelihoodAt(double distance) const {
  const double sigmas = distance / parameters_.field_sigma;
  return std::log((1.0 - parameters_.field_rand) / (1.0 + sigmas * sigmas) +
                  parameters_.field_rand);
}

double LikelihoodField::distanceOf(double log_likelihood) const {
  const double above_rand = std::exp(log_likelihood) - parameters_.field_rand;
  const double ratio = (1.0 - parameters_.field_rand) / std::max(1e-12, above_rand);
  return parameters_.field_sigma * std::sqrt(std::max(0.0, ratio - 1.0));
}

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
        log_likelihood[i] += static_cast<double>(squash_ * sumOf(values, ends.count));
      }
    });
  }
}

}  // namespace racecar_mcl
