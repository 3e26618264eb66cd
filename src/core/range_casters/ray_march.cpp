// The rays in flight stand in slots, one array per quantity. Each pass strides once with all of
// them; after a few passes the rays that have ended give their slots to the next ones. All loops
// are plain: the compiler turns them into vector code for each instruction set. Only fetching
// clearances stays scalar, which measured no slower than the processors' gather instructions.
//
// Loops run over whole vectors, so over some slots without a ray. These hold a parked one, which
// stands on the ring and never strides: a slot is always safe to stride with. Every index is held
// inside the field besides, whatever it was computed from.
//
// A position is ox + t dx, in cells, with ox counted from a corner `reach` cells before the pose's
// own cell: small enough for float (1.5e-5 cells at 200 cells), and positive, so that truncation
// finds the cell. To make sure that the next cell is another one, a stride ends `across` beyond the
// border; a corner that a ray clips by less is missed. The range itself comes from the border of
// the cell that was hit and has no such error.
#include "range_casters/ray_march.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "range_casters/beam_directions.h"

namespace racecar_mcl {
namespace {

constexpr double kLongestMarch = 16384.0;  // cells; the rounding of positions grows with it
constexpr int kSlots = 256;          // x 13 arrays x 4 bytes = 13 KB, within the first-level cache
constexpr int kWidest = 16;          // floats in the widest vector
constexpr int kStridesPerRound = 4;  // between two looks for rays that have ended

using Beams = BeamDirections<float>;

struct alignas(64) Slots {
  // Per ray
  std::array<float, kSlots> ox, oy;  ///< the pose, from the corner
  std::array<float, kSlots> dx, dy;  ///< direction
  std::array<float, kSlots> ix, iy;  ///< 1 / direction
  std::array<int, kSlots> corner;    ///< the corner's index in the field
  std::array<float*, kSlots> range;  ///< where the result goes
  // Per stride
  std::array<float, kSlots> t;        ///< cells from the pose
  std::array<unsigned, kSlots> cell;  ///< index in the field at t
  std::array<int, kSlots> clearance;  ///< there
  // Per round
  std::array<float, kSlots> entry;  ///< where the ray came into the cell, cells from the pose
};

/// What is the same for all rays.
struct Frame {
  explicit Frame(const MarchOrder& order)
      : field(order.field.data()),
        row(order.grid.width()),
        last_cell(static_cast<unsigned>(order.grid.width() * order.grid.height() - 1)),
        reach(static_cast<int>(order.limit) + 2),
        limit(static_cast<float>(order.limit)),
        across(std::max(0x1p-12F, static_cast<float>(reach) * 0x1p-19F)),
        resolution(static_cast<float>(order.grid.resolution())),
        max_range(static_cast<float>(order.max_range)) {}

