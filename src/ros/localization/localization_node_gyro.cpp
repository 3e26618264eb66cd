// Part of LocalizationNode: the gyro of the IMU.
#include "ros/localization/localization_node.h"

namespace racecar_mcl {

void LocalizationNode::onImu(const sensor_msgs::ImuConstPtr& message) {
  if (hasInvalidStamp("imu", message->header.stamp)) return;
  std::string odometry_frame;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    odometry_frame = odometry_frame_;
  }
  const std::string frame = stripLeadingSlash(message->header.frame_id);
  const std::optional<geometry_msgs::Quaternion> rotation =
      imu_rotation_.find(frame, odometry_frame, ros::WallTime::now().toSec());
  if (!rotation) return;
  if (imu_rotation_.isAssumed() && log_throttle_.isFirst("imu rotation")) {
    ROS_WARN("imu: tf has no transform from '%s' to '%s'; its axes are taken as those of the car",
             parameters_.particle_filter_frame.c_str(), frame.c_str());
  }
  try {
    const GyroOutcome outcome = localizer_.addGyro(toGyroSample(*message, *rotation));
    if (outcome == GyroOutcome::kNotFinite || outcome == GyroOutcome::kImplausible ||
        outcome == GyroOutcome::kOutOfOrder) {
      recordProblem(toString(outcome));
      warnThrottled("imu dropped", toString(outcome));
    }
  } catch (const MessageError& error) {
    recordProblem(error.what());
    warnThrottled("imu dropped", error.what());
  }
}

void LocalizationNode::reportGyro() {
  const GyroCalibration& gyro = localizer_.calibration().gyro();
  if (gyro.isInDegrees() && log_throttle_.isFirst("gyro in degrees")) {
    ROS_WARN(
        "imu: the angular velocity is in degrees per second, according to the scans; expected "
        "rad/s "
        "(REP-103). It is converted");
  }
  if (gyro.use() == GyroUse::kWrong && log_throttle_.isFirst("gyro is wrong")) {
    ROS_WARN("gyro %s (the scans turn %.2f times as far)", toString(gyro.use()), gyro.ratio());
  }
  if (gyro.isUsed() && log_throttle_.isFirst("gyro is used")) {
    ROS_INFO("the heading between scans is the gyro's");
  }
}

}  // namespace racecar_mcl
