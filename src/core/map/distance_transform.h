// The exact Euclidean distance transform of a mask, row by row.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace racecar_mcl {

/// The squared distance, in cells, of each cell of a mask to the nearest cell that is set.
///
/// A. Meijster, J. Roerdink, W. Hesselink: A General Algorithm for Computing Distance Transforms in
/// Linear Time (2000): distances within columns first, from them those within each row. Rows are
/// computed on request, so that the memory is 2 bytes per cell.
class DistanceTransform {
 public:
  static constexpr int kMaxDistance = 32767;  ///< cells
  /// The value of cells that are farther than the maximum distance.
  static constexpr std::uint32_t kFar = std::numeric_limits<std::uint32_t>::max();

  /// `mask`: row-major, cells other than 0 are set. `max_distance`: cells, at most kMaxDistance;
  /// smaller ones are faster. Throws std::invalid_argument if the mask does not match the size.
  DistanceTransform(const std::vector<std::uint8_t>& mask, int width, int height,
                    int max_distance = kMaxDistance);

  /// One row of the result.
  struct Row {
    int row;
    std::size_t first;             ///< index of its first cell in the mask
    const std::uint32_t* squared;  ///< squared distances of its cells, cells; or kFar

    /// cells; infinite if farther than the maximum distance.
    float distance(int column) const {
      return squared[column] == kFar ? std::numeric_limits<float>::infinity()
                                     : std::sqrt(static_cast<float>(squared[column]));
    }
  };
  using RowBody = std::function<void(const Row& row)>;
  /// Calls `body` for each of `rows`, in any order, on several threads.
  void forRows(const std::vector<int>& rows, const RowBody& body) const;
  /// The same for all rows.
  void forEachRow(const RowBody& body) const;

 private:
  struct Envelope;

  void computeColumns(int first, int last);
  void computeRow(int row, Envelope* envelope, std::uint32_t* squared) const;
  void computeRun(const std::uint16_t* distances, int begin, int end, Envelope* envelope,
                  std::uint32_t* squared) const;

  int width_, height_;
  int max_distance_;
  std::vector<std::uint16_t> columns_;  ///< distance within the column, at most max_distance_ + 1
  std::vector<double> half_inverses_;   ///< 1 / (2 i)
};

/// A distance rounded up, at most the maximum of a DistanceTransform.
int wholeCells(double cells);

/// The cells that are not set.
std::vector<std::uint8_t> complement(std::vector<std::uint8_t> mask);

/// The mask dilated by a square of 2 half + 1 cells; cells other than 0 are set. Throws as
/// DistanceTransform.
std::vector<std::uint8_t> dilated(const std::vector<std::uint8_t>& mask, int width, int height,
                                  int half);

}  // namespace racecar_mcl
