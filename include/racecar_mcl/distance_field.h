// Distances from cells to obstacles, by OpenCV's distance transform.
#pragma once

#include <cstdint>
#include <vector>

namespace racecar_mcl {

/// For each cell of a row-major `mask` (1 = obstacle) of width x height cells the clearance: the
/// smallest distance, in cells, from any point of the cell to any point of an obstacle cell. It is
/// 0 for obstacle cells and their eight neighbours, and infinite where the mask holds no obstacle.
///
/// Cells whose indices differ by (i, j) are hypot(max(|i| - 1, 0), max(|j| - 1, 0)) apart. That is
/// the distance between the centre of the one and the nearest centre among the 3 x 3 cells around
/// the other: hence Euclid's distance transform of the mask grown by one cell.
///
/// Throws std::invalid_argument on a mask that does not fit the size.
std::vector<float> clearances(const std::vector<std::uint8_t>& mask, int width, int height);

/// For each cell the distance, in cells, from its centre to the nearest obstacle cell's centre;
/// infinite where the mask holds no obstacle. Throws as above.
std::vector<float> obstacleDistances(const std::vector<std::uint8_t>& mask, int width, int height);

}  // namespace racecar_mcl
