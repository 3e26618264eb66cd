#include "video_view.h"

#include <algorithm>
#include <numeric>
#include <opencv2/imgproc.hpp>

namespace racecar_mcl {
namespace {

// Lines are placed to 1/16 of a pixel, so that nothing jitters from frame to frame.
constexpr int kShift = 4;

// The car's outline about base_link, the rear axle (m).
constexpr double kAhead = 0.42, kBehind = 0.10, kHalfWidth = 0.14;
constexpr double kArrow = 0.14;  // m, a particle

cv::Point fixed(const cv::Point2d& pixel) {
  // Far off the picture the fixed-point numbers would overflow.
  const auto clip = [](double value) { return std::clamp(value, -3e4, 3e4); };
  return {cvRound(clip(pixel.x) * (1 << kShift)), cvRound(clip(pixel.y) * (1 << kShift))};
}

void drawPath(const std::vector<cv::Point2d>& path, const Viewport& view, const cv::Scalar& colour,
              int thickness, cv::Mat picture) {
  std::vector<cv::Point> pixels;
  pixels.reserve(path.size());
  for (const cv::Point2d& point : path) pixels.push_back(fixed(view.toPixel(point.x, point.y)));
  cv::polylines(picture, pixels, false, colour, thickness, cv::LINE_AA, kShift);
}

/// `fill` is none for an outline alone.
void drawCar(const Pose2& base_in_map, const Viewport& view, const cv::Scalar& colour,
             const cv::Scalar* fill, cv::Mat picture) {
  std::vector<cv::Point> outline;
  for (const Pose2& corner : {Pose2{kAhead, 0.0, 0.0}, Pose2{0.7 * kAhead, kHalfWidth, 0.0},
                              Pose2{-kBehind, kHalfWidth, 0.0}, Pose2{-kBehind, -kHalfWidth, 0.0},
                              Pose2{0.7 * kAhead, -kHalfWidth, 0.0}}) {
    const Pose2 in_map = compose(base_in_map, corner);
    outline.push_back(fixed(view.toPixel(in_map.x, in_map.y)));
  }
  if (fill != nullptr) cv::fillConvexPoly(picture, outline, *fill, cv::LINE_AA, kShift);
  cv::polylines(picture, outline, true, colour, 2, cv::LINE_AA, kShift);
}

void drawParticles(const Scene& scene, const Viewport& view, cv::Mat picture) {
  const ParticleSet& particles = *scene.particles;
  if (particles.size() == 0) return;
  std::vector<Eigen::Index> order(static_cast<std::size_t>(particles.size()));
  std::iota(order.begin(), order.end(), 0);
  // The heaviest last, on top.
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return particles.log_weight[a] < particles.log_weight[b];
  });
  const double heaviest = particles.log_weight.maxCoeff();
  for (const Eigen::Index i : order) {
    const Pose2 tail = compose(particles.pose(i), scene.since_weighing);
    const cv::Point2d from = view.toPixel(tail.x, tail.y);
    if (from.x < -20.0 || from.y < -20.0 || from.x > view.size.width + 20.0 ||
        from.y > view.size.height + 20.0) {
      continue;
    }
    const Pose2 tip = compose(tail, {kArrow, 0.0, 0.0});
    cv::line(picture, fixed(from), fixed(view.toPixel(tip.x, tip.y)),
             film::weightColour(std::exp(particles.log_weight[i] - heaviest)), 1, cv::LINE_AA,
             kShift);
  }
}

}  // namespace

cv::Scalar film::weightColour(double share) {
  const cv::Scalar pale(205, 185, 150), strong(110, 0, 160);
  return pale + std::clamp(share, 0.0, 1.0) * (strong - pale);
}

void drawText(cv::Mat picture, const std::string& text, cv::Point at, const cv::Scalar& colour,
              double scale) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, colour, 1, cv::LINE_AA);
}

