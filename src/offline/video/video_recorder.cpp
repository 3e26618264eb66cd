#include "offline/video/video_recorder.h"

#include <cstdio>
#include <filesystem>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "racecar_mcl/common/errors.h"

namespace racecar_mcl {
namespace {

namespace fs = std::filesystem;
namespace palette = video::palette;
using video::drawText;

constexpr int kPlotHeight = 80;         // pixels, of each plot
constexpr double kPlotSeconds = 20.0;   // s of video
constexpr double kMaxPause = 5.0;       // s of video without messages; longer pauses are cut
constexpr double kTruthGap = 3.0;       // s, maximum interval between shown truth poses
constexpr double kCameraDelay = 0.4;    // s of video, time constant of the camera motion
constexpr double kTrailStep = 0.03;     // m
constexpr double kWidthPerSigma = 6.0;  // minimum visible width in standard deviations

/// Uses the first available codec; H.264 is the most widely supported.
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

/// The end points of all returns in the map frame, corrected as the filter's.
std::vector<cv::Point2d> returnsOf(const Scan& scan, const Pose2& base_in_map,
                                   const Localizer& localizer) {
  const Scan beams = localizer.correctedScan(scan, static_cast<int>(scan.size()));
  const Eigen::Matrix2Xd ends = endPoints(compose(base_in_map, beams.laser_in_base), beams);
  std::vector<cv::Point2d> points;
  for (Eigen::Index i = 0; i < beams.size(); ++i) {
    if (std::isfinite(beams.ranges[i])) points.emplace_back(ends(0, i), ends(1, i));
  }
  return points;
}

void extend(std::vector<cv::Point2d>* trail, const Pose2& pose) {
  const cv::Point2d point(pose.x, pose.y);
  if (trail->empty() || cv::norm(point - trail->back()) > kTrailStep) trail->push_back(point);
}

}  // namespace

VideoRecorder::VideoRecorder(const VideoParameters& parameters, const OccupancyGrid& grid,
                             const std::optional<Trajectory>& truth, double max_gap)
    : parameters_(parameters),
      map_view_(grid),
      truth_(truth),
      max_gap_(max_gap),
      frame_(parameters.size, CV_8UC3),
      error_plot_(truth ? "position error" : "spread (1 sigma)", "cm", palette::kEstimate,
                  kPlotSeconds * parameters.speed, 5.0, false),
      sample_size_plot_("effective sample size", "%", palette::weightColour(1.0),
                        kPlotSeconds * parameters.speed, 100.0, true) {
  if (!(parameters.speed > 0.0 && parameters.speed <= 1000.0)) {
    throw ParameterError("--video-speed is " + std::to_string(parameters.speed) +
                         "; it must lie in (0, 1000]");
  }
  if (!(parameters.width >= 1.0 && parameters.width <= 1000.0)) {
    throw ParameterError("--video-width is " + std::to_string(parameters.width) +
                         " m; it must lie in [1, 1000]");
  }
  viewport_.size = {parameters.size.width, parameters.size.height - 2 * kPlotHeight};
  draft_ = std::make_unique<Draft>(parameters.path);
  if (!openWriter(draft_->path(), parameters.frame_rate, parameters.size, &writer_)) {
    throw std::runtime_error(parameters.path +
                             ": cannot write a video; expected a name that ends in .mp4, "
                             ".mkv or .avi in a folder that can be written");
  }
}

void VideoRecorder::finish() {
  writer_.release();
  if (frames_ == 0) throw std::runtime_error(parameters_.path + ": no frames to write");
  // cv::VideoWriter does not report errors.
  if (!cv::VideoCapture(draft_->path()).isOpened()) {
    throw std::runtime_error(parameters_.path + ": the video is incomplete; is the disk full?");
  }
  draft_->commit();
}

std::optional<Pose2> VideoRecorder::truthAt(double time) const {
  if (!truth_) return std::nullopt;
  return poseAt(*truth_, toNanoseconds(time), kTruthGap);
}

void VideoRecorder::onScan(const Scan& scan, const ScanRow& row, const Localizer& localizer) {
  last_scan_ = row;
  const UpdateResult& update = row.result.update;
  scan_points_ = returnsOf(scan, update.estimate.base_in_map, localizer);
  if (update.particles > 0) {
    sample_size_plot_.add(scan.stamp, 100.0 * update.effective_sample_size / update.particles);
  }
  if (!truth_) {
    const Eigen::Matrix3d& covariance = update.estimate.covariance;
    error_plot_.add(scan.stamp, 100.0 * std::sqrt(covariance(0, 0) + covariance(1, 1)));
  } else if (const auto truth = poseAt(*truth_, row.stamp, max_gap_)) {
    last_error_ = distance(*truth, update.estimate.base_in_map);
    error_plot_.add(scan.stamp, 100.0 * *last_error_);
  }
}

void VideoRecorder::onMessage(const Localizer& localizer) {
  const std::optional<double> newest = localizer.newestStamp();
  if (!newest || !last_scan_) return;
  extend(&trail_, localizer.estimateAt(*newest)->base_in_map);
  if (const std::optional<Pose2> truth = truthAt(*newest)) extend(&true_trail_, *truth);
  const double max_pause = kMaxPause * parameters_.speed;
  if (!start_) start_ = next_frame_ = *newest;
  if (std::abs(*newest - next_frame_) > max_pause) next_frame_ = *newest;
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
      std::max(parameters_.width, std::min(kWidthPerSigma * sigma, 1.3 * map_view_.mapExtent()));
  const double scale = viewport_.size.width / width;
  const bool first = frames_ == 0;
  // Faster playback needs faster camera motion.
  const double delay = kCameraDelay / std::max(1.0, parameters_.speed);
  const double gain = first ? 1.0 : 1.0 / (1.0 + delay * parameters_.frame_rate);
  viewport_.centre += gain * (cv::Point2d(pose.x, pose.y) - viewport_.centre);
  viewport_.pixels_per_metre += gain * (scale - viewport_.pixels_per_metre);
}

void VideoRecorder::drawFrame(double time, const PoseEstimate& estimate,
                              const Localizer& localizer) {
  follow(estimate);
  const std::optional<Pose2> truth = truthAt(time);
  video::MapViewState state;
  state.base_in_map = estimate.base_in_map;
  state.truth = truth ? &*truth : nullptr;
  state.particles = &localizer.particles();
  state.motion_since_update =
      between(last_scan_->result.update.estimate.base_in_map, estimate.base_in_map);
  state.scan = &scan_points_;
  state.trail = &trail_;
  state.true_trail = &true_trail_;

  cv::Mat plan = frame_(cv::Rect({0, 0}, viewport_.size));
  map_view_.draw(state, viewport_, plan);
  const cv::Mat overview = map_view_.drawOverview(estimate.base_in_map, viewport_, 220);
  overview.copyTo(plan(cv::Rect({plan.cols - overview.cols - 12, 12}, overview.size())));
  drawCaption(time, localizer, plan);
  const int width = frame_.cols;
  error_plot_.draw(time, frame_(cv::Rect(0, viewport_.size.height, width, kPlotHeight)));
  sample_size_plot_.draw(
      time, frame_(cv::Rect(0, viewport_.size.height + kPlotHeight, width, kPlotHeight)));
  writer_.write(frame_);
  ++frames_;
}

void VideoRecorder::drawCaption(double time, const Localizer& localizer, cv::Mat picture) const {
  cv::Mat box = picture(cv::Rect(12, 12, 246, truth_ ? 158 : 134));
  box = 0.15 * box + cv::Scalar(217, 217, 217);
  char line[96];
  std::snprintf(line, sizeof(line), "%.1f s   x%.3g", time - *start_, parameters_.speed);
  drawText(picture, line, {24, 36}, palette::kText, 0.6);
  std::snprintf(line, sizeof(line), "%lld particles, %d beams",
                static_cast<long long>(localizer.particles().size()),
                last_scan_->result.update.beams);
  drawText(picture, line, {24, 60}, palette::kText, 0.5);
  int y = 84;
  const auto legend = [&](const cv::Scalar& colour, const char* word) {
    cv::line(picture, {24, y - 5}, {48, y - 5}, colour, 3, cv::LINE_AA);
    drawText(picture, word, {58, y}, palette::kText, 0.5);
    y += 24;
  };
  legend(palette::kEstimate, "estimate");
  if (truth_) legend(palette::kTruth, "truth");
  legend(palette::kScan, "scan");
  legend(palette::weightColour(0.8), "particles (dark: high weight)");

  // Scale bar.
  const int metre = cvRound(viewport_.pixels_per_metre);
  const cv::Point left(24, picture.rows - 20);
  cv::line(picture, left, left + cv::Point(metre, 0), palette::kText, 2);
  drawText(picture, "1 m", left + cv::Point(0, -8), palette::kText, 0.5);
}

}  // namespace racecar_mcl
