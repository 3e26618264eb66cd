#include "range_casters/panorama_caster.h"

#include <algorithm>
#include <cmath>

#include "range_casters/cast_each.h"

namespace racecar_mcl {
namespace {

constexpr std::uint16_t kNothing = 65535;  // the code of a ray that meets no obstacle
constexpr float kLongest = 65534.0F;       // the largest code of one that does

/// An angle as a number of directions in [0, directions), whole turns left out.
float toDirections(double angle, int directions) {
  const double turns = angle / (2.0 * kPi);
  // Rounding to float must not make it a whole turn.
  return static_cast<float>(std::min((turns - std::floor(turns)) * directions, directions - 0.01));
}

/// Some consecutive bearings of a cast as directions from the heading; half a direction is added,
/// so that truncating the sum with a heading rounds it to nearest.
struct BeamTurns {
  static constexpr Eigen::Index kMost = 256;

  BeamTurns(const Eigen::ArrayXf& bearings, Eigen::Index first, int directions)
      : size(static_cast<int>(std::min(kMost, bearings.size() - first))) {
    for (int k = 0; k < size; ++k) {
      const double bearing = static_cast<double>(bearings[first + k]);
      turn[k] =
          std::isfinite(bearing) ? toDirections(bearing + kPi / directions, directions) : 0.0F;
    }
  }

  int size;
  std::array<float, kMost> turn;
};

/// The look-ups of one pose. Three loops, for the middle one cannot be vectorised.
RACECAR_MCL_INLINE void lookUp(const std::uint16_t* panorama, int directions, float heading,
                               const BeamTurns& beams, float metres_per_code, float max_range,
                               float* ranges) {
  std::array<int, BeamTurns::kMost> code;
  const int size = beams.size;
  for (int k = 0; k < size; ++k) {
    const int beyond = static_cast<int>(heading + beams.turn[k]);  // in [0, 2 directions)
    code[k] = beyond >= directions ? beyond - directions : beyond;
  }
  for (int k = 0; k < size; ++k) code[k] = panorama[code[k]];
  const float longest = kLongest * metres_per_code;
  for (int k = 0; k < size; ++k) {
    const float metres = static_cast<float>(code[k]) * metres_per_code;
    ranges[k] = metres <= longest ? metres : max_range;
  }
}

}  // namespace

PanoramaCaster::PanoramaCaster(const OccupancyGrid& grid, const RangeCasterParameters& parameters,
                               Thrift thrift)
    : geometry_(grid.geometry()),
      exact_(grid, parameters),
      max_range_(parameters.max_range),
      metres_per_code_(
          static_cast<float>(std::min(max_range_, std::hypot(geometry_.width, geometry_.height) *
                                                      geometry_.resolution) /
                             kLongest)),
      thrift_(thrift),
      places_per_cell_(static_cast<int>(std::clamp(
          std::ceil(geometry_.resolution / parameters.panorama_spacing - 1e-6), 1.0, 1000.0))),
      directions_((parameters.panorama_directions + kSectors - 1) / kSectors * kSectors),
      cache_(static_cast<std::size_t>(parameters.panorama_memory * 1e6), directions_),
      sector_bearings_(directions_ / kSectors),
      x_(kBuiltTogether * kSectors),
      y_(kBuiltTogether * kSectors),
      yaw_(kBuiltTogether * kSectors),
      sector_ranges_(directions_ / kSectors, kBuiltTogether * kSectors) {
  for (int k = 0; k < directions_ / kSectors; ++k) {
    sector_bearings_[k] = static_cast<float>(2.0 * kPi * k / directions_);
  }
}

bool PanoramaCaster::placeOf(const Pose2& lidar_in_map, std::uint64_t& place) const {
  if (!std::isfinite(lidar_in_map.yaw)) return false;
  const Eigen::Vector2d position = exact_.grid().position(lidar_in_map);
  if (!exact_.grid().contains(position)) return false;
  const auto column = static_cast<std::uint64_t>(position.x() * places_per_cell_);
  const auto row = static_cast<std::uint64_t>(position.y() * places_per_cell_);
  place = row << 32U | column;
  return true;
}

Pose2 PanoramaCaster::centreOf(std::uint64_t place) const {
  const Eigen::Vector2d index(static_cast<double>(place & 0xFFFFFFFFU),
                              static_cast<double>(place >> 32U));
  const Eigen::Vector2d padded = (index.array() + 0.5) / places_per_cell_;
  const Eigen::Vector2d centre = gridToWorld(geometry_, padded.array() - 1.0);
  return {centre.x(), centre.y(), geometry_.origin.yaw};
}

void PanoramaCaster::build(PanoramaCache::Slot* const* slots, std::size_t count) {
  Eigen::Index pose = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Pose2 centre = centreOf(slots[i]->place);
    for (int sector = 0; sector < kSectors; ++sector, ++pose) {
      x_[pose] = centre.x;
      y_[pose] = centre.y;
      yaw_[pose] = centre.yaw + 2.0 * kPi * sector / kSectors;
    }
  }
  exact_.cast({x_.data(), y_.data(), yaw_.data(), pose}, sector_bearings_,
              sector_ranges_.leftCols(pose));
  const auto max_range = static_cast<float>(max_range_);
  const float codes_per_metre = 1.0F / metres_per_code_;
  for (std::size_t i = 0; i < count; ++i) {
    // Sectors side by side are the directions in order.
    const float* metres = sector_ranges_.data() + i * static_cast<std::size_t>(directions_);
    std::uint16_t* codes = cache_.ranges(*slots[i]);
    for (int k = 0; k < directions_; ++k) {
      const int code = static_cast<int>(std::min(metres[k] * codes_per_metre + 0.5F, kLongest));
      codes[k] = static_cast<std::uint16_t>(metres[k] < max_range ? code : kNothing);
    }
    slots[i]->built = true;
  }
}

