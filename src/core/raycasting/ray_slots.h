// State of the rays in flight and the loops that advance them.
//
// Each ray has a slot, with one array per quantity. All loops are plain, so that the compiler can
// vectorize them for every instruction set. Only the loads of clearances stay scalar, which
// measured no slower than gather instructions (docs/decisions.md).
//
// A position is ox + t dx, in cells, with ox counted from a corner `reach` cells before the pose's
// own cell: small enough for float (1.5e-5 cells at 200 cells), and positive, so that truncation
// gives the cell. A step ends `margin` beyond the border, so that it surely reaches another cell; a
// corner that a ray cuts by less is missed. The range is computed from the border of the cell that
// was hit and does not have this error.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "raycasting/ray_march.h"

namespace racecar_mcl {

// Rays in flight: 13 arrays of 4 bytes each, 13 KB, fit into the first-level cache.
constexpr int kSlots = 256;

struct alignas(64) RaySlots {
  // Per ray
  std::array<float, kSlots> ox, oy;  ///< the pose, from the corner
  std::array<float, kSlots> dx, dy;  ///< direction
  std::array<float, kSlots> ix, iy;  ///< 1 / direction
  std::array<int, kSlots> corner;    ///< the corner's index in the field
  std::array<float*, kSlots> range;  ///< output
  // Per step
  std::array<float, kSlots> t;        ///< cells from the pose
  std::array<unsigned, kSlots> cell;  ///< index in the field, at t
  std::array<int, kSlots> clearance;  ///< of the cell
  // Per round
  std::array<float, kSlots> entry;  ///< cells from the pose to where the ray entered the cell
};

/// Constants of a march.
struct MarchFrame {
  explicit MarchFrame(const MarchTask& task)
      : field(task.field.data()),
        row(task.grid.width()),
        last_cell(static_cast<unsigned>(task.grid.width() * task.grid.height() - 1)),
        reach(static_cast<int>(task.limit) + 2),
        limit(static_cast<float>(task.limit)),
        margin(std::max(0x1p-12F, static_cast<float>(reach) * 0x1p-19F)),
        resolution(static_cast<float>(task.grid.resolution())),
        max_range(static_cast<float>(task.max_range)) {}

  const std::uint8_t* field;
  int row;  ///< cells from one row to the next
  unsigned last_cell;
  int reach;     ///< cells from the corner to the pose's cell
  float limit;   ///< cells
  float margin;  ///< cells past a border; eight times the rounding error of a position
  float resolution;
  float max_range;
};

RACECAR_MCL_INLINE bool hasEnded(int clearance) {
  return clearance > ClearanceField::kMaxClearance;
}

/// Advances all rays to another cell, or to the limit.
RACECAR_MCL_INLINE void advance(const MarchFrame& frame, RaySlots& s, int count) {
  const float half = 0.5F + frame.margin;
  const float limit = frame.limit;
  const int field_row = frame.row;
  const unsigned last_cell = frame.last_cell;
  for (int i = 0; i < count; ++i) {
    const float column = static_cast<float>(static_cast<int>(s.ox[i] + s.t[i] * s.dx[i]));
    const float row = static_cast<float>(static_cast<int>(s.oy[i] + s.t[i] * s.dy[i]));
    // The border where a ray leaves its cell is half a cell from the cell's centre.
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

RACECAR_MCL_INLINE void loadClearances(const MarchFrame& frame, RaySlots& s, int count) {
  for (int i = 0; i < count; ++i) s.clearance[i] = frame.field[s.cell[i]];
}

/// Loads clearances, lists the slots of rays that have ended, and returns their number.
RACECAR_MCL_INLINE int loadAndFindEnded(const MarchFrame& frame, RaySlots& s, int count,
                                        int* ended) {
  int found = 0;
  for (int i = 0; i < count; ++i) {
    const int clearance = frame.field[s.cell[i]];
    s.clearance[i] = clearance;
    ended[found] = i;
    found += static_cast<int>(hasEnded(clearance));
  }
  return found;
}

/// Sets the cell of rays at the limit to one of the ring, where rays end.
RACECAR_MCL_INLINE void endAtLimit(const MarchFrame& frame, RaySlots& s, int count) {
  const float limit = frame.limit;
  for (int i = 0; i < count; ++i) s.cell[i] = s.t[i] < limit ? s.cell[i] : 0U;
}

RACECAR_MCL_INLINE void findEntries(RaySlots& s, int count) {
  for (int i = 0; i < count; ++i) {
    const float column = static_cast<float>(static_cast<int>(s.ox[i] + s.t[i] * s.dx[i]));
    const float row = static_cast<float>(static_cast<int>(s.oy[i] + s.t[i] * s.dy[i]));
    const float entry_x = (column + 0.5F - s.ox[i]) * s.ix[i] - 0.5F * std::fabs(s.ix[i]);
    const float entry_y = (row + 0.5F - s.oy[i]) * s.iy[i] - 0.5F * std::fabs(s.iy[i]);
    const float entry = entry_x > entry_y ? entry_x : entry_y;
    s.entry[i] = entry > 0.0F ? entry : 0.0F;  // 0 if the ray starts inside an obstacle
  }
}

RACECAR_MCL_INLINE void writeRange(const MarchFrame& frame, const RaySlots& s, int i) {
  const bool hit = s.clearance[i] == ClearanceField::kHit && s.t[i] < frame.limit;
  *s.range[i] = hit ? s.entry[i] * frame.resolution : frame.max_range;
}

RACECAR_MCL_INLINE void moveRay(RaySlots& s, int to, int from) {
  const auto copy = [&](auto& array) { array[to] = array[from]; };
  copy(s.ox), copy(s.oy), copy(s.dx), copy(s.dy), copy(s.ix), copy(s.iy);
  copy(s.corner), copy(s.range), copy(s.t), copy(s.clearance);
}

/// Puts a stationary ray on the corner of the ring into slot i, so that loops over whole vectors
/// can include unused slots.
RACECAR_MCL_INLINE void park(RaySlots& s, int i) {
  s.ox[i] = s.oy[i] = s.dx[i] = s.dy[i] = s.ix[i] = s.iy[i] = s.t[i] = 0.0F;
  s.corner[i] = 0;
  s.clearance[i] = ClearanceField::kMiss;
}

}  // namespace racecar_mcl
