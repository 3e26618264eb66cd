// A localizer and a car in a room.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>

#include "racecar_mcl/localizer/localizer.h"
#include "support/analytic_room.h"
#include "support/expect_pose.h"

namespace racecar_mcl {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kOdometryPeriod = 0.02;  // s
constexpr double kScanPeriod = 0.025;     // s

/// Parameters for a room without features; the defaults are tuned for other maps.
inline LocalizerParameters fewBeams() {
  LocalizerParameters parameters;
  parameters.calibration.calibration_distance = 0.0;  // exact motions
  parameters.sensor.sensor_model = SensorModelType::kBeam;
  parameters.scan.scan_field_of_view = 4.71;
  parameters.motion.motion_model = MotionNoise::kAckermann;
  parameters.motion.longitudinal_noise_from_translation = 0.1;
  parameters.motion.lateral_noise_from_translation = 0.05;
  parameters.motion.yaw_noise_from_translation = 0.05;
  parameters.motion.yaw_noise_from_rotation = 0.1;
  parameters.scan.num_beams_per_particle = 40;
  parameters.scan.min_beams = 10;
  parameters.stationary_updates = 5;
  parameters.filter.estimate = EstimateFrom::kMean;
  return parameters;
}

inline void expectSame(const PoseEstimate& a, const PoseEstimate& b) {
  EXPECT_EQ(a.base_in_map.x, b.base_in_map.x);
  EXPECT_EQ(a.base_in_map.y, b.base_in_map.y);
  EXPECT_EQ(a.base_in_map.yaw, b.base_in_map.yaw);
  EXPECT_TRUE((a.covariance.array() == b.covariance.array()).all());
}

inline PoseEstimate startAt(const Pose2& pose, double sigma = 0.1) {
  return {pose, sigma * sigma * Eigen::Matrix3d::Identity()};
}

/// A car that drives a circle in a room of 8 x 5 m, starting at time `start_`.
class LocalizerTest : public testing::Test {
 protected:
  Room room_;
  Sweep sweep_{180, 4.7, 0.0, {0.27, 0.03, 0.05}};
  Twist2 twist_{1.5, 0.0, 1.0};
  Pose2 start_pose_{4.0, 1.0, 0.0};
  double start_ = 100.0;

  Pose2 truthAt(double stamp) const {
    return compose(start_pose_, integrate(twist_, stamp - start_));
  }

  Scan scanAt(double stamp) const {
    return takeScan(room_, sweep_, stamp, [&](double t) { return truthAt(t); });
  }

  OdometrySample odometryAt(double stamp) const { return {stamp, twist_, {}}; }

  std::shared_ptr<const LocalizationMap> map(
      const LocalizerParameters& parameters = fewBeams()) const {
    return makeLocalizationMap(room_.grid(), parameters);
  }

  Localizer started(const LocalizerParameters& parameters = fewBeams(),
                    std::uint64_t seed = 1) const {
    Localizer localizer(parameters, seed);
    localizer.setMap(map(parameters));
    localizer.addOdometry(odometryAt(start_));
    localizer.initialize(startAt(start_pose_));
    return localizer;
  }

  /// Odometry and scans in the order of their stamps, over (from, to] after `start_`.
  void drive(Localizer* localizer, double from, double to,
             const std::function<void(const ScanResult&)>& each = {}) const {
    auto odometry = static_cast<int>(std::floor(from / kOdometryPeriod + 1e-6)) + 1;
    auto scan = static_cast<int>(std::floor(from / kScanPeriod + 1e-6)) + 1;
    for (;;) {
      const double next_odometry = odometry * kOdometryPeriod;
      const double next_scan = scan * kScanPeriod;
      if (std::min(next_odometry, next_scan) > to + 1e-6) return;
      if (next_odometry <= next_scan) {
        localizer->addOdometry(odometryAt(start_ + next_odometry));
        ++odometry;
      } else {
        const ScanResult result = localizer->update(scanAt(start_ + next_scan));
        if (each) each(result);
        ++scan;
      }
    }
  }
};

}  // namespace racecar_mcl
