#include "racecar_mcl/map/map_writer.h"

#include <limits>
#include <sstream>

namespace racecar_mcl {
namespace {

/// As map_saver writes them, for thresholds of 0.65 and 0.196.
int trinaryPixelOf(std::int8_t value) {
  if (value < 0) return 205;
  return value < OccupancyGrid::kObstacleFrom ? 254 : 0;
}

/// For `negate: 1`, so that free cells are white.
int rawPixelOf(std::int8_t value) { return value < 0 ? 0 : 255 - value; }

}  // namespace

std::string toPgm(const OccupancyGrid& map, MapMode mode) {
  const GridGeometry& geometry = map.geometry();
  std::string pgm =
      "P5\n" + std::to_string(geometry.width) + " " + std::to_string(geometry.height) + "\n255\n";
  pgm.reserve(pgm.size() + map.cells().size());
  for (int row = geometry.height - 1; row >= 0; --row) {
    for (int column = 0; column < geometry.width; ++column) {
      const std::int8_t value = map.at({column, row});
      const int pixel = mode == MapMode::kRaw ? rawPixelOf(value) : trinaryPixelOf(value);
      pgm += static_cast<char>(static_cast<unsigned char>(pixel));
    }
  }
  return pgm;
}

std::string toMapYaml(const GridGeometry& geometry, const std::string& image_name, MapMode mode) {
  std::ostringstream yaml;
  yaml.precision(std::numeric_limits<double>::digits10);
  yaml << "image: " << image_name << "\nresolution: " << geometry.resolution << "\norigin: ["
       << geometry.origin.x << ", " << geometry.origin.y << ", " << geometry.origin.yaw << "]\n"
       << (mode == MapMode::kRaw ? "mode: raw\nnegate: 1" : "negate: 0")
       << "\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
  return yaml.str();
}

}  // namespace racecar_mcl
