// A film of a replay: what the localizer saw and believed, moment by moment.
#pragma once

#include <opencv2/videoio.hpp>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/trajectory.h"
#include "replay_run.h"
#include "video_strip.h"
#include "video_view.h"

namespace racecar_mcl {

struct VideoParameters {
  std::string path;
  double speed = 1.0;   ///< recorded seconds per second of film
  double width = 14.0;  ///< m that the picture shows from left to right, more while the car is lost
  double frame_rate = 30.0;     ///< Hz
  cv::Size size = {1280, 720};  ///< pixels, the strips included
};

/// Writes the film under another name until `finish`, so that none is ever half there.
class VideoRecorder : public ReplayObserver {
 public:
  /// The grid is copied; the truth has to outlive the recorder. Throws ParameterError on a speed or
  /// width that is not positive, std::runtime_error where the file cannot be written.
  VideoRecorder(const VideoParameters& parameters, const OccupancyGrid& grid,
                const std::optional<Trajectory>& truth, double max_gap);
  ~VideoRecorder() override;
  VideoRecorder(const VideoRecorder&) = delete;
  VideoRecorder& operator=(const VideoRecorder&) = delete;

  void onScan(const Scan& scan, const ScanRow& row, const Localizer& localizer) override;
  void onMessage(const Localizer& localizer) override;

  /// Throws std::runtime_error where nothing was filmed or the film cannot be moved to its name.
  void finish();

 private:
  void drawFrame(double time, const PoseEstimate& estimate, const Localizer& localizer);
  void follow(const PoseEstimate& estimate);
  void drawWords(double time, const Localizer& localizer, cv::Mat picture) const;
  std::optional<Pose2> truthAt(double time) const;

  VideoParameters parameters_;
  SceneDrawer drawer_;
  const std::optional<Trajectory>& truth_;
  double max_gap_;
  std::string draft_;
  cv::VideoWriter writer_;
  cv::Mat frame_;
  ValueStrip error_strip_;
  ValueStrip sample_size_strip_;

  std::optional<double> start_;  ///< s, of the first frame
  double next_frame_ = 0.0;      ///< s
  int frames_ = 0;
  Viewport view_;
  std::optional<ScanRow> last_scan_;
  std::optional<double> last_error_;  ///< m
  std::vector<cv::Point2d> scan_points_;
  std::vector<cv::Point2d> trail_;
  std::vector<cv::Point2d> true_trail_;
};

}  // namespace racecar_mcl
