#include "offline/video/map_view.h"

#include <algorithm>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "sim/car.h"

namespace racecar_mcl::video {
namespace {

// Fixed-point coordinates in 1/16 pixel, which avoid jitter between frames.
constexpr int kShift = 4;

constexpr double kParticleLength = 0.14;  // m

cv::Point fixed(const cv::Point2d& pixel) {
  // Far outside the picture, fixed-point coordinates would overflow.
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

/// `fill`: null for the outline only.
void drawCar(const Pose2& base_in_map, const Viewport& view, const cv::Scalar& colour,
             const cv::Scalar* fill, cv::Mat picture) {
  const sim::CarParameters car;
  const double front = car.length_ahead, rear = -car.length_behind, half_width = car.width / 2.0;
  std::vector<cv::Point> outline;
  for (const Pose2& corner :
       {Pose2{front, 0.0, 0.0}, Pose2{0.7 * front, half_width, 0.0}, Pose2{rear, half_width, 0.0},
        Pose2{rear, -half_width, 0.0}, Pose2{0.7 * front, -half_width, 0.0}}) {
    const Pose2 in_map = compose(base_in_map, corner);
    outline.push_back(fixed(view.toPixel(in_map.x, in_map.y)));
  }
  if (fill != nullptr) cv::fillConvexPoly(picture, outline, *fill, cv::LINE_AA, kShift);
  cv::polylines(picture, outline, true, colour, 2, cv::LINE_AA, kShift);
}

void drawParticles(const MapViewState& state, const Viewport& view, cv::Mat picture) {
  const ParticleSet& particles = *state.particles;
  if (particles.size() == 0) return;
  std::vector<Eigen::Index> order(static_cast<std::size_t>(particles.size()));
  std::iota(order.begin(), order.end(), 0);
  // In order of weight, so that the heaviest are on top.
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return particles.log_weight[a] < particles.log_weight[b];
  });
  const double heaviest = particles.log_weight.maxCoeff();
  for (const Eigen::Index i : order) {
    const Pose2 tail = compose(particles.pose(i), state.motion_since_update);
    const cv::Point2d from = view.toPixel(tail.x, tail.y);
    if (from.x < -20.0 || from.y < -20.0 || from.x > view.size.width + 20.0 ||
        from.y > view.size.height + 20.0) {
      continue;
    }
    const Pose2 tip = compose(tail, {kParticleLength, 0.0, 0.0});
    cv::line(picture, fixed(from), fixed(view.toPixel(tip.x, tip.y)),
             palette::weightColour(std::exp(particles.log_weight[i] - heaviest)), 1, cv::LINE_AA,
             kShift);
  }
}

}  // namespace

cv::Scalar palette::weightColour(double fraction) {
  const cv::Scalar pale(205, 185, 150), strong(110, 0, 160);
  return pale + std::clamp(fraction, 0.0, 1.0) * (strong - pale);
}

void drawText(cv::Mat picture, const std::string& text, cv::Point at, const cv::Scalar& colour,
              double scale) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, colour, 1, cv::LINE_AA);
}

MapView::MapView(const OccupancyGrid& grid)
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

double MapView::mapExtent() const {
  return std::max(geometry_.width, geometry_.height) * geometry_.resolution;
}

void MapView::drawMap(const Viewport& view, cv::Mat picture) const {
  // The affine transform from cell centres to pixels, from three points.
  const auto toPicture = [&](double column, double row) {
    const Eigen::Vector2d point = gridToWorld(geometry_, {column + 0.5, row + 0.5});
    const cv::Point2d pixel = view.toPixel(point.x(), point.y());
    return cv::Point2f(static_cast<float>(pixel.x), static_cast<float>(pixel.y));
  };
  // Far apart, for accuracy in single precision.
  const float w = static_cast<float>(geometry_.width), h = static_cast<float>(geometry_.height);
  const cv::Point2f cells[] = {{0, 0}, {w, 0}, {0, h}};
  const cv::Point2f pixels[] = {toPicture(0, 0), toPicture(geometry_.width, 0),
                                toPicture(0, geometry_.height)};
  const bool magnified = geometry_.resolution * view.pixels_per_metre >= 2.0;
  cv::warpAffine(cells_, picture, cv::getAffineTransform(cells, pixels), picture.size(),
                 magnified ? cv::INTER_NEAREST : cv::INTER_LINEAR, cv::BORDER_CONSTANT,
                 cv::Scalar(234, 231, 228));
}

void MapView::draw(const MapViewState& state, const Viewport& view, cv::Mat picture) const {
  drawMap(view, picture);
  if (state.true_trail != nullptr) drawPath(*state.true_trail, view, palette::kTruth, 1, picture);
  if (state.trail != nullptr) drawPath(*state.trail, view, palette::kEstimate, 2, picture);
  if (state.scan != nullptr) {
    for (const cv::Point2d& point : *state.scan) {
      cv::circle(picture, fixed(view.toPixel(point.x, point.y)), 2 << kShift, palette::kScan,
                 cv::FILLED, cv::LINE_AA, kShift);
    }
  }
  drawCar(state.base_in_map, view, palette::kEstimate, &palette::kEstimateFill, picture);
  if (state.truth != nullptr) drawCar(*state.truth, view, palette::kTruth, nullptr, picture);
  if (state.particles != nullptr) drawParticles(state, view, picture);
}

cv::Mat MapView::drawOverview(const Pose2& base_in_map, const Viewport& view, int limit) const {
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
  cv::polylines(overview, shown, true, palette::kEstimate, 1, cv::LINE_AA, kShift);
  cv::circle(overview, toOverview(base_in_map.x, base_in_map.y), 4 << kShift, palette::kEstimate,
             cv::FILLED, cv::LINE_AA, kShift);
  cv::rectangle(overview, {0, 0}, {overview.cols - 1, overview.rows - 1}, palette::kGrey);
  return overview;
}

}  // namespace racecar_mcl::video