  const std::uint8_t* field;
  int row;  ///< cells from one row to the next
  unsigned last_cell;
  int reach;     ///< cells from the corner to the pose's cell
  float limit;   ///< cells
  float across;  ///< cells; eight times the rounding of a position
  float resolution;
  float max_range;
};

RACECAR_MCL_INLINE bool hasEnded(int clearance) { return clearance > ClearanceField::kLongest; }

/// Moves all rays to where they are sure to be in another cell, or to the limit.
RACECAR_MCL_INLINE void advance(const Frame& frame, Slots& s, int count) {
  const float half = 0.5F + frame.across;
  const float limit = frame.limit;
  const int field_row = frame.row;
  const unsigned last_cell = frame.last_cell;
  for (int i = 0; i < count; ++i) {
    const float column = static_cast<float>(static_cast<int>(s.ox[i] + s.t[i] * s.dx[i]));
    const float row = static_cast<float>(static_cast<int>(s.oy[i] + s.t[i] * s.dy[i]));
    // The border a ray leaves its cell by is half a cell from the cell's centre.
    const float exit_x = (column + 0.5F - s.ox[i]) * s.ix[i] + half * std::fabs(s.ix[i]);
    const float exit_y = (row + 0.5F - s.oy[i]) * s.iy[i] + half * std::fabs(s.iy[i]);
    float t = (exit_x < exit_y ? exit_x : exit_y) + static_cast<float>(s.clearance[i]);
    t = t < limit ? t : limit;
    t = hasEnded(s.clearance[i]) ? s.t[i] : t;
    s.t[i] = t;
    const int cell = s.corner[i] + static_cast<int>(s.oy[i] + t * s.dy[i]) * field_row +
                     static_cast<int>(s.ox[i] + t * s.dx[i]);
    s.cell[i] = std::min(static_cast<unsigned>(cell), last_cell);
  }
}

RACECAR_MCL_INLINE void fetch(const Frame& frame, Slots& s, int count) {
  for (int i = 0; i < count; ++i) s.clearance[i] = frame.field[s.cell[i]];
}

/// Lists the slots of rays that have ended, and returns their number.
RACECAR_MCL_INLINE int fetchAndFindEnded(const Frame& frame, Slots& s, int count, int* ended) {
  int found = 0;
  for (int i = 0; i < count; ++i) {
    const int clearance = frame.field[s.cell[i]];
    s.clearance[i] = clearance;
    ended[found] = i;
    found += static_cast<int>(hasEnded(clearance));
  }
  return found;
}

/// Sends rays at the limit to a cell of the ring, where rays end.
RACECAR_MCL_INLINE void endAtLimit(const Frame& frame, Slots& s, int count) {
  const float limit = frame.limit;
  for (int i = 0; i < count; ++i) s.cell[i] = s.t[i] < limit ? s.cell[i] : 0U;
}

RACECAR_MCL_INLINE void findEntries(Slots& s, int count) {
  for (int i = 0; i < count; ++i) {
    const float column = static_cast<float>(static_cast<int>(s.ox[i] + s.t[i] * s.dx[i]));
    const float row = static_cast<float>(static_cast<int>(s.oy[i] + s.t[i] * s.dy[i]));
    const float entry_x = (column + 0.5F - s.ox[i]) * s.ix[i] - 0.5F * std::fabs(s.ix[i]);
    const float entry_y = (row + 0.5F - s.oy[i]) * s.iy[i] - 0.5F * std::fabs(s.iy[i]);
    const float entry = entry_x > entry_y ? entry_x : entry_y;
    s.entry[i] = entry > 0.0F ? entry : 0.0F;  // 0 where the ray starts in an obstacle
  }
}

RACECAR_MCL_INLINE void writeRange(const Frame& frame, const Slots& s, int i) {
  const bool hit = s.clearance[i] == ClearanceField::kHit && s.t[i] < frame.limit;
  *s.range[i] = hit ? s.entry[i] * frame.resolution : frame.max_range;
}

/// The rays of a cast one after the other, pose by pose.
class Rays {
 public:
  Rays(const MarchOrder& order, const Frame& frame, const Beams& beams)
      : order_(order), frame_(frame), beams_(beams), next_beam_(static_cast<int>(beams.size)) {}

  /// Of the poses so far.
  bool allInMap() const { return all_in_map_; }

  /// Puts the next ray into slot i; false when there is none.
  RACECAR_MCL_INLINE bool next(Slots& s, int i) {
    if (next_beam_ == static_cast<int>(beams_.size) && !nextPose()) return false;
    const int k = next_beam_++;
    s.ox[i] = ox_;
    s.oy[i] = oy_;
    s.dx[i] = dx_[k];
    s.dy[i] = dy_[k];
    s.ix[i] = ix_[k];
    s.iy[i] = iy_[k];
    s.corner[i] = corner_;
    s.range[i] = ranges_ + beams_.index[k];
    s.t[i] = 0.0F;
    s.clearance[i] = clearance_;
    return true;
  }

