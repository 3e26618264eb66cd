#include "sim/map_files.h"

#include <limits>
#include <sstream>

namespace racecar_mcl::sim {
namespace {

/// 255 - value, for `negate: 1`, so that free cells are white.
char pixelOf(std::int8_t value) {
  const int pixel = value < 0 ? 0 : 255 - value;
  return static_cast<char>(static_cast<unsigned char>(pixel));
}

}  // namespace

std::string toPgm(const OccupancyGrid& map) {
  const GridGeometry& geometry = map.geometry();
  std::string pgm =
      "P5\n" + std::to_string(geometry.width) + " " + std::to_string(geometry.height) + "\n255\n";
  pgm.reserve(pgm.size() + map.cells().size());
  for (int row = geometry.height - 1; row >= 0; --row) {
    for (int column = 0; column < geometry.width; ++column) pgm += pixelOf(map.at({column, row}));
  }
  return pgm;
}

std::string toMapYaml(const OccupancyGrid& map, const std::string& image_name) {
  const GridGeometry& geometry = map.geometry();
  std::ostringstream yaml;
  yaml.precision(std::numeric_limits<double>::digits10);
  yaml << "image: " << image_name << "\nmode: raw\nnegate: 1\nresolution: " << geometry.resolution
       << "\norigin: [" << geometry.origin.x << ", " << geometry.origin.y << ", "
       << geometry.origin.yaw << "]\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
  return yaml.str();
}

}  // namespace racecar_mcl::sim
