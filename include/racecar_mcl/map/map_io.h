// Map files in map_server's format: a YAML description and an image.
#pragma once

#include <string>
#include <vector>

#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl {

/// Reads a map_server YAML (image, resolution, origin [x, y, yaw], negate, occupied_thresh,
/// free_thresh, mode trinary | scale | raw) and its image (anything OpenCV reads; a relative path
/// is relative to the YAML). Throws MapError with the file's name and what is wrong with it.
OccupancyGrid loadMap(const std::string& yaml_path);

/// The files of a map: the YAML and its image. The YAML alone if it cannot be read.
std::vector<std::string> mapFiles(const std::string& yaml_path);

}  // namespace racecar_mcl
