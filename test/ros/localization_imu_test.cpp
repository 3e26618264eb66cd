// The gyro of an IMU: mount, unit and use.
#include <sensor_msgs/Imu.h>

#include "support/localization_fixture.h"

namespace racecar_mcl {
namespace {

/// A car whose odometry turns 40 % as far as the car, with an upside-down IMU.
class LocalizationImuTest : public LocalizationTest {
 protected:
  LocalizationImuTest() : imu_(handle_.advertise<sensor_msgs::Imu>("imu", 50)) {}

  void onTick() override { imu_.publish(message(car_.stamp())); }

  sensor_msgs::Imu message(double stamp) const {
    sensor_msgs::Imu message;
    message.header.stamp = ros::Time(stamp);
    message.header.frame_id = "imu";
    message.angular_velocity.z = factor_ * car_.twist.wz;
    return message;
  }

  void publishUpsideDownMount() {
    geometry_msgs::TransformStamped transform;
    transform.header.frame_id = "base_link";
    transform.child_frame_id = "imu";
    transform.transform.rotation.x = 1.0;
    static_transforms_.sendTransform(transform);
  }

  std::string gyro() const { return listener_.diagnostic("gyro"); }

  double factor_ = -1.0;  // of the measured rate: the IMU is upside down
  ros::Publisher imu_;
};

TEST_F(LocalizationImuTest, UsesAGyroThatIsMountedUpsideDown) {
  publishUpsideDownMount();
  startLocalized();
  drive(3.0);
  EXPECT_TRUE(listener_.waitForDiagnostic("gyro", "used")) << gyro();
  EXPECT_EQ(listener_.logged("imu: "), 0);
  expectStillLocalizes();
}

TEST_F(LocalizationImuTest, SaysThatTheGyroIsInDegreesAndConvertsIt) {
  publishUpsideDownMount();
  factor_ = -180.0 / kPi;
  startLocalized();
  drive(3.0);
  EXPECT_TRUE(listener_.waitForLog("degrees per second"));
  EXPECT_TRUE(listener_.waitForDiagnostic("gyro", "used")) << gyro();
  expectStillLocalizes();
}

TEST_F(LocalizationImuTest, DoesNotUseAGyroThatTurnsTheOtherWay) {
  publishUpsideDownMount();
  factor_ = 1.0;
  startLocalized();
  drive(3.0);
  EXPECT_TRUE(listener_.waitForLog("contradict the scans"));
  expectStillLocalizes();
}

TEST_F(LocalizationImuTest, RejectsAnImuWithoutAGyro) {
  startLocalized();
  sensor_msgs::Imu without = message(car_.stamp());
  without.header.frame_id = "base_link";
  without.angular_velocity_covariance[0] = -1.0;
  EXPECT_TRUE(listener_.waitFor([&] {
    imu_.publish(without);
    return listener_.logged("does not measure the angular velocity") > 0;
  }));
}

}  // namespace
}  // namespace racecar_mcl
