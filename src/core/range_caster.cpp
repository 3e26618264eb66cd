#include "racecar_mcl/range_caster.h"

#include <cmath>
#include <functional>
#include <sstream>
#include <utility>

#include "racecar_mcl/errors.h"
#include "range_casters/bresenham_caster.h"
#include "range_casters/distance_transform_caster.h"
#include "range_casters/panorama_caster.h"
#include "range_casters/simd_caster.h"

namespace racecar_mcl {
namespace {

using Maker = std::unique_ptr<RangeCaster> (*)(const OccupancyGrid&, const RangeCasterParameters&);

template <typename Caster>
std::unique_ptr<RangeCaster> make(const OccupancyGrid& grid,
                                  const RangeCasterParameters& parameters) {
  return std::make_unique<Caster>(grid, parameters);
}

constexpr std::pair<const char*, Maker> kCasters[] = {
    {"bresenham", make<BresenhamCaster>},
    {"distance_transform", make<DistanceTransformCaster>},
    {"panorama", make<PanoramaCaster>},
    {"simd", make<SimdCaster>},
};

}  // namespace

std::vector<std::string> rangeCasterNames() {
  std::vector<std::string> names;
  for (const auto& [name, maker] : kCasters) names.emplace_back(name);
  return names;
}

std::unique_ptr<RangeCaster> makeRangeCaster(const OccupancyGrid& grid,
                                             const RangeCasterParameters& parameters) {
  if (!std::isfinite(parameters.max_range) || parameters.max_range <= 0.0) {
    std::ostringstream problem;
    problem << "max_range is " << parameters.max_range << " m; it must be positive and finite";
    throw ParameterError(problem.str());
  }
  for (const auto& [name, maker] : kCasters) {
    if (parameters.range_method == name) return maker(grid, parameters);
  }
  std::string known;
  for (const std::string& name : rangeCasterNames()) known += (known.empty() ? "" : ", ") + name;
  throw ParameterError("range_method is \"" + parameters.range_method + "\"; it must be one of " +
                       known);
}

}  // namespace racecar_mcl
