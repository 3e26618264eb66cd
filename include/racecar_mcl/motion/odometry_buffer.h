// Buffer of odometry messages: the car's motion between any two times by dead reckoning.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "racecar_mcl/geometry/pose2.h"
#include "racecar_mcl/motion/clock_jump_detector.h"
#include "racecar_mcl/motion/gyro_buffer.h"
#include "racecar_mcl/motion/odometry_outcome.h"

namespace racecar_mcl {

/// One odometry message.
struct OdometrySample {
  double stamp = 0.0;  ///< s
  Twist2 twist;        ///< in the base frame
  Pose2 base_in_odom;  ///< used if motion_from is kPose or kTf
};

/// The car's motion over an interval, by dead reckoning.
struct Motion {
  Pose2 delta;                  ///< the later base frame in the earlier one
  double distance = 0.0;        ///< m, length of the path, reverse counted positive
  double rotation = 0.0;        ///< rad, sum of absolute turns
  double seconds = 0.0;         ///< s, spent moving
  double messages = 0.0;        ///< number of odometry messages integrated, with fractions
  Twist2 twist_change = {};     ///< the twist at the end minus that at the beginning
  double turn = 0.0;            ///< rad, of the odometry, not wrapped and not calibrated
  double noise_scale = 1.0;     ///< factor on the standard deviations of the motion noise
  double scale_variance = 0.0;  ///< m^2, along, since the distance scale is not yet known
  /// Covariance of `delta` (m, m, rad), if known; replaces that of the motion model.
  std::optional<Eigen::Matrix3d> covariance = {};
  double duration = 0.0;  ///< s, between the two times
  /// Turn (rad) and change of the turn rate (rad/s) of the gyro, not calibrated; none without one.
  std::optional<GyroState> gyro = {};
  bool turned_by_gyro = false;  ///< the yaw of `delta` is the gyro's
  /// The estimated twist of the car that replaces the odometry's, if any (SlipCompensation).
  std::optional<Twist2> compensation = {};
};

/// Dead reckoning since the first message; the difference of two states is a Motion.
struct OdometryState {
  Pose2 base_in_odom;
  double distance = 0.0;  ///< m
  double rotation = 0.0;  ///< rad
  double seconds = 0.0;   ///< s, spent moving
  double messages = 0.0;
  Twist2 twist = {};
  double turn = 0.0;  ///< rad, not wrapped
};

/// The motion from the earlier to the later state.
Motion motionBetween(const OdometryState& earlier, const OdometryState& later);

enum class MotionFrom {
  kTwist,
  kPose,
  kTf,  ///< as kPose, with poses from tf instead of messages
};

struct OdometryParameters {
  MotionFrom motion_from = MotionFrom::kTwist;
  double max_odometry_gap = 1.0;  ///< s; over a longer gap a twist is integrated for this time
                                  ///< only, over more than 20 s not at all
  double max_odometry_extrapolation =
      0.3;                  ///< s past the newest message for which the last twist is extrapolated
  double clock_jump = 1.0;  ///< s; two stamps older than the newest by this restart the time
};

/// Throws ParameterError on a value out of range.
void validate(const OdometryParameters& parameters);

/// The last 10 s of odometry, integrated. A twist is valid for the time since the previous message
/// (report, section 2.3); between messages the car moves on an arc.
class OdometryBuffer {
 public:
  /// Throws as `validate` does.
  explicit OdometryBuffer(const OdometryParameters& parameters = {});

  /// For the messages from now on. Throws as the constructor, and then changes nothing.
  void setParameters(const OdometryParameters& parameters);

  OdometryOutcome add(const OdometrySample& sample);

  bool empty() const { return entries_.empty(); }
  /// Of the first message that is kept. Precondition, here and below: not empty.
  double oldestStamp() const { return entries_.front().stamp; }
  /// Stamp and twist of the newest message.
  double newestStamp() const { return entries_.back().stamp; }
  const Twist2& newestTwist() const { return entries_.back().twist_after; }
  /// Whether the car has stood still for the last 0.5 s, according to new messages.
  bool isAtRest(double stamp) const;
  /// The longest of the recent intervals between messages, s; 0 before the second message.
  double period() const { return clock_jump_.period(); }

  /// Removes all messages but keeps the integrated state, for a restart of the clock.
  void reset();

  /// The state at a time: interpolated between messages; extrapolated by the last twist for at most
  /// max_odometry_extrapolation after the newest; the oldest state before the first. An empty
  /// buffer returns the last integrated state. A stamp of NaN counts as the newest.
  OdometryState at(double stamp) const;

  /// A copy without the messages that states from this time on do not need.
  OdometryBuffer since(double stamp) const;

 private:
  struct Entry {
    double stamp;
    Twist2 twist;         ///< over the interval that ends here
    double seconds;       ///< length of that interval
    Twist2 twist_after;   ///< for extrapolation after this stamp
    Pose2 base_in_odom;   ///< of the message
    OdometryState state;  ///< at this stamp
  };

  OdometryOutcome insert(const OdometrySample& sample);

  OdometryParameters parameters_;
  ClockJumpDetector clock_jump_;
  std::optional<OdometrySample> held_;  ///< the last message, if its stamp was an outlier
  OdometryState start_;                 ///< the state at the first message
  std::deque<Entry> entries_;
};

}  // namespace racecar_mcl
