// Video of a replay: map view, position error and effective sample size.
#pragma once

#include <memory>
#include <opencv2/videoio.hpp>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/trajectory.h"
#include "offline/draft.h"
#include "offline/offline_driver.h"
#include "offline/video/map_view.h"
#include "offline/video/value_plot.h"

namespace racecar_mcl {

struct VideoParameters {
  std::string path;
  double speed = 1.0;           ///< recorded seconds per second of video
  double width = 14.0;          ///< visible width, m; larger at a large covariance
  double frame_rate = 30.0;     ///< Hz
  cv::Size size = {1280, 720};  ///< pixels, including plots
};

/// Writes the video under a temporary name until `finish`.
class VideoRecorder : public ReplayObserver {
 public:
  /// The grid is copied; the truth must outlive the recorder. Throws ParameterError if speed or
  /// width are out of range and std::runtime_error if the file cannot be written.
  VideoRecorder(const VideoParameters& parameters, const OccupancyGrid& grid,
                const std::optional<Trajectory>& truth, double max_gap);
  VideoRecorder(const VideoRecorder&) = delete;
  VideoRecorder& operator=(const VideoRecorder&) = delete;

  void onScan(const Scan& scan, const ScanRow& row, const Localizer& localizer) override;
  void onMessage(const Localizer& localizer) override;

  /// Throws std::runtime_error if there are no frames or the video is incomplete.
  void finish();

 private:
  void drawFrame(double time, const PoseEstimate& estimate, const Localizer& localizer);
  void follow(const PoseEstimate& estimate);
  void drawCaption(double time, const Localizer& localizer, cv::Mat picture) const;
  std::optional<Pose2> truthAt(double time) const;

  VideoParameters parameters_;
  video::MapView map_view_;
  const std::optional<Trajectory>& truth_;
  double max_gap_;
  std::unique_ptr<Draft> draft_;
  cv::VideoWriter writer_;
  cv::Mat frame_;
  video::ValuePlot error_plot_;
  video::ValuePlot sample_size_plot_;

  std::optional<double> start_;  ///< s, of the first frame
  double next_frame_ = 0.0;      ///< s
  int frames_ = 0;
  video::Viewport viewport_;
  std::optional<ScanRow> last_scan_;
  std::optional<double> last_error_;  ///< m
  std::vector<cv::Point2d> scan_points_;
  std::vector<cv::Point2d> trail_;
  std::vector<cv::Point2d> true_trail_;
};

}  // namespace racecar_mcl
