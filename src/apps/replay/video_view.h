// One picture of a running localization: map, particles, scan, car and trail, seen from above.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "racecar_mcl/occupancy_grid.h"
#include "racecar_mcl/particles.h"

namespace racecar_mcl {

/// Colours of the film, blue first as OpenCV has them.
namespace film {
const cv::Scalar kInk(48, 36, 28);
const cv::Scalar kSoft(125, 110, 100);
const cv::Scalar kEstimate(178, 114, 0);
const cv::Scalar kEstimateFill(245, 228, 200);
const cv::Scalar kTruth(0, 0, 0);
const cv::Scalar kScan(0, 94, 213);
const cv::Scalar kPaper(255, 255, 255);

/// From pale (0) to strong (1): how much a particle weighs.
cv::Scalar weightColour(double share);
}  // namespace film

/// What part of the map frame a picture shows: x runs right, y up.
struct Viewport {
  cv::Size size;       ///< pixels
  cv::Point2d centre;  ///< m, map frame
  double pixels_per_metre = 100.0;

  cv::Point2d toPixel(double x, double y) const {
    return {0.5 * size.width + (x - centre.x) * pixels_per_metre,
            0.5 * size.height - (y - centre.y) * pixels_per_metre};
  }
};

/// What is to be seen at one moment.
struct Scene {
  Pose2 base_in_map;             ///< the estimate
  const Pose2* truth = nullptr;  ///< none where it is not known
  const ParticleSet* particles = nullptr;
  Pose2 since_weighing;  ///< the car's motion since the particles were weighed
  const std::vector<cv::Point2d>* scan = nullptr;   ///< end points, map frame
  const std::vector<cv::Point2d>* trail = nullptr;  ///< where the estimate was
  const std::vector<cv::Point2d>* true_trail = nullptr;
};

/// Draws scenes on one map.
class SceneDrawer {
 public:
  explicit SceneDrawer(const OccupancyGrid& grid);

  /// Fills `picture`, which has the viewport's size.
  void draw(const Scene& scene, const Viewport& view, cv::Mat picture) const;

  /// The whole map with a mark at the estimate, for a corner of the picture; at most `limit` pixels
  /// wide and high.
  cv::Mat drawOverview(const Pose2& base_in_map, const Viewport& view, int limit) const;

  /// m, the longer side of the map.
  double mapExtent() const;

 private:
  void drawMap(const Viewport& view, cv::Mat picture) const;

  GridGeometry geometry_;
  cv::Mat cells_;  ///< the map's colours, lowest row first
};

/// Text whose lower left corner is at `at`.
void drawText(cv::Mat picture, const std::string& text, cv::Point at, const cv::Scalar& colour,
              double scale = 0.55);

}  // namespace racecar_mcl
