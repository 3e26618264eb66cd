// Distance transforms of obstacle masks.
#pragma once

#include <cstdint>
#include <vector>

namespace racecar_mcl {

/// The clearance of each cell of a row-major `mask` (1 = obstacle) of width x height cells: the
/// smallest distance, in cells, from any point of the cell to any point of an obstacle cell. It is
/// 0 for obstacle cells and their eight neighbours, and infinite if no obstacle is within 32767
/// cells.
///
/// The distance of cells whose indices differ by (i, j) is hypot(max(|i| - 1, 0), max(|j| - 1, 0)):
/// the distance between the centre of one cell and the nearest centre among the 3 x 3 cells around
/// the other. It is therefore the Euclidean distance transform of the mask dilated by one cell.
///
/// Throws std::invalid_argument if the mask does not match the size.
std::vector<float> clearances(const std::vector<std::uint8_t>& mask, int width, int height);

/// The distance of each cell, in cells, from its centre to the nearest obstacle cell's centre;
/// infinite if the mask has no obstacle within 32767 cells. Throws as above.
std::vector<float> obstacleDistances(const std::vector<std::uint8_t>& mask, int width, int height);

}  // namespace racecar_mcl