SceneDrawer::SceneDrawer(const OccupancyGrid& grid)
    : geometry_(grid.geometry()), cells_(geometry_.height, geometry_.width, CV_8UC3) {
  for (int row = 0; row < geometry_.height; ++row) {
    for (int column = 0; column < geometry_.width; ++column) {
      const Cell cell{column, row};
      cv::Vec3b colour(255, 255, 255);
      if (grid.at(cell) == OccupancyGrid::kUnknown) {
        colour = {234, 231, 228};
      } else if (!grid.isFree(cell)) {
        colour = {77, 77, 77};
      }
      cells_.at<cv::Vec3b>(row, column) = colour;
    }
  }
}

double SceneDrawer::mapExtent() const {
  return std::max(geometry_.width, geometry_.height) * geometry_.resolution;
}

void SceneDrawer::drawMap(const Viewport& view, cv::Mat picture) const {
  // From the centre of cell (i, j) to the picture, by three of its images.
  const auto toPicture = [&](double column, double row) {
    const Eigen::Vector2d point = gridToWorld(geometry_, {column + 0.5, row + 0.5});
    const cv::Point2d pixel = view.toPixel(point.x(), point.y());
    return cv::Point2f(static_cast<float>(pixel.x), static_cast<float>(pixel.y));
  };
  // Far apart, for the sake of the floats they come in.
  const float w = static_cast<float>(geometry_.width), h = static_cast<float>(geometry_.height);
  const cv::Point2f cells[] = {{0, 0}, {w, 0}, {0, h}};
  const cv::Point2f pixels[] = {toPicture(0, 0), toPicture(geometry_.width, 0),
                                toPicture(0, geometry_.height)};
  const bool magnified = geometry_.resolution * view.pixels_per_metre >= 2.0;
  cv::warpAffine(cells_, picture, cv::getAffineTransform(cells, pixels), picture.size(),
                 magnified ? cv::INTER_NEAREST : cv::INTER_LINEAR, cv::BORDER_CONSTANT,
                 cv::Scalar(234, 231, 228));
}

void SceneDrawer::draw(const Scene& scene, const Viewport& view, cv::Mat picture) const {
  drawMap(view, picture);
  if (scene.true_trail != nullptr) drawPath(*scene.true_trail, view, film::kTruth, 1, picture);
  if (scene.trail != nullptr) drawPath(*scene.trail, view, film::kEstimate, 2, picture);
  if (scene.scan != nullptr) {
    for (const cv::Point2d& point : *scene.scan) {
      cv::circle(picture, fixed(view.toPixel(point.x, point.y)), 2 << kShift, film::kScan,
                 cv::FILLED, cv::LINE_AA, kShift);
    }
  }
  drawCar(scene.base_in_map, view, film::kEstimate, &film::kEstimateFill, picture);
  if (scene.truth != nullptr) drawCar(*scene.truth, view, film::kTruth, nullptr, picture);
  if (scene.particles != nullptr) drawParticles(scene, view, picture);
}

cv::Mat SceneDrawer::drawOverview(const Pose2& base_in_map, const Viewport& view, int limit) const {
  const double scale =
      std::min(1.0, static_cast<double>(limit) / std::max(geometry_.width, geometry_.height));
  cv::Mat small, overview;
  cv::resize(cells_, small, {}, scale, scale, cv::INTER_AREA);
  cv::flip(small, overview, 0);
  const auto toOverview = [&](double x, double y) {
    const Eigen::Vector2d grid = worldToGrid(geometry_, {x, y});
    return fixed({grid.x() * scale, overview.rows - grid.y() * scale});
  };
  const double half_width = 0.5 * view.size.width / view.pixels_per_metre;
  const double half_height = 0.5 * view.size.height / view.pixels_per_metre;
  std::vector<cv::Point> shown;
  for (const auto& [right, up] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    shown.push_back(
        toOverview(view.centre.x + right * half_width, view.centre.y + up * half_height));
  }
  cv::polylines(overview, shown, true, film::kEstimate, 1, cv::LINE_AA, kShift);
  cv::circle(overview, toOverview(base_in_map.x, base_in_map.y), 4 << kShift, film::kEstimate,
             cv::FILLED, cv::LINE_AA, kShift);
  cv::rectangle(overview, {0, 0}, {overview.cols - 1, overview.rows - 1}, film::kSoft);
  return overview;
}

}  // namespace racecar_mcl
