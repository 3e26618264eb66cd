// Monte Carlo localization of a car: odometry and scans in, the pose at any time out.
// Nodelet, offline replay and tests use the same object. It knows no ROS, clock or thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "racecar_mcl/localizer/lidar_odometry.h"
#include "racecar_mcl/localizer/lidar_state.h"
#include "racecar_mcl/localizer/localizer_parameters.h"
#include "racecar_mcl/localizer/pose_extrapolator.h"
#include "racecar_mcl/localizer/scan_result.h"
#include "racecar_mcl/localizer/sensor_calibration.h"
#include "racecar_mcl/monitoring/localization_monitor.h"
#include "racecar_mcl/motion/process_noise_adaptation.h"
#include "racecar_mcl/relocalization/hypothesis_verifier.h"
#include "racecar_mcl/relocalization/recovery_policy.h"

namespace racecar_mcl {

/// Not thread-safe, except for the methods marked so: odometry does not wait for a scan.
class Localizer {
 public:
  /// Throws as `validate` does.
  Localizer(const LocalizerParameters& parameters, std::uint64_t seed);

  /// Replaces the map; the particles are kept.
  void setMap(std::shared_ptr<const LocalizationMap> map);
  /// Changes the parameters between two scans; all estimates are kept. `map`: as setMap, built with
  /// the new parameters if needsNewMap, or null. Throws as `validate`, and then changes nothing.
  void setParameters(const LocalizerParameters& parameters,
                     std::shared_ptr<const LocalizationMap> map);
  bool hasMap() const { return map_ != nullptr; }
  std::shared_ptr<const LocalizationMap> map() const { return map_; }
  /// Starts around a pose at the newest stamp seen, or at a stamp, from where odometry moves it.
  /// Throws as ParticleFilter::initialize, and ParameterError if the pose is outside the map.
  void initialize(const PoseEstimate& start);
  void initialize(const PoseEstimate& start, double stamp);
  /// Starts with an unknown pose: particles are drawn where the next scan matches the map, or
  /// evenly from the free space if relocalization is off. Without a map it does nothing and returns
  /// false.
  bool initializeGlobally();
  void resumeCalibration(const SensorCalibration& calibration);

  /// One step of Monte Carlo localization. If a step throws, the scan is dropped, the particles are
  /// drawn again from the last estimate, and the exception is rethrown.
  ScanResult update(const Scan& scan);
  /// The next stationary_updates scans are used even if the car is stationary.
  void requestUpdate() { scans_since_stop_ = 0; }
  // Thread-safe; see PoseExtrapolator.
  OdometryOutcome addOdometry(const OdometrySample& sample) {
    return extrapolator_.addOdometry(sample);
  }
  GyroOutcome addGyro(const GyroSample& sample) { return extrapolator_.addGyro(sample); }
  bool odometryCovers(double stamp) const { return extrapolator_.covers(stamp); }
  bool initialized() const { return extrapolator_.initialized(); }
  std::optional<PoseEstimate> estimateAt(double stamp) const {
    return extrapolator_.estimateAt(stamp);
  }
  std::optional<double> newestStamp() const { return extrapolator_.newestStamp(); }
  Twist2 twist() const { return extrapolator_.twist(); }
  OdometryCounters odometryCounters() const { return extrapolator_.counters(); }

  const ParticleSet& particles() const { return filter_.particles(); }
  const LocalizationStatus& status() const { return monitor_.status(); }  ///< newest estimate's
  LocalizerCounters counters() const { return {counters_, odometryCounters()}; }
  /// As estimated so far; resumeCalibration continues from it after a restart.
  const std::vector<LidarState>& lidars() const { return lidars_; }
  const OdometryCalibration& calibration() const { return calibration_; }
  SensorCalibration sensorCalibration() const;
  /// A used scan with up to `count` beams, selected evenly, corrected and deskewed as the filter's.
  Scan correctedScan(const Scan& scan, int count) const;
  /// m; scans closer together than this have correlated errors and are down-weighted.
  double decorrelationDistance() const;
  const LocalizerParameters& parameters() const { return parameters_; }

 private:
  /// The data of one scan during `update`.
  struct Step {
    PreprocessedScan scan;
    std::optional<Scan> mirrored;  ///< the scan deskewed in the opposite acquisition order
    double stamp = 0.0;            ///< s, at which the scan is evaluated
    Motion odometry_motion;        ///< since the last scan
    Motion motion;                 ///< the same, corrected for slip and refined
    PoseEstimate before;           ///< at the last scan
    PoseEstimate predicted;        ///< at `stamp`, without the covariance of the motion
    bool is_refined = false;       ///< `motion` was refined by the lidar odometry
    bool is_stationary = false;    ///< and stationary_updates scans were used since the stop
    bool jumped = false;  ///< the particles were replaced: the correction is no odometry error
    ScanScore score;      ///< at the estimate
  };

  ScanOutcome check(const Scan& scan);
  void run(const Scan& scan, ScanResult* result);
  Step preprocess(const Scan& selected);
  LidarState& lidarAt(int index);
  void initializeFromScan(Step* step, UpdateResult* update);
  void predict(Step* step);
  void reweight(const Step& step, UpdateResult* update);
  void relocalize(bool just_converged, Step* step, UpdateResult* update);
  void monitor(const PoseEstimate& estimate, Step* step, ScanResult* result);
  void learn(const Step& step, const ScanResult& result);
  void calibrate(const Step& step, const ScanResult& result, double travelled);
  void count(ScanOutcome outcome);
  void restartTracking();
  void recoverFromError();
  SearchMap searchMap() const { return {map_->view(), map_->matcher, sensor_model_.get()}; }

  LocalizerParameters parameters_;
  PoseExtrapolator extrapolator_;
  std::shared_ptr<const LocalizationMap> map_;
  std::unique_ptr<SensorModel> sensor_model_;
  ScanPreprocessor preprocessor_;
  ParticleFilter filter_;
  LidarOdometry lidar_odometry_;
  OdometryCalibration calibration_;
  ProcessNoiseAdaptation noise_adaptation_;
  SlipCompensation slip_compensation_;
  std::vector<LidarState> lidars_;  ///< by Scan::lidar, up to the last that has taken a scan
  HypothesisVerifier verifier_;
  RecoveryPolicy recovery_;
  LocalizationMonitor monitor_;
  ScanMatchEvaluator match_evaluator_;
  bool global_start_pending_ = false;
  int scans_since_stop_ = 0;
  ScanCounters counters_;
};

}  // namespace racecar_mcl
