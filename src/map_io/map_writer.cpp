#include "racecar_mcl/map/map_writer.h"

#include <limits>
#include <sstream>

namespace racecar_mcl {
namespace {

/// As map_saver writes them, for thresholds of 0.65 and 0.196.
char pixelOf(std::int8_t value) {
  const int pixel = value < 0 ? 205 : value < OccupancyGrid::kObstacleFrom ? 254 : 0;
  return static_cast<char>(static_cast<unsigned char>(pixel));
}

}  // namespace

std::string toTrinaryPgm(const OccupancyGrid& map) {
  const GridGeometry& geometry = map.geometry();
  std::string pgm =
      "P5\n" + std::to_string(geometry.width) + " " + std::to_string(geometry.height) + "\n255\n";
  pgm.reserve(pgm.size() + map.cells().size());
  for (int row = geometry.height - 1; row >= 0; --row) {
    for (int column = 0; column < geometry.width; ++column) pgm += pixelOf(map.at({column, row}));
  }
  return pgm;
}

std::string toTrinaryYaml(const GridGeometry& geometry, const std::string& image_name) {
  std::ostringstream yaml;
  yaml.precision(std::numeric_limits<double>::digits10);
  yaml << "image: " << image_name << "\nresolution: " << geometry.resolution << "\norigin: ["
       << geometry.origin.x << ", " << geometry.origin.y << ", " << geometry.origin.yaw
       << "]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
  return yaml.str();
}

}  // namespace racecar_mcl
