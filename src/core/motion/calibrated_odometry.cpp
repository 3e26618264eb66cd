#include "racecar_mcl/motion/calibrated_odometry.h"

#include <algorithm>

namespace racecar_mcl {

CalibratedOdometry::CalibratedOdometry(const OdometryParameters& parameters)
    : odometry_(parameters), gyro_(parameters.clock_jump) {}

void CalibratedOdometry::reset() {
  odometry_.reset();
  gyro_.reset();
}

MotionOrigin CalibratedOdometry::at(double stamp) const {
  const double turn_delay = calibration_.odometryTurn().delay();
  MotionOrigin origin{stamp, odometry_.at(stamp + calibration_.delay())};
  if (turn_delay != calibration_.delay()) {
    const OdometryState turned = odometry_.at(stamp + turn_delay);
    origin.odometry.turn = turned.turn;
    origin.odometry.twist.wz = turned.twist.wz;
  }
  return origin;
}

Motion CalibratedOdometry::motion(const MotionOrigin& from, double stamp) const {
  Motion motion = motionBetween(from.odometry, at(stamp).odometry);
  motion.duration = stamp - from.stamp;
  if (twist_) {
    motion.delta = integrate(*twist_, motion.duration);
    return motion;
  }
  const double delay = calibration_.gyro().calibration().delay();
  const std::optional<GyroState> before = gyro_.at(from.stamp + delay);
  const std::optional<GyroState> after = gyro_.at(stamp + delay);
  if (before && after) motion.gyro = {after->turn - before->turn, after->rate - before->rate};
  return calibration_.correct(motion);
}

CalibratedOdometry CalibratedOdometry::since(double stamp) const {
  const double earliest =
      stamp + std::min({0.0, calibration_.delay(), calibration_.odometryTurn().delay(),
                        calibration_.gyro().calibration().delay()});
  CalibratedOdometry part;
  part.odometry_ = odometry_.since(earliest);
  part.gyro_ = gyro_.since(earliest);
  part.calibration_ = calibration_;
  return part;
}

}  // namespace racecar_mcl
