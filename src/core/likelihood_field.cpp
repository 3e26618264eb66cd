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

// A wall at least this thick, m, is drawn thicker than lidars see walls: its true surface may lie
// anywhere inside. Thinner ones are as sharp as the cells.
constexpr double kThickWall = 0.45;

/// A grid's obstacles with a margin of free cells around it, row by row.
struct Obstacles {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> all;
  std::vector<std::uint8_t> surfaces;  ///< those that share a side with a free cell: across
                                       ///< corners, slanting walls would be two cells thick
};

bool touchesFreeSpace(const OccupancyGrid& grid, int column, int row) {
  return grid.isFree({column - 1, row}) || grid.isFree({column + 1, row}) ||
         grid.isFree({column, row - 1}) || grid.isFree({column, row + 1});
}

Obstacles findObstacles(const OccupancyGrid& grid, int margin) {
  const GridGeometry& geometry = grid.geometry();
  Obstacles obstacles;
  obstacles.width = geometry.width + 2 * margin;
  obstacles.height = geometry.height + 2 * margin;
  const auto size =
      static_cast<std::size_t>(obstacles.width) * static_cast<std::size_t>(obstacles.height);
  obstacles.all.assign(size, 0);
  obstacles.surfaces.assign(size, 0);
  // A beam that ends in unknown space has met something the map does not know, whatever rays do
  // there.
  const std::vector<std::uint8_t> mask = obstacleMask(grid, UnknownIs::kFree);
  bool any_surface = false;
  for (int row = 0; row < geometry.height; ++row) {
    for (int column = 0; column < geometry.width; ++column) {
      const auto in_map = static_cast<std::size_t>(row) * static_cast<std::size_t>(geometry.width) +
                          static_cast<std::size_t>(column);
      if (mask[in_map] == 0) continue;
      const auto i =
          static_cast<std::size_t>(row + margin) * static_cast<std::size_t>(obstacles.width) +
          static_cast<std::size_t>(column + margin);
      obstacles.all[i] = 1;
      obstacles.surfaces[i] = touchesFreeSpace(grid, column, row) ? 1 : 0;
      any_surface |= obstacles.surfaces[i] != 0;
    }
  }
  // Walls drawn within the unknown show no surface; then each of their cells stands for one.
  if (!any_surface) obstacles.surfaces = obstacles.all;
  return obstacles;
}

/// The obstacle cells of thick walls: those near a cell as deep inside as half of such a wall.
std::vector<std::uint8_t> insideThickWalls(const Obstacles& obstacles, double resolution) {
  const float half = static_cast<float>(0.5 * kThickWall / resolution);  // cells
  const std::size_t size = obstacles.all.size();
  std::vector<std::uint8_t> open(size), cores(size), inside(size, 0);
  for (std::size_t i = 0; i < size; ++i) open[i] = obstacles.all[i] == 0 ? 1 : 0;
  const std::vector<float> depth = obstacleDistances(open, obstacles.width, obstacles.height);
  bool any_core = false;
  for (std::size_t i = 0; i < size; ++i) {
    cores[i] = obstacles.all[i] != 0 && depth[i] >= half ? 1 : 0;
    any_core |= cores[i] != 0;
  }
  if (!any_core) return inside;
  const std::vector<float> to_core = obstacleDistances(cores, obstacles.width, obstacles.height);
  for (std::size_t i = 0; i < size; ++i) {
    inside[i] = obstacles.all[i] != 0 && to_core[i] < 1.5f * half ? 1 : 0;
  }
  return inside;
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
    : parameters_(parameters),
      geometry_(grid.geometry()),
      max_range_(static_cast<float>(parameters.field_max_range)),
      squash_(static_cast<float>(1.0 / parameters.field_squash)),
      log_rand_(static_cast<float>(std::log(parameters.field_rand))) {
  validate(parameters);
  const double cells_per_sigma = parameters.field_sigma / geometry_.resolution;
  const int margin =
      static_cast<int>(std::ceil(std::min(kMarginSigmas * cells_per_sigma, kWidestMargin)));
  const double shift = -margin * geometry_.resolution;
  geometry_.origin = compose(geometry_.origin, {shift, shift, 0.0});
  const Obstacles obstacles = findObstacles(grid, margin);
  geometry_.width = obstacles.width;
  geometry_.height = obstacles.height;
  log_field_ = obstacleDistances(obstacles.surfaces, geometry_.width, geometry_.height);
  const std::vector<std::uint8_t> inside = insideThickWalls(obstacles, geometry_.resolution);
  for (std::size_t i = 0; i < log_field_.size(); ++i) {
    const double share = inside[i] != 0 ? parameters.field_inside : 1.0;
    const double distance = share * static_cast<double>(log_field_[i]) * geometry_.resolution;
    log_field_[i] = static_cast<float>(logLikelihoodAt(distance));
  }
}

double LikelihoodField::logLikelihoodAt(double distance) const {
  const double sigmas = distance / parameters_.field_sigma;
  return std::log((1.0 - parameters_.field_rand) / (1.0 + sigmas * sigmas) +
                  parameters_.field_rand);
}

Eigen::ArrayXf LikelihoodField::beamLogLikelihoods(const Pose2& lidar_in_map,
                                                   const Scan& beams) const {
  Eigen::ArrayXf log_likelihoods =
      Eigen::ArrayXf::Constant(beams.size(), std::numeric_limits<float>::quiet_NaN());
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
  return log_likelihoods;
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
