#include "sim/wall_surfaces.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <unordered_set>

namespace racecar_mcl::sim {
namespace {

constexpr double kMaxThinWall = 0.25;    // m; such walls are erased completely
constexpr double kMaxErasedDepth = 1.0;  // m, for thicker walls

int stepsIn(double length, const GridGeometry& geometry) {
  return std::max(0, static_cast<int>(std::lround(length / geometry.resolution)));
}

}  // namespace

WallSurfaces::WallSurfaces(const OccupancyGrid& map)
    : map_(map),
      cells_(map.cells()),
      is_surface_(cells_.size(), 0),
      owner_(cells_.size(), 0),
      depth_(cells_.size(), UINT16_MAX) {
  const CellIndex index(map_.geometry());
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (!isOccupied(cells_[i])) continue;
    const auto around = neighbours(index.cell(i));
    if (std::none_of(around.begin(), around.begin() + 4,
                     [&](const Cell& cell) { return map_.isFree(cell); })) {
      continue;
    }
    surface_.push_back(i);
    is_surface_[i] = 1;
    owner_[i] = static_cast<std::uint32_t>(i);
    depth_[i] = 0;
  }
  const int deepest = stepsIn(kMaxErasedDepth, map_.geometry()) + 1;
  std::vector<std::size_t> queue = surface_;
  for (std::size_t k = 0; k < queue.size(); ++k) {
    if (depth_[queue[k]] >= deepest) continue;
    // Direct neighbours only: diagonal steps would propagate owners along the wall.
    const auto around = neighbours(index.cell(queue[k]));
    for (auto next = around.begin(); next != around.begin() + 4; ++next) {
      if (!isOccupied(map_.at(*next)) || depth_[index(*next)] != UINT16_MAX) continue;
      owner_[index(*next)] = owner_[queue[k]];
      depth_[index(*next)] = static_cast<std::uint16_t>(depth_[queue[k]] + 1);
      queue.push_back(index(*next));
    }
  }
}

std::size_t WallSurfaces::surfaceLeft() const {
  return static_cast<std::size_t>(
      std::count_if(surface_.begin(), surface_.end(), [&](std::size_t i) { return !isErased(i); }));
}

template <typename Among>
std::vector<std::size_t> WallSurfaces::reach(const std::vector<std::size_t>& from, int steps,
                                             Among&& among) const {
  const CellIndex index(map_.geometry());
  std::unordered_set<std::size_t> seen(from.begin(), from.end());
  std::vector<std::size_t> reached = from;
  std::size_t begin = 0;
  for (int step = 0; step < steps && begin < reached.size(); ++step) {
    const std::size_t end = reached.size();
    for (std::size_t k = begin; k < end; ++k) {
      for (const Cell& next : neighbours(index.cell(reached[k]))) {
        if (!contains(map_.geometry(), next) || isErased(index(next))) continue;
        if (among(index(next)) && seen.insert(index(next)).second) reached.push_back(index(next));
      }
    }
    begin = end;
  }
  return reached;
}

std::int8_t WallSurfaces::behind(const std::vector<std::size_t>& erased) const {
  const CellIndex index(map_.geometry());
  const std::unordered_set<std::size_t> gone(erased.begin(), erased.end());
  const int thin = stepsIn(kMaxThinWall, map_.geometry());
  for (const std::size_t i : erased) {
    for (const Cell& next : neighbours(index.cell(i))) {
      if (!contains(map_.geometry(), next)) return OccupancyGrid::kUnknown;
      if (gone.count(index(next)) != 0) continue;
      const bool deep = isOccupied(cells_[index(next)]) && depth_[index(next)] > thin;
      if (cells_[index(next)] < 0 || deep) return OccupancyGrid::kUnknown;
    }
  }
  return OccupancyGrid::kFree;
}

void WallSurfaces::erase(std::size_t centre, double length) {
  const GridGeometry& geometry = map_.geometry();
  const std::vector<std::size_t> segment =
      reach({centre}, stepsIn(length / 2.0 - kMaxThinWall, geometry),
            [&](std::size_t cell) { return is_surface_[cell] != 0; });
  std::vector<std::size_t> erased =
      reach(segment, stepsIn(kMaxThinWall, geometry), [](std::size_t) { return true; });
  std::unordered_set<std::size_t> owners;
  std::copy_if(erased.begin(), erased.end(), std::inserter(owners, owners.end()),
               [&](std::size_t cell) { return is_surface_[cell] != 0; });
  const std::vector<std::size_t> deep =
      reach(erased, stepsIn(kMaxErasedDepth, geometry), [&](std::size_t cell) {
        return depth_[cell] != UINT16_MAX && owners.count(owner_[cell]) != 0;
      });
  erased.insert(erased.end(), deep.begin(), deep.end());
  const std::int8_t value = behind(erased);
  for (const std::size_t cell : erased) cells_[cell] = value;
}

}  // namespace racecar_mcl::sim
