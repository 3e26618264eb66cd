#include "racecar_mcl/raycasting/range_caster.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/common/validation.h"
#include "raycasting/bresenham_caster.h"
#include "raycasting/distance_transform_caster.h"
#include "raycasting/lookup_table_caster.h"
#include "raycasting/simd_caster.h"

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
    {"lut", make<LookupTableCaster>},
    {"simd", make<SimdCaster>},
};

}  // namespace

std::vector<std::string> rangeCasterNames() {
  std::vector<std::string> names;
  for (const auto& [name, maker] : kCasters) names.emplace_back(name);
  return names;
}

void validate(const RangeCasterParameters& p) {
  const std::vector<std::string> methods = rangeCasterNames();
  if (std::find(methods.begin(), methods.end(), p.range_method) == methods.end()) {
    std::string problem = "range_method is '" + p.range_method + "'; it must be one of";
    for (const std::string& method : methods) problem += " " + method;
    throw ParameterError(problem);
  }
  requirePositive("max_range", p.max_range, "m");
  requirePositive("lut_spacing", p.lut_spacing, "m");
  requireWithin("lut_directions", p.lut_directions, 16, 16384);
  requireWithin("lut_memory", p.lut_memory, 0.0, 10000.0, "MB");
}

std::unique_ptr<RangeCaster> makeRangeCaster(const OccupancyGrid& grid,
                                             const RangeCasterParameters& parameters) {
  validate(parameters);
  const auto* const caster =
      std::find_if(std::begin(kCasters), std::end(kCasters),
                   [&](const auto& named) { return parameters.range_method == named.first; });
  return caster->second(grid, parameters);
}

}  // namespace racecar_mcl
