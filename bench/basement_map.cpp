#include "basement_map.h"

#include <algorithm>
#include <utility>

#include "racecar_mcl/common/random.h"

namespace racecar_mcl::bench {
namespace {

constexpr int kWidth = 1730;
constexpr int kHeight = 1300;
constexpr int kMargin = 60;

class Draft {
 public:
  explicit Draft(std::uint64_t seed)
      : random_(seed), cells_(kWidth * kHeight, OccupancyGrid::kUnknown) {}

  int between(int low, int high) {
    return low + static_cast<int>(random_.index(static_cast<std::uint64_t>(high - low + 1)));
  }

  void fill(int left, int bottom, int right, int top, std::int8_t value) {
    for (int row = std::max(bottom, kMargin); row < std::min(top, kHeight - kMargin); ++row) {
      for (int column = std::max(left, kMargin); column < std::min(right, kWidth - kMargin);
           ++column) {
        at(column, row) = value;
      }
    }
  }

  /// A corridor along one axis, with alcoves and pillars at its sides.
  void corridor(int left, int bottom, int right, int top) {
    fill(left, bottom, right, top, OccupancyGrid::kFree);
    const bool lies = right - left > top - bottom;
    for (int along = 80; along < (lies ? right - left : top - bottom) - 80;
         along += between(90, 260)) {
      const int length = between(8, 60);
      const int depth = between(6, 24);
      const bool low_side = random_.uniform() < 0.5;
      const bool alcove = random_.uniform() < 0.6;
      const int pillar = between(6, 10);
      const int start = (lies ? left : bottom) + along;
      const int low = lies ? bottom : left;
      const int high = lies ? top : right;
      const int from = alcove ? (low_side ? low - depth : high) : (low_side ? low : high - pillar);
      const int to = alcove ? (low_side ? low : high + depth) : from + pillar;
      const int end = start + (alcove ? length : pillar);
      const std::int8_t value = alcove ? OccupancyGrid::kFree : OccupancyGrid::kOccupied;
      lies ? fill(start, from, end, to, value) : fill(from, start, to, end, value);
    }
  }

  /// A room with boxes.
  void room(int left, int bottom, int right, int top) {
    fill(left, bottom, right, top, OccupancyGrid::kFree);
    const int boxes = (right - left) * (top - bottom) / 5000;
    for (int i = 0; i < boxes; ++i) {
      const int column = between(left + 6, right - 20);
      const int row = between(bottom + 6, top - 20);
      fill(column, row, column + between(3, 16), row + between(3, 16), OccupancyGrid::kOccupied);
    }
  }

  /// Rough walls around known space, as in real maps.
  void raiseWalls() {
    const std::vector<std::int8_t> before = cells_;
    for (int row = 3; row < kHeight - 3; ++row) {
      for (int column = 3; column < kWidth - 3; ++column) {
        if (before[index(column, row)] != OccupancyGrid::kUnknown) continue;
        const int reach = random_.uniform() < 0.8 ? 2 : 3;
        for (int i = -reach; i <= reach; ++i) {
          for (int j = -reach; j <= reach; ++j) {
            if (before[index(column + i, row + j)] == OccupancyGrid::kFree) {
              at(column, row) = OccupancyGrid::kOccupied;
            }
          }
        }
      }
    }
    for (int row = 3; row < kHeight - 3; ++row) {
      for (int column = 3; column < kWidth - 3; ++column) {
        const bool beside_wall = before[index(column, row)] == OccupancyGrid::kFree &&
                                 (before[index(column - 1, row)] == OccupancyGrid::kUnknown ||
                                  before[index(column + 1, row)] == OccupancyGrid::kUnknown ||
                                  before[index(column, row - 1)] == OccupancyGrid::kUnknown ||
                                  before[index(column, row + 1)] == OccupancyGrid::kUnknown);
        if (beside_wall && random_.uniform() < 0.15) at(column, row) = OccupancyGrid::kOccupied;
      }
    }
  }

  OccupancyGrid finish() && {
    return {GridGeometry{kWidth, kHeight, 0.05, {-20.0, -15.0, 0.1}}, std::move(cells_)};
  }

 private:
  static std::size_t index(int column, int row) {
    return static_cast<std::size_t>(row * kWidth + column);
  }
  std::int8_t& at(int column, int row) { return cells_[index(column, row)]; }

  Random random_;
  std::vector<std::int8_t> cells_;
};

}  // namespace

OccupancyGrid basementMap(std::uint64_t seed) {
  Draft draft(seed);
  // Rooms first, so that corridors cut through their clutter.
  for (const auto& [column, row] :
       {std::pair(180, 150), std::pair(560, 170), std::pair(1010, 140), std::pair(1330, 420),
        std::pair(170, 640), std::pair(620, 560), std::pair(950, 830), std::pair(1300, 880)}) {
    draft.room(column, row, column + draft.between(120, 280), row + draft.between(120, 240));
  }
  for (const int row : {100, 430, 780, 1150}) {
    draft.corridor(90, row, kWidth - 90, row + draft.between(40, 60));
  }
  for (const int column : {100, 480, 880, 1240, 1580}) {
    draft.corridor(column, 90, column + draft.between(40, 60), kHeight - 90);
  }
  draft.raiseWalls();
  return std::move(draft).finish();
}

}  // namespace racecar_mcl::bench
