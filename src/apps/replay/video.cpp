#include "video.h"

#include <cstdio>
#include <filesystem>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "racecar_mcl/errors.h"

namespace racecar_mcl {
namespace {

namespace fs = std::filesystem;

constexpr int kStripHeight = 80;        // pixels, each of two
constexpr double kStripSeconds = 20.0;  // s of film
constexpr double kLongestStill = 5.0;   // s of film without news, after which it is cut short
constexpr double kTruthGap = 3.0;       // s between poses of a truth that is still shown
constexpr double kCameraDelay = 0.4;    // s of film in which the picture follows the car
constexpr double kTrailStep = 0.03;     // m
constexpr double kWidthPerSigma = 6.0;  // of the cloud that the picture has to show

/// The first of the codecs that this OpenCV can write. Players know H.264 best.
bool openWriter(const std::string& path, double rate, cv::Size size, cv::VideoWriter* writer) {
  namespace logging = cv::utils::logging;
  const logging::LogLevel level = logging::setLogLevel(logging::LOG_LEVEL_SILENT);
  const char* const codecs[] = {"avc1", "mp4v", "MJPG"};
  bool opened = false;
  for (const char* codec : codecs) {
    if (fs::path(path).extension() == ".avi" && codec != codecs[2]) continue;
    const int code = cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]);
    opened = writer->open(path, code, rate, size, true);
    if (opened) break;
  }
  logging::setLogLevel(level);
  return opened;
}

/// The end points of all returns in the map frame. The car moves on during a sweep.
std::vector<cv::Point2d> endPoints(const Scan& listed, const Localizer& localizer) {
  const Scan scan = localizer.sweepOrder().inOrderTaken(listed);
  std::vector<cv::Point2d> points;
  if (scan.size() == 0) return points;
  // To the farther end of the sweep, which is before the stamp where beams are listed in reverse.
  const auto earliest = static_cast<double>(scan.seconds_after_stamp.minCoeff());
  const auto latest = static_cast<double>(scan.seconds_after_stamp.maxCoeff());
  const double duration = -earliest > latest ? earliest : latest;
  const std::optional<PoseEstimate> first = localizer.estimateAt(scan.stamp);
  const std::optional<PoseEstimate> last = localizer.estimateAt(scan.stamp + duration);
  if (!first || !last) return points;
  for (Eigen::Index i = 0; i < scan.size(); ++i) {
    const double range = static_cast<double>(scan.ranges[i]);
    if (!std::isfinite(range)) continue;
    const double share =
        duration != 0.0 ? static_cast<double>(scan.seconds_after_stamp[i]) / duration : 0.0;
    const Pose2 base = interpolate(first->base_in_map, last->base_in_map, share);
    const double bearing = static_cast<double>(scan.bearings[i]);
    const Pose2 end = compose(compose(base, scan.laser_in_base),
                              {range * std::cos(bearing), range * std::sin(bearing), 0.0});
    points.emplace_back(end.x, end.y);
  }
  return points;
}

void extend(std::vector<cv::Point2d>* trail, const Pose2& pose) {
  const cv::Point2d point(pose.x, pose.y);
  if (trail->empty() || cv::norm(point - trail->back()) > kTrailStep) trail->push_back(point);
}

Nanoseconds nanoseconds(double seconds) { return std::llround(seconds * 1e9); }

}  // namespace

VideoRecorder::VideoRecorder(const VideoParameters& parameters, const OccupancyGrid& grid,
                             const std::optional<Trajectory>& truth, double max_gap)
    : parameters_(parameters),
      drawer_(grid),
      truth_(truth),
      max_gap_(max_gap),
      frame_(parameters.size, CV_8UC3),
      error_strip_(truth ? "position error" : "spread (1 sigma)", "cm", film::kEstimate,
                   kStripSeconds * parameters.speed, 5.0, false),
      sample_size_strip_("effective sample", "%", film::weightColour(1.0),
                         kStripSeconds * parameters.speed, 100.0, true) {
  if (!(parameters.speed > 0.0 && parameters.speed <= 1000.0)) {
    throw ParameterError("--video-speed is " + std::to_string(parameters.speed) +
                         "; it must lie in (0, 1000]");
  }
  if (!(parameters.width >= 1.0 && parameters.width <= 1000.0)) {
    throw ParameterError("--video-width is " + std::to_string(parameters.width) +
                         " m; it must lie in [1, 1000]");
  }
  view_.size = {parameters.size.width, parameters.size.height - 2 * kStripHeight};
  const fs::path path(parameters.path);
  // The ending tells the writer the format.
  draft_ = (path.parent_path() / (path.stem().string() + ".part" + path.extension().string()));
  if (!openWriter(draft_, parameters.frame_rate, parameters.size, &writer_)) {
    throw std::runtime_error(parameters.path +
                             ": no film can be written there; expected a name that ends in .mp4, "
                             ".mkv or .avi in a folder that can be written");
  }
}

VideoRecorder::~VideoRecorder() {
  writer_.release();
  std::error_code ignored;
  fs::remove(draft_, ignored);
}

void VideoRecorder::finish() {
  writer_.release();
  if (frames_ == 0) throw std::runtime_error(parameters_.path + ": there was nothing to film");
  fs::rename(draft_, parameters_.path);
}

std::optional<Pose2> VideoRecorder::truthAt(double time) const {
  if (!truth_) return std::nullopt;
  return poseAt(*truth_, nanoseconds(time), kTruthGap);
}

