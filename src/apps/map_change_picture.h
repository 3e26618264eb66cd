// Picture of the changes of a map.
#pragma once

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "image_file.h"
#include "map_changes/map_changes.h"

namespace racecar_mcl {

/// The colour (BGR) of a cell with this value in the map.
inline cv::Vec3b changeColour(std::int8_t value, CellChange change) {
  if (change == CellChange::kNew) return {30, 30, 220};
  if (change == CellChange::kGone) return {230, 90, 0};
  if (change == CellChange::kExplored) return {205, 235, 205};
  if (value < 0) return {225, 225, 225};
  return value < OccupancyGrid::kObstacleFrom ? cv::Vec3b(255, 255, 255) : cv::Vec3b(130, 130, 130);
}

/// The number of each region beside it.
inline void drawNumbers(const GridGeometry& geometry, const MapChanges& changes, int scale,
                        cv::Mat* picture) {
  const double size = picture->cols / 2400.0;
  int number = 0;
  for (const ChangedRegion& region : changes.regions) {
    const Eigen::Vector2d at =
        worldToGrid(geometry, region.centre_in_map) + 0.5 * region.size / geometry.resolution;
    const cv::Point corner(cvRound(scale * at.x()), cvRound(scale * (geometry.height - at.y())));
    cv::putText(*picture, std::to_string(++number), corner, cv::FONT_HERSHEY_SIMPLEX, size,
                cv::Scalar(48, 36, 28), std::max(1, cvRound(size * 1.5)), cv::LINE_AA);
  }
}

/// The map with its changes in colour, and a legend below; one or more pixels per cell, highest row
/// first.
inline cv::Mat drawChanges(const OccupancyGrid& grid, const MapChanges& changes) {
  const GridGeometry& geometry = grid.geometry();
  cv::Mat cells(geometry.height, geometry.width, CV_8UC3);
  std::size_t i = 0;
  for (int row = geometry.height - 1; row >= 0; --row) {
    for (int column = 0; column < geometry.width; ++column, ++i) {
      cells.at<cv::Vec3b>(row, column) = changeColour(grid.cells()[i], changes.cells[i]);
    }
  }
  const int scale = magnificationOf(cells.size());
  cv::Mat picture;
  cv::resize(cells, picture, {}, scale, scale, cv::INTER_NEAREST);
  drawNumbers(geometry, changes, scale, &picture);
  const auto colour = [](CellChange change) { return changeColour(0, change); };
  return withLegend(
      picture,
      drawLegend({{colour(CellChange::kNew), "new"},
                  {colour(CellChange::kGone), "gone"},
                  {colour(CellChange::kExplored), "explored"},
                  {changeColour(OccupancyGrid::kOccupied, CellChange::kConfirmed), "unchanged"}},
                 picture.cols));
}

/// The bytes of a PNG file. Throws std::runtime_error.
inline std::string toPng(const cv::Mat& picture) {
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", picture, bytes)) throw std::runtime_error("the PNG cannot be encoded");
  return {bytes.begin(), bytes.end()};
}

}  // namespace racecar_mcl
