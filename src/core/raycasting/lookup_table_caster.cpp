#include "raycasting/lookup_table_caster.h"

#include <algorithm>
#include <cmath>

#include "raycasting/cast_each.h"

namespace racecar_mcl {
namespace {

constexpr std::uint16_t kNoObstacle = 65535;  // code of a ray that hits no obstacle
constexpr float kMaxCode = 65534.0F;          // largest code of a ray that hits one

/// An angle, modulo a full turn, as a number of directions in [0, directions).
float toDirections(double angle, int directions) {
  const double turns = angle / (2.0 * kPi);
  // Rounding to float must not give a full turn.
  return static_cast<float>(std::min((turns - std::floor(turns)) * directions, directions - 0.01));
}

/// A block of bearings of a cast as directions relative to the heading, plus half a direction, so
/// that truncation of the sum with a heading rounds to the nearest one.
struct BeamOffsets {
  BeamOffsets(const Eigen::ArrayXf& bearings, Eigen::Index first, int directions)
      : size(static_cast<int>(std::min<Eigen::Index>(kBlockSize, bearings.size() - first))) {
    for (int k = 0; k < size; ++k) {
      const double bearing = static_cast<double>(bearings[first + k]);
      offset[k] =
          std::isfinite(bearing) ? toDirections(bearing + kPi / directions, directions) : 0.0F;
    }
  }

  int size;
  std::array<float, kBlockSize> offset;
};

/// The lookups of one pose. Three loops, since the middle one cannot be vectorized.
RACECAR_MCL_INLINE void lookUp(const std::uint16_t* row, int directions, float heading,
                               const BeamOffsets& beams, float metres_per_code, float max_range,
                               float* ranges) {
  std::array<int, kBlockSize> code;
  const int size = beams.size;
  for (int k = 0; k < size; ++k) {
    const int beyond = static_cast<int>(heading + beams.offset[k]);  // in [0, 2 directions)
    code[k] = beyond >= directions ? beyond - directions : beyond;
  }
  for (int k = 0; k < size; ++k) code[k] = row[code[k]];
  const float max_coded = kMaxCode * metres_per_code;
  for (int k = 0; k < size; ++k) {
    const float metres = static_cast<float>(code[k]) * metres_per_code;
    ranges[k] = metres <= max_coded ? metres : max_range;
  }
}

}  // namespace

LookupTableCaster::LookupTableCaster(const OccupancyGrid& grid,
                                     const RangeCasterParameters& parameters,
                                     BuildPolicy build_policy)
    : RangeCaster(parameters.max_range),
      geometry_(grid.geometry()),
      exact_(grid, parameters),
      metres_per_code_(
          static_cast<float>(std::min(maxRange(), std::hypot(geometry_.width, geometry_.height) *
                                                      geometry_.resolution) /
                             kMaxCode)),
      build_policy_(build_policy),
      positions_per_cell_(static_cast<int>(std::clamp(
          std::ceil(geometry_.resolution / parameters.lut_spacing - 1e-6), 1.0, 1000.0))),
      directions_((parameters.lut_directions + kSectors - 1) / kSectors * kSectors),
      cache_(static_cast<std::size_t>(parameters.lut_memory * 1e6), directions_),
      sector_bearings_(directions_ / kSectors),
      x_(kRowsPerCast * kSectors),
      y_(kRowsPerCast * kSectors),
      yaw_(kRowsPerCast * kSectors),
      sector_ranges_(directions_ / kSectors, kRowsPerCast * kSectors) {
  for (int k = 0; k < directions_ / kSectors; ++k) {
    sector_bearings_[k] = static_cast<float>(2.0 * kPi * k / directions_);
  }
}

bool LookupTableCaster::discretize(const Pose2& lidar_in_map, std::uint64_t& position) const {
  if (!std::isfinite(lidar_in_map.yaw)) return false;
  const Eigen::Vector2d point = exact_.grid().position(lidar_in_map);
  if (!exact_.grid().contains(point)) return false;
  const auto column = static_cast<std::uint64_t>(point.x() * positions_per_cell_);
  const auto row = static_cast<std::uint64_t>(point.y() * positions_per_cell_);
  position = row << 32U | column;
  return true;
}

Pose2 LookupTableCaster::centreOf(std::uint64_t position) const {
  const Eigen::Vector2d index(static_cast<double>(position & 0xFFFFFFFFU),
                              static_cast<double>(position >> 32U));
  const Eigen::Vector2d padded = (index.array() + 0.5) / positions_per_cell_;
  const Eigen::Vector2d centre = gridToWorld(geometry_, padded.array() - 1.0);
  return {centre.x(), centre.y(), geometry_.origin.yaw};
}

void LookupTableCaster::fill(LookupTableCache::Slot* const* slots, std::size_t count) {
  Eigen::Index pose = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Pose2 centre = centreOf(slots[i]->position);
    for (int sector = 0; sector < kSectors; ++sector, ++pose) {
      x_[pose] = centre.x;
      y_[pose] = centre.y;
      yaw_[pose] = centre.yaw + 2.0 * kPi * sector / kSectors;
    }
  }
  exact_.cast({x_.data(), y_.data(), yaw_.data(), pose}, sector_bearings_,
              sector_ranges_.leftCols(pose));
  const auto max_range = static_cast<float>(maxRange());
  const float codes_per_metre = 1.0F / metres_per_code_;
  for (std::size_t i = 0; i < count; ++i) {
    // Consecutive sectors are the directions in order.
    const float* metres = sector_ranges_.data() + i * static_cast<std::size_t>(directions_);
    std::uint16_t* codes = cache_.ranges(*slots[i]);
    for (int k = 0; k < directions_; ++k) {
      const int code = static_cast<int>(std::min(metres[k] * codes_per_metre + 0.5F, kMaxCode));
      codes[k] = static_cast<std::uint16_t>(metres[k] < max_range ? code : kNoObstacle);
    }
    slots[i]->is_filled = true;
  }
}

