// Top view of the localization: map, particles, scan, car and trajectory.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "racecar_mcl/geometry/particle_set.h"
#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl::video {

/// Colours of the video, BGR.
namespace palette {
const cv::Scalar kText(48, 36, 28);
const cv::Scalar kGrey(125, 110, 100);
const cv::Scalar kEstimate(178, 114, 0);
const cv::Scalar kEstimateFill(245, 228, 200);
const cv::Scalar kTruth(0, 0, 0);
const cv::Scalar kScan(0, 94, 213);
const cv::Scalar kBackground(255, 255, 255);

/// From pale (0) to strong (1), by particle weight.
cv::Scalar weightColour(double fraction);
}  // namespace palette

/// The visible part of the map frame; x points right, y up.
struct Viewport {
  cv::Size size;       ///< pixels
  cv::Point2d centre;  ///< m, map frame
  double pixels_per_metre = 100.0;

  cv::Point2d toPixel(double x, double y) const {
    return {0.5 * size.width + (x - centre.x) * pixels_per_metre,
            0.5 * size.height - (y - centre.y) * pixels_per_metre};
  }
};

/// The contents of one frame.
struct MapViewState {
  Pose2 base_in_map;             ///< the estimate
  const Pose2* truth = nullptr;  ///< null if unknown
  const ParticleSet* particles = nullptr;
  Pose2 motion_since_update;                        ///< motion since the particles were updated
  const std::vector<cv::Point2d>* scan = nullptr;   ///< end points, map frame
  const std::vector<cv::Point2d>* trail = nullptr;  ///< past estimates
  const std::vector<cv::Point2d>* true_trail = nullptr;
};

/// Draws the state of a localization onto a map.
class MapView {
 public:
  explicit MapView(const OccupancyGrid& grid);

  /// `picture` must have the viewport's size.
  void draw(const MapViewState& state, const Viewport& view, cv::Mat picture) const;

  /// The whole map with the estimate and the viewport, at most `limit` pixels wide and high.
  cv::Mat drawOverview(const Pose2& base_in_map, const Viewport& view, int limit) const;

  /// The longer side of the map, m.
  double mapExtent() const;

 private:
  void drawMap(const Viewport& view, cv::Mat picture) const;

  GridGeometry geometry_;
  cv::Mat cells_;  ///< map colours, lowest row first
};

/// Draws text with its lower left corner at `at`.
void drawText(cv::Mat picture, const std::string& text, cv::Point at, const cv::Scalar& colour,
              double scale = 0.55);

}  // namespace racecar_mcl::video