void VideoRecorder::onScan(const Scan& scan, const ScanRow& row, const Localizer& localizer) {
  last_scan_ = row;
  scan_points_ = endPoints(scan, localizer);
  const UpdateResult& update = row.result.update;
  if (update.particles > 0) {
    sample_size_strip_.add(scan.stamp, 100.0 * update.effective_sample_size / update.particles);
  }
  if (!truth_) {
    const Eigen::Matrix3d& covariance = update.estimate.covariance;
    error_strip_.add(scan.stamp, 100.0 * std::sqrt(covariance(0, 0) + covariance(1, 1)));
  } else if (const auto truth = poseAt(*truth_, row.stamp, max_gap_)) {
    last_error_ = distance(*truth, update.estimate.base_in_map);
    error_strip_.add(scan.stamp, 100.0 * *last_error_);
  }
}

void VideoRecorder::onMessage(const Localizer& localizer) {
  const std::optional<double> newest = localizer.newestStamp();
  if (!newest || !last_scan_) return;
  extend(&trail_, localizer.estimateAt(*newest)->base_in_map);
  if (const std::optional<Pose2> truth = truthAt(*newest)) extend(&true_trail_, *truth);
  const double longest_still = kLongestStill * parameters_.speed;
  if (!start_) start_ = next_frame_ = *newest;
  if (std::abs(*newest - next_frame_) > longest_still) next_frame_ = *newest;
  for (; next_frame_ <= *newest; next_frame_ += parameters_.speed / parameters_.frame_rate) {
    if (const auto estimate = localizer.estimateAt(next_frame_)) {
      drawFrame(next_frame_, *estimate, localizer);
    }
  }
}

void VideoRecorder::follow(const PoseEstimate& estimate) {
  const Pose2& pose = estimate.base_in_map;
  const double sigma = std::sqrt(estimate.covariance(0, 0) + estimate.covariance(1, 1));
  const double width =
      std::max(parameters_.width, std::min(kWidthPerSigma * sigma, 1.3 * drawer_.mapExtent()));
  const double scale = view_.size.width / width;
  const bool first = frames_ == 0;
  // At a higher speed the car crosses the picture faster.
  const double delay = kCameraDelay / std::max(1.0, parameters_.speed);
  const double share = first ? 1.0 : 1.0 / (1.0 + delay * parameters_.frame_rate);
  view_.centre += share * (cv::Point2d(pose.x, pose.y) - view_.centre);
  view_.pixels_per_metre += share * (scale - view_.pixels_per_metre);
}

void VideoRecorder::drawFrame(double time, const PoseEstimate& estimate,
                              const Localizer& localizer) {
  follow(estimate);
  const std::optional<Pose2> truth = truthAt(time);
  Scene scene;
  scene.base_in_map = estimate.base_in_map;
  scene.truth = truth ? &*truth : nullptr;
  scene.particles = &localizer.particles();
  scene.since_weighing =
      between(last_scan_->result.update.estimate.base_in_map, estimate.base_in_map);
  scene.scan = &scan_points_;
  scene.trail = &trail_;
  scene.true_trail = &true_trail_;

  cv::Mat plan = frame_(cv::Rect({0, 0}, view_.size));
  drawer_.draw(scene, view_, plan);
  const cv::Mat overview = drawer_.drawOverview(estimate.base_in_map, view_, 220);
  overview.copyTo(plan(cv::Rect({plan.cols - overview.cols - 12, 12}, overview.size())));
  drawWords(time, localizer, plan);
  const int width = frame_.cols;
  error_strip_.draw(time, frame_(cv::Rect(0, view_.size.height, width, kStripHeight)));
  sample_size_strip_.draw(
      time, frame_(cv::Rect(0, view_.size.height + kStripHeight, width, kStripHeight)));
  writer_.write(frame_);
  ++frames_;
}

void VideoRecorder::drawWords(double time, const Localizer& localizer, cv::Mat picture) const {
  cv::Mat box = picture(cv::Rect(12, 12, 246, truth_ ? 158 : 134));
  box = 0.15 * box + cv::Scalar(217, 217, 217);
  char line[96];
  std::snprintf(line, sizeof(line), "%.1f s   x%.3g", time - *start_, parameters_.speed);
  drawText(picture, line, {24, 36}, film::kInk, 0.6);
  std::snprintf(line, sizeof(line), "%lld particles, %d beams",
                static_cast<long long>(localizer.particles().size()),
                last_scan_->result.update.beams);
  drawText(picture, line, {24, 60}, film::kInk, 0.5);
  int y = 84;
  const auto legend = [&](const cv::Scalar& colour, const char* word) {
    cv::line(picture, {24, y - 5}, {48, y - 5}, colour, 3, cv::LINE_AA);
    drawText(picture, word, {58, y}, film::kInk, 0.5);
    y += 24;
  };
  legend(film::kEstimate, "estimate");
  if (truth_) legend(film::kTruth, "truth");
  legend(film::kScan, "scan from there");
  legend(film::weightColour(0.8), "particles: dark = likely");

  // A metre to measure by.
  const int metre = cvRound(view_.pixels_per_metre);
  const cv::Point left(24, picture.rows - 20);
  cv::line(picture, left, left + cv::Point(metre, 0), film::kInk, 2);
  drawText(picture, "1 m", left + cv::Point(0, -8), film::kInk, 0.5);
}

}  // namespace racecar_mcl