void PanoramaCaster::prepare(const PoseBatch& lidar_in_map, const Eigen::ArrayXf& bearings) {
  ++round_;
  const bool at_once = thrift_ == Thrift::kAtOnce;
  const auto rays_per_pose = static_cast<std::uint32_t>(bearings.size());
  const std::uint32_t enough = at_once ? 0 : static_cast<std::uint32_t>(directions_) / 4;
  // Building never costs more than casting all rays exactly would.
  Eigen::Index affordable =
      at_once ? lidar_in_map.size : lidar_in_map.size * bearings.size() / directions_;
  std::array<PanoramaCache::Slot*, kBuiltTogether> queue;
  std::size_t queued = 0;
  const auto buildQueue = [&] {
    build(queue.data(), queued);
    queued = 0;
  };
  for (Eigen::Index i = 0; i < lidar_in_map.size; ++i) {
    std::uint64_t place = 0;
    if (!placeOf(lidar_in_map.pose(i), place)) continue;
    PanoramaCache::Slot* slot = cache_.claim(place, round_);
    if (slot == nullptr || slot->built) continue;
    slot->rays_wanted += rays_per_pose;
    if (slot->rays_wanted < enough || affordable == 0) continue;
    slot->built = true;  // is, before `prepare` ends
    --affordable;
    queue[queued++] = slot;
    if (queued == kBuiltTogether) buildQueue();
  }
  buildQueue();
}

void PanoramaCaster::cast(const PoseBatch& lidar_in_map, const Eigen::ArrayXf& bearings,
                          Eigen::Ref<Eigen::ArrayXXf> ranges) const {
  requireShape(lidar_in_map, bearings, ranges);
  const auto max_range = static_cast<float>(max_range_);
  constexpr Eigen::Index kBlock = 256;
  for (Eigen::Index first = 0; first < lidar_in_map.size; first += kBlock) {
    const Eigen::Index last = std::min(first + kBlock, lidar_in_map.size);
    std::array<Eigen::Index, kBlock> remembered;
    std::array<const std::uint16_t*, kBlock> panorama;
    std::array<float, kBlock> heading;
    std::array<Eigen::Index, kBlock> unknown;
    std::size_t remembered_count = 0;
    std::size_t unknown_count = 0;
    for (Eigen::Index i = first; i < last; ++i) {
      const Pose2 pose = lidar_in_map.pose(i);
      const std::uint16_t* ranges_there = panoramaAt(pose);
      if (ranges_there == nullptr) {
        unknown[unknown_count++] = i;
        continue;
      }
      remembered[remembered_count] = i;
      panorama[remembered_count] = ranges_there;
      heading[remembered_count++] = toDirections(pose.yaw - geometry_.origin.yaw, directions_);
    }
    exact_.castSelected(lidar_in_map, {unknown.data(), static_cast<Eigen::Index>(unknown_count)},
                        bearings, ranges);
    for (Eigen::Index from = 0; from < bearings.size(); from += BeamTurns::kMost) {
      const BeamTurns beams(bearings, from, directions_);
      runWith(fastestInstructionSet(), [&]() RACECAR_MCL_INLINE_LAMBDA {
        for (std::size_t i = 0; i < remembered_count; ++i) {
          lookUp(panorama[i], directions_, heading[i], beams, metres_per_code_, max_range,
                 &ranges(from, remembered[i]));
        }
      });
    }
  }
  for (Eigen::Index k = 0; k < bearings.size(); ++k) {
    if (!std::isfinite(bearings[k])) ranges.row(k).setConstant(max_range);
  }
}

const std::uint16_t* PanoramaCaster::panoramaAt(const Pose2& lidar_in_map) const {
  std::uint64_t place = 0;
  if (!placeOf(lidar_in_map, place)) return nullptr;
  const PanoramaCache::Slot* slot = cache_.find(place);
  return slot != nullptr && slot->built ? cache_.ranges(*slot) : nullptr;
}

std::size_t PanoramaCaster::memoryBytes() const {
  return sizeof(*this) + exact_.memoryBytes() + cache_.memoryBytes();
}

}  // namespace racecar_mcl
