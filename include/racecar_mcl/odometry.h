// Odometry messages in, the car's motion between any two times out.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <string>

#include "racecar_mcl/pose.h"

namespace racecar_mcl {

/// One odometry message.
struct OdometrySample {
  double stamp = 0.0;  ///< s
  Twist2 twist;        ///< in the base frame
  Pose2 base_in_odom;  ///< used where motion is taken from poses or tf
};

/// The car's motion over some time, as dead reckoning knows it.
struct Motion {
  Pose2 delta;            ///< the later base frame in the earlier one
  double distance = 0.0;  ///< m, length of the path, reverse counted positive
  double rotation = 0.0;  ///< rad, sum of absolute turns
  double seconds = 0.0;   ///< s, spent moving
  double messages =
      0.0;  ///< odometry messages it was summed from; a share of one counts as a share
  Twist2 twist_change = {};   ///< the twist at its end less that at its beginning
  double noise_factor = 1.0;  ///< sigmas of the motion noise are this many times the usual
  std::optional<Eigen::Matrix3d> covariance = {};  ///< of `delta` (m, m, rad) where it is known
                                                   ///< better than the motion model's
};

/// What dead reckoning has summed up since the history began; differences of two make a Motion.
struct OdometryState {
  Pose2 base_in_odom;
  double distance = 0.0;  ///< m
  double rotation = 0.0;  ///< rad
  double seconds = 0.0;   ///< s, spent moving
  double messages = 0.0;
  Twist2 twist = {};  ///< at that time
};

Motion motionBetween(const OdometryState& earlier, const OdometryState& later);

enum class MotionFrom {
  kTwist,
  kPose,
  kTf,  ///< differences of poses too, which the driver takes from tf instead of from messages
};

struct OdometryParameters {
  MotionFrom motion_from = MotionFrom::kTwist;
  double max_odometry_gap = 1.0;  ///< s; a twist is not believed for longer than this
  double max_odometry_extrapolation =
      0.3;  ///< s past the newest message for which the last twist is believed
  double clock_jump =
      1.0;  ///< s; a stamp this much older than the newest means that time started again
};

/// Throws ParameterError on a value out of range.
void validate(const OdometryParameters& parameters);

enum class OdometryOutcome {
  kUsed,
  kNotFinite,      ///< NaN or inf in stamp, twist or pose: dropped
  kImplausible,    ///< over 100 m/s or 100 rad/s: a twist is dropped; after a pose the history goes
                   ///< on from there as if the car had stood still
  kRepeatedStamp,  ///< dropped
  kOutOfOrder,     ///< older than the newest: dropped
  kGap,            ///< used, but the time since the last message was longer than max_odometry_gap
  kTimeJumpedBack,  ///< used; the history starts again from here
};

/// Words for logs and diagnostics.
std::string describe(OdometryOutcome outcome);

/// The last seconds of odometry, integrated. A twist holds for the time since the message before it
/// (report, section 2.3); between messages the car moves on an arc.
class OdometryHistory {
 public:
  /// Throws as `validate` does.
  explicit OdometryHistory(const OdometryParameters& parameters = {});

  OdometryOutcome add(const OdometrySample& sample);

  bool empty() const { return entries_.empty(); }
  /// Stamp and twist of the newest message; not to be asked of an empty history.
  double newestStamp() const { return entries_.back().stamp; }
  const Twist2& newestTwist() const { return entries_.back().twist_after; }

  /// Forgets all messages but keeps the sums, as a clock that starts again asks for.
  void startAgain();

  /// The state at a time: interpolated between messages; carried on by the last twist for at most
  /// max_odometry_extrapolation after the newest; the oldest known before the history. An empty
  /// history stands still. A stamp that is NaN counts as the newest.
  OdometryState at(double stamp) const;

 private:
  struct Entry {
    double stamp;
    Twist2 twist;         ///< over the interval that ends here
    double seconds;       ///< length of that interval
    Twist2 twist_after;   ///< believed to hold after this stamp
    Pose2 base_in_odom;   ///< as the message gave it
    OdometryState state;  ///< at this stamp
  };

  OdometryParameters parameters_;
  OdometryState start_;  ///< the sums when the history began
  std::deque<Entry> entries_;
};

}  // namespace racecar_mcl
