// Extrapolates the last pose estimate by odometry to any time.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "racecar_mcl/filter/pose_estimate.h"
#include "racecar_mcl/localizer/scan_clocks.h"
#include "racecar_mcl/localizer/scan_result.h"
#include "racecar_mcl/motion/calibrated_odometry.h"
#include "racecar_mcl/motion/motion_model.h"
#include "racecar_mcl/motion/slip_compensation.h"
#include "racecar_mcl/scan/scan.h"

namespace racecar_mcl {

/// Holds the last estimate, the odometry since and its calibration: the state shared by the
/// odometry and scan threads. Thread-safe; every method returns quickly.
class PoseExtrapolator {
 public:
  /// A copy of the odometry that the processing of one scan needs.
  struct ScanMotion {
    CalibratedOdometry odometry;  ///< over the sweep, corrected for slip
    PoseEstimate before;          ///< at the last estimate
    Motion odometry_motion;       ///< since then to `stamp`, calibrated
    Motion motion;                ///< the same, corrected for slip
    double stamp = 0.0;           ///< s, the scan's evaluationStamp
    /// The newest message is at most max_odometry_gap older than the scan.
    bool odometry_is_new = false;
  };

  /// Throws as the parameters' validate functions do.
  PoseExtrapolator(const OdometryParameters& odometry, const MotionModelParameters& motion);

  /// The estimate and the odometry are kept. Throws ParameterError, and then changes nothing.
  void setParameters(const OdometryParameters& odometry, const MotionModelParameters& motion);

  OdometryOutcome addOdometry(const OdometrySample& sample);
  GyroOutcome addGyro(const GyroSample& sample);

  /// Whether a scan of this stamp need not wait for odometry: the newest message is at least as
  /// new, or over 0.5 s older (odometry has stopped). A positive delay does not prolong the wait.
  bool covers(double stamp) const;

  /// The pose at a time, extrapolated from the last estimate by odometry, also backwards; none
  /// before a start.
  std::optional<PoseEstimate> estimateAt(double stamp) const;
  /// The newest stamp of a scan or odometry message; none before the first.
  std::optional<double> newestStamp() const;
  /// s, a scan's stamp minus that of the newest odometry; 0 before the first message.
  double odometryLag(double stamp) const;
  /// The newest odometry twist, or the one that replaces it; zero before the first.
  Twist2 twist() const;
  OdometryCounters counters() const;

  /// A pose estimate at a stamp, moved to the newest stamp by odometry. Unchanged if the stamp is
  /// not older, or before the first message in the buffer.
  PoseEstimate moveToNewest(const PoseEstimate& estimate, double stamp) const;
  /// A start: `estimate` is the pose at the newest stamp.
  void reset(const PoseEstimate& estimate, const OdometryCalibration& calibration);
  bool initialized() const;
  /// The last estimate; none before a start.
  std::optional<PoseEstimate> lastEstimate() const;

  /// As ScanClocks::check, with the newest odometry.
  ScanOutcome checkStamp(double stamp, int lidar = 0);
  /// As ScanClocks::evaluationStamp.
  double evaluationStamp(double stamp) const;
  /// A copy of the odometry over the sweep of a scan, in either acquisition order, corrected for
  /// slip.
  CalibratedOdometry odometryOver(const Scan& scan) const;
  /// The motion up to a scan. Throws std::logic_error before a start.
  ScanMotion beginScan(const Scan& scan);
  /// Sets the estimate at a scan's stamp, and what corrects the odometry from then on.
  void setReference(const PoseEstimate& estimate, double stamp,
                    const OdometryCalibration& calibration, double noise_scale,
                    const SlipCompensation& slip_compensation);

 private:
  /// The last estimate and the odometry at its stamp.
  struct Reference {
    PoseEstimate estimate;
    MotionOrigin origin;
  };

  CalibratedOdometry since(const Scan& scan) const;
  Motion odometryMotionTo(double stamp) const;
  std::optional<double> newest() const;

  OdometryParameters parameters_;
  MotionModelParameters motion_parameters_;
  /// Guards all members below.
  std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();
  CalibratedOdometry odometry_;
  double noise_scale_ = 1.0;  ///< factor on the standard deviations of the motion noise
  SlipCompensation slip_compensation_;
  std::optional<Reference> reference_;
  ScanClocks scan_clocks_;
  OdometryCounters counters_;
};

}  // namespace racecar_mcl