 private:
  RACECAR_MCL_INLINE bool nextPose() {
    PoseInCells pose;
    while (true) {
      if (selected_ == order_.selection.count) return false;
      pose_ = order_.selection[selected_++];
      pose = order_.grid.toCells(order_.lidar_in_map.pose(pose_));
      if (order_.grid.contains(pose.position) && std::isfinite(pose.cos_yaw)) break;
      all_in_map_ = false;
    }

    const int column = static_cast<int>(pose.position.x());
    const int row = static_cast<int>(pose.position.y());
    const auto reach = static_cast<float>(frame_.reach);
    // Rounding must not carry the pose into the next cell.
    ox_ = std::min(reach + static_cast<float>(pose.position.x() - column),
                   reach + 1.0F - frame_.across);
    oy_ =
        std::min(reach + static_cast<float>(pose.position.y() - row), reach + 1.0F - frame_.across);
    corner_ = (row - frame_.reach) * frame_.row + column - frame_.reach;

    clearance_ = frame_.field[corner_ + frame_.reach * (frame_.row + 1)];
    ranges_ = order_.ranges.col(pose_).data();

    const auto c = static_cast<float>(pose.cos_yaw);
    const auto s = static_cast<float>(pose.sin_yaw);
    const int count = static_cast<int>(beams_.size);
    for (int k = 0; k < count; ++k) {
      constexpr float kLeast = 1e-12F;  // so that 1 / direction stays finite
      const float dx = c * beams_.cosine[k] - s * beams_.sine[k];
      const float dy = s * beams_.cosine[k] + c * beams_.sine[k];
      dx_[k] = std::fabs(dx) < kLeast ? kLeast : dx;
      dy_[k] = std::fabs(dy) < kLeast ? kLeast : dy;
      ix_[k] = 1.0F / dx_[k];
      iy_[k] = 1.0F / dy_[k];
    }
    next_beam_ = 0;
    return true;
  }

  const MarchOrder& order_;
  const Frame& frame_;
  const Beams& beams_;
  Eigen::Index selected_ = 0;
  Eigen::Index pose_ = 0;
  int next_beam_;
  float ox_ = 0.0F;
  float oy_ = 0.0F;
  int corner_ = 0;
  int clearance_ = 0;
  float* ranges_ = nullptr;
  bool all_in_map_ = true;
  alignas(64) std::array<float, Beams::kMost> dx_, dy_, ix_, iy_;
};

RACECAR_MCL_INLINE void move(Slots& s, int to, int from) {
  const auto copy = [&](auto& array) { array[to] = array[from]; };
  copy(s.ox), copy(s.oy), copy(s.dx), copy(s.dy), copy(s.ix), copy(s.iy);
  copy(s.corner), copy(s.range), copy(s.t), copy(s.clearance);
}

/// Puts a ray that stands on the ring's corner into slot i.
RACECAR_MCL_INLINE void park(Slots& s, int i) {
  s.ox[i] = s.oy[i] = s.dx[i] = s.dy[i] = s.ix[i] = s.iy[i] = s.t[i] = 0.0F;
  s.corner[i] = 0;
  s.clearance[i] = ClearanceField::kMiss;
}

RACECAR_MCL_INLINE bool marchAll(const MarchOrder& order) {
  const Frame frame(order);
  Slots slots;
  for (int i = 0; i < kSlots; ++i) park(slots, i);
  std::array<int, kSlots + 1> ended;
  bool all_in_map = true;
  for (Eigen::Index first = 0; first < order.bearings.size();) {
    const Beams beams(order.bearings, first);
    first = beams.end;
    if (beams.size == 0) continue;
    Rays rays(order, frame, beams);
    int count = 0;
    while (count < kSlots && rays.next(slots, count)) ++count;
    while (count > 0) {
      const int whole_vectors = (count + kWidest - 1) / kWidest * kWidest;
      for (int i = 1; i < kStridesPerRound; ++i) {
        advance(frame, slots, whole_vectors);
        fetch(frame, slots, whole_vectors);
      }
      advance(frame, slots, whole_vectors);
      endAtLimit(frame, slots, whole_vectors);
      findEntries(slots, whole_vectors);
      const int found = fetchAndFindEnded(frame, slots, count, ended.data());
      // From the last slot on, so that a slot that fills a gap has itself been seen to.
      for (int k = found - 1; k >= 0; --k) {
        writeRange(frame, slots, ended[k]);
        if (rays.next(slots, ended[k])) continue;
        move(slots, ended[k], --count);
        park(slots, count);
      }
    }
    all_in_map = all_in_map && rays.allInMap();
  }
  return all_in_map;
}

}  // namespace

bool marchServes(const PaddedGrid& grid, double limit) {
  const double farthest_corner = (limit + 3.0) * (grid.width() + 1.0);
  const double cells = static_cast<double>(grid.width()) * grid.height();
  return limit <= kLongestMarch && farthest_corner + cells < std::numeric_limits<int>::max();
}

bool march(InstructionSet set, const MarchOrder& order) {
  bool all_in_map = true;
  runWith(set, [&]() RACECAR_MCL_INLINE_LAMBDA { all_in_map = marchAll(order); });
  return all_in_map;
}

}  // namespace racecar_mcl
