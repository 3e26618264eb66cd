// What became of an odometry message.
#pragma once

#include <string>

namespace racecar_mcl {

enum class OdometryOutcome {
  kUsed,
  kNotFinite,       ///< stamp, twist or pose is not finite or beyond common/limits.h: dropped
  kImplausible,     ///< over 100 m/s or 100 rad/s: a twist is dropped; a pose becomes the new
                    ///< reference, without a motion
  kRepeatedStamp,   ///< dropped
  kOutOfOrder,      ///< older than the newest: dropped
  kStampOutlier,    ///< older by clock_jump or newer by more than max_odometry_gap, and the message
                    ///< before was not: held; the next message decides what it was
  kGap,             ///< used, but the time since the last message was longer than max_odometry_gap
  kTimeJumpedBack,  ///< used; the buffer restarts with this message
};

/// Text for logs and diagnostics.
std::string toString(OdometryOutcome outcome);

/// Whether a message with this outcome is in the buffer.
bool isUsed(OdometryOutcome outcome);

}  // namespace racecar_mcl
