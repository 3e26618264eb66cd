// Casters under test, their accuracies and the worlds of the contract tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "racecar_mcl/common/random.h"
#include "racecar_mcl/raycasting/range_caster.h"
#include "raycasting/lookup_table_caster.h"
#include "raycasting/simd_caster.h"

namespace racecar_mcl {

/// Maximum errors of a caster, in cells.
struct Promise {
  double flat_wall;            ///< on flat walls
  double p95;                  ///< 95 % of the rays of a floor plan
  double p999;                 ///< 99.9 % of the rays
  double over_three = 0.0005;  ///< fraction of rays with errors above three cells
  double scattered_p95 = p95;  ///< 95 % of the rays among scattered poles, all edges
};

inline Promise promiseOf(const std::string& name) {
  if (name == "bresenham" || name == "distance_transform") return {1e-4, 1e-3, 1e-3};
  if (name.rfind("lut", 0) == 0) return {0.35, 1.0, 200.0, 0.02, 20.0};
  if (name.rfind("simd", 0) == 0) return {5e-4, 1e-3, 1e-2};
  throw std::invalid_argument("state what " + name + " promises");
}

/// A caster under test: by its public name, or SimdCaster with an instruction set.
struct Subject {
  std::string name;
  std::function<std::unique_ptr<RangeCaster>(const OccupancyGrid&, RangeCasterParameters)> make;
};

inline std::ostream& operator<<(std::ostream& out, const Subject& subject) {
  return out << subject.name;
}

inline std::vector<Subject> subjects() {
  std::vector<Subject> all;
  for (const std::string& name : rangeCasterNames()) {
    all.push_back({name, [name](const OccupancyGrid& grid, RangeCasterParameters parameters) {
                     parameters.range_method = name;
                     return makeRangeCaster(grid, parameters);
                   }});
  }
  for (const InstructionSet set : availableInstructionSets()) {
    all.push_back({std::string("simd_") + nameOf(set),
                   [set](const OccupancyGrid& grid, const RangeCasterParameters& parameters) {
                     return std::make_unique<SimdCaster>(grid, parameters, set);
                   }});
  }
  all.push_back(
      {"lut_at_once", [](const OccupancyGrid& grid, const RangeCasterParameters& parameters) {
         return std::make_unique<LookupTableCaster>(grid, parameters,
                                                    LookupTableCaster::BuildPolicy::kAtOnce);
       }});
  return all;
}

/// Casts single rays.
struct Poses {
  explicit Poses(const std::vector<Pose2>& list) {
    for (const Pose2& pose : list) {
      x.push_back(pose.x);
      y.push_back(pose.y);
      yaw.push_back(pose.yaw);
    }
  }
  PoseBatch batch() const {
    return {x.data(), y.data(), yaw.data(), static_cast<Eigen::Index>(x.size())};
  }
  std::vector<double> x, y, yaw;
};

class RangeCasterContract : public testing::TestWithParam<Subject> {
 protected:
  std::unique_ptr<RangeCaster> makeCaster(const OccupancyGrid& grid, double max_range = 100.0,
                                          UnknownIs unknown_is = UnknownIs::kFree) const {
    RangeCasterParameters parameters;
    parameters.max_range = max_range;
    parameters.unknown_is = unknown_is;
    return GetParam().make(grid, parameters);
  }

  static Eigen::ArrayXXf castAll(RangeCaster& caster, const std::vector<Pose2>& list,
                                 const Eigen::ArrayXf& bearings) {
    const Poses poses(list);
    Eigen::ArrayXXf ranges = Eigen::ArrayXXf::Constant(bearings.size(), poses.batch().size, -1.0F);
    caster.prepare(poses.batch(), bearings);
    caster.cast(poses.batch(), bearings, ranges);
    return ranges;
  }

  static double castOne(RangeCaster& caster, const Pose2& pose) {
    return static_cast<double>(castAll(caster, {pose}, Eigen::ArrayXf::Zero(1))(0, 0));
  }

  double tolerance(double resolution = 1.0) const {
    return promiseOf(GetParam().name).flat_wall * resolution;
  }
};

/// A map with scattered obstacles and unknown cells, and poses in, on the edge of and around it.
struct RandomWorld {
  explicit RandomWorld(std::uint64_t seed, int width, int height) : random(seed) {
    const GridGeometry geometry{width, height, 0.05, {-1.5, 0.7, 0.8}};
    std::vector<std::int8_t> cells(static_cast<std::size_t>(width * height));
    for (std::int8_t& cell : cells) {
      const double chance = random.uniform();
      cell = chance < 0.015  ? OccupancyGrid::kOccupied
             : chance < 0.02 ? OccupancyGrid::kUnknown
                             : OccupancyGrid::kFree;
    }
    grid = std::make_unique<OccupancyGrid>(geometry, std::move(cells));
  }

  std::vector<Pose2> poses(int count, double margin_cells) {
    const GridGeometry& geometry = grid->geometry();
    std::vector<Pose2> list;
    while (static_cast<int>(list.size()) < count) {
      const Eigen::Vector2d point =
          gridToWorld(geometry, {random.uniform(-margin_cells, geometry.width + margin_cells),
                                 random.uniform(-margin_cells, geometry.height + margin_cells)});
      list.push_back({point.x(), point.y(), random.uniform(-4.0, 4.0)});
    }
    return list;
  }

  Random random;
  std::unique_ptr<OccupancyGrid> grid;
};

inline double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

inline Eigen::ArrayXf fan(int count) { return Eigen::ArrayXf::LinSpaced(count, -2.356F, 2.356F); }

/// Two rooms and a corridor, 15 x 10 m, with furniture.
inline OccupancyGrid floorPlan() {
  const GridGeometry geometry{300, 200, 0.05, {2.0, -1.0, -0.4}};
  std::vector<std::int8_t> cells(300 * 200);
  const auto fill = [&](int left, int bottom, int right, int top, std::int8_t value) {
    for (int row = bottom; row < top; ++row) {
      for (int column = left; column < right; ++column) {
        cells[static_cast<std::size_t>(row * 300 + column)] = value;
      }
    }
  };
  fill(0, 0, 300, 200, OccupancyGrid::kOccupied);
  fill(3, 3, 297, 50, OccupancyGrid::kFree);    // corridor
  fill(3, 53, 140, 197, OccupancyGrid::kFree);  // rooms
  fill(143, 53, 297, 197, OccupancyGrid::kFree);
  fill(60, 50, 80, 53, OccupancyGrid::kFree);  // doors
  fill(200, 50, 222, 53, OccupancyGrid::kFree);
  fill(140, 150, 143, 170, OccupancyGrid::kFree);
  for (const auto& [column, row] : {std::pair(30, 90), std::pair(100, 120), std::pair(180, 100),
                                    std::pair(250, 160), std::pair(150, 20)}) {
    fill(column, row, column + 9, row + 6, OccupancyGrid::kOccupied);
  }
  return {geometry, std::move(cells)};
}

}  // namespace racecar_mcl
