// Each pass advances all rays in flight by one step; after a few passes the slots of rays that have
// ended are given to the next rays. Loops run over whole vectors and therefore over some unused
// slots, which hold a parked ray. All indices are clamped to the field.
#include "raycasting/ray_march.h"

#include <array>
#include <limits>

#include "raycasting/beam_directions.h"
#include "raycasting/ray_generator.h"
#include "raycasting/ray_slots.h"

namespace racecar_mcl {
namespace {

// Maximum range, cells: the rounding error of positions grows with the range.
constexpr double kMaxLimit = 16384.0;
constexpr int kVectorWidth = 16;  // floats in the widest vector
constexpr int kStepsPerPass = 4;  // between two searches for rays that have ended

RACECAR_MCL_INLINE bool marchAll(const MarchTask& task) {
  const MarchFrame frame(task);
  RaySlots slots;
  for (int i = 0; i < kSlots; ++i) park(slots, i);
  std::array<int, kSlots + 1> ended;
  bool all_in_map = true;
  for (Eigen::Index first = 0; first < task.bearings.size();) {
    const BeamDirections<float> beams(task.bearings, first);
    first = beams.end;
    if (beams.size == 0) continue;
    RayGenerator rays(task, frame, beams);
    int count = 0;
    while (count < kSlots && rays.next(slots, count)) ++count;
    while (count > 0) {
      const int whole_vectors = (count + kVectorWidth - 1) / kVectorWidth * kVectorWidth;
      for (int i = 1; i < kStepsPerPass; ++i) {
        advance(frame, slots, whole_vectors);
        loadClearances(frame, slots, whole_vectors);
      }
      advance(frame, slots, whole_vectors);
      endAtLimit(frame, slots, whole_vectors);
      findEntries(slots, whole_vectors);
      const int found = loadAndFindEnded(frame, slots, count, ended.data());
      // From the last slot on, so that a ray that is moved into a gap has been handled already.
      for (int k = found - 1; k >= 0; --k) {
        writeRange(frame, slots, ended[k]);
        if (rays.next(slots, ended[k])) continue;
        moveRay(slots, ended[k], --count);
        park(slots, count);
      }
    }
    all_in_map = all_in_map && rays.allInMap();
  }
  return all_in_map;
}

}  // namespace

bool marchSupports(const PaddedGrid& grid, double limit) {
  const double farthest_corner = (limit + 3.0) * (grid.width() + 1.0);
  const double cells = static_cast<double>(grid.width()) * grid.height();
  return limit <= kMaxLimit && farthest_corner + cells < std::numeric_limits<int>::max();
}

bool march(InstructionSet set, const MarchTask& task) {
  bool all_in_map = true;
  runWith(set, [&]() RACECAR_MCL_INLINE_LAMBDA { all_in_map = marchAll(task); });
  return all_in_map;
}

}  // namespace racecar_mcl
