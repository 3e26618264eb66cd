// map_server's files: a YAML that describes an image. The one place that reads maps from disk.
#pragma once

#include <string>

#include "racecar_mcl/occupancy_grid.h"

namespace racecar_mcl {

/// Reads a map_server YAML (image, resolution, origin [x, y, yaw], negate, occupied_thresh,
/// free_thresh, mode trinary | scale | raw) and its image (anything OpenCV reads; a relative path
/// is relative to the YAML). Throws MapError with the file's name and what is wrong with it.
OccupancyGrid loadMap(const std::string& yaml_path);

}  // namespace racecar_mcl
