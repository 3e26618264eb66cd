// YAML descriptions of map files.
#pragma once

#include <filesystem>
#include <string>

#include "racecar_mcl/geometry/pose2.h"

namespace racecar_mcl {

/// The content of the YAML file.
struct MapDescription {
  /// Conversion of pixels to cells, as in map_server.
  enum class Mode { kTrinary, kScale, kRaw };

  std::filesystem::path image;
  double resolution = 0.0;  ///< m per cell
  Pose2 origin;
  bool negate = false;
  double occupied_threshold = 0.0;
  double free_threshold = 0.0;
  Mode mode = Mode::kTrinary;
};

/// Throws MapError, "`what` ...", unless the path is a regular file (no directory, pipe or device).
void requireRegularFile(const std::filesystem::path& path, const std::string& what);

/// Reads and checks a description. Throws MapError with the file, the line, the key and the
/// expected value.
MapDescription readMapDescription(const std::filesystem::path& path);

}  // namespace racecar_mcl