void LookupTableCaster::prepare(const PoseBatch& lidar_in_map, const Eigen::ArrayXf& bearings) {
  ++update_;
  const bool at_once = build_policy_ == BuildPolicy::kAtOnce;
  const auto rays_per_pose = static_cast<std::uint32_t>(bearings.size());
  const std::uint32_t min_rays = at_once ? 0 : static_cast<std::uint32_t>(directions_) / 4;
  // Filling never takes more rays than casting all rays exactly.
  Eigen::Index affordable =
      at_once ? lidar_in_map.size : lidar_in_map.size * bearings.size() / directions_;
  std::array<LookupTableCache::Slot*, kRowsPerCast> queue;
  std::size_t queued = 0;
  const auto fillQueue = [&] {
    fill(queue.data(), queued);
    queued = 0;
  };
  for (Eigen::Index i = 0; i < lidar_in_map.size; ++i) {
    std::uint64_t position = 0;
    if (!discretize(lidar_in_map.pose(i), position)) continue;
    LookupTableCache::Slot* slot = cache_.claim(position, update_);
    if (slot == nullptr || slot->is_filled) continue;
    slot->rays_requested += rays_per_pose;
    if (slot->rays_requested < min_rays || affordable == 0) continue;
    slot->is_filled = true;  // true when `prepare` returns
    --affordable;
    queue[queued++] = slot;
    if (queued == kRowsPerCast) fillQueue();
  }
  fillQueue();
}

void LookupTableCaster::cast(const PoseBatch& lidar_in_map, const Eigen::ArrayXf& bearings,
                             Eigen::Ref<Eigen::ArrayXXf> ranges) const {
  requireShape(lidar_in_map, bearings, ranges);
  const auto max_range = static_cast<float>(maxRange());
  for (Eigen::Index first = 0; first < lidar_in_map.size; first += kBlockSize) {
    const Eigen::Index last = std::min<Eigen::Index>(first + kBlockSize, lidar_in_map.size);
    std::array<Eigen::Index, kBlockSize> known;
    std::array<const std::uint16_t*, kBlockSize> row;
    std::array<float, kBlockSize> heading;
    std::array<Eigen::Index, kBlockSize> missing;
    std::size_t known_count = 0;
    std::size_t missing_count = 0;
    for (Eigen::Index i = first; i < last; ++i) {
      const Pose2 pose = lidar_in_map.pose(i);
      const std::uint16_t* row_of_pose = rowAt(pose);
      if (row_of_pose == nullptr) {
        missing[missing_count++] = i;
        continue;
      }
      known[known_count] = i;
      row[known_count] = row_of_pose;
      heading[known_count++] = toDirections(pose.yaw - geometry_.origin.yaw, directions_);
    }
    exact_.castSelected(lidar_in_map, {missing.data(), static_cast<Eigen::Index>(missing_count)},
                        bearings, ranges);
    for (Eigen::Index from = 0; from < bearings.size(); from += kBlockSize) {
      const BeamOffsets beams(bearings, from, directions_);
      runWith(fastestInstructionSet(), [&]() RACECAR_MCL_INLINE_LAMBDA {
        for (std::size_t i = 0; i < known_count; ++i) {
          lookUp(row[i], directions_, heading[i], beams, metres_per_code_, max_range,
                 &ranges(from, known[i]));
        }
      });
    }
  }
  for (Eigen::Index k = 0; k < bearings.size(); ++k) {
    if (!std::isfinite(bearings[k])) ranges.row(k).setConstant(max_range);
  }
}

const std::uint16_t* LookupTableCaster::rowAt(const Pose2& lidar_in_map) const {
  std::uint64_t position = 0;
  if (!discretize(lidar_in_map, position)) return nullptr;
  const LookupTableCache::Slot* slot = cache_.find(position);
  return slot != nullptr && slot->is_filled ? cache_.ranges(*slot) : nullptr;
}

std::size_t LookupTableCaster::memoryBytes() const {
  return sizeof(*this) + exact_.memoryBytes() + cache_.memoryBytes();
}

}  // namespace racecar_mcl
