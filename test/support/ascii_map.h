// Maps as text: '#' occupied, '.' free, '?' unknown; the top line is the highest row.
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl {

/// Reads a grid from lines of '#', '.' and '?'. Blanks around the lines and empty lines do not
/// count, so a raw string can be indented:
///
///     const OccupancyGrid grid = asciiMap(R"(
///         #####
///         #..?#
///         #####)", 0.05, {-1.0, 2.0, kPi / 2});
inline OccupancyGrid asciiMap(const std::string& drawing, double resolution = 1.0,
                              const Pose2& origin = {}) {
  std::vector<std::string> lines;
  std::istringstream words(drawing);
  for (std::string line; words >> line;) lines.push_back(line);

  std::vector<std::int8_t> cells;
  for (auto line = lines.rbegin(); line != lines.rend(); ++line) {
    if (line->size() != lines.front().size()) {
      throw std::invalid_argument("the drawing's lines differ in length");
    }
    for (const char symbol : *line) {
      if (symbol == '#') {
        cells.push_back(OccupancyGrid::kOccupied);
      } else if (symbol == '.') {
        cells.push_back(OccupancyGrid::kFree);
      } else if (symbol == '?') {
        cells.push_back(OccupancyGrid::kUnknown);
      } else {
        throw std::invalid_argument(std::string("the drawing holds '") + symbol +
                                    "'; expected #, . or ?");
      }
    }
  }
  const int width = lines.empty() ? 0 : static_cast<int>(lines.front().size());
  return OccupancyGrid({width, static_cast<int>(lines.size()), resolution, origin},
                       std::move(cells));
}

/// The text of a grid, one line per row, for readable comparisons.
inline std::string toAscii(const OccupancyGrid& grid) {
  std::string drawing;
  for (int row = grid.geometry().height - 1; row >= 0; --row) {
    for (int column = 0; column < grid.geometry().width; ++column) {
      const std::int8_t value = grid.at({column, row});
      drawing += value < 0 ? '?' : grid.isFree({column, row}) ? '.' : '#';
    }
    drawing += '\n';
  }
  return drawing;
}

}  // namespace racecar_mcl
