#include "racecar_mcl/motion/odometry_outcome.h"

namespace racecar_mcl {

std::string toString(OdometryOutcome outcome) {
  switch (outcome) {
    case OdometryOutcome::kUsed:
      return "used";
    case OdometryOutcome::kNotFinite:
      return "odometry holds NaN or inf, a pose beyond 1e7 m or a stamp beyond 1e10 s";
    case OdometryOutcome::kImplausible:
      return "odometry implies a speed above 100 m/s or 100 rad/s";
    case OdometryOutcome::kRepeatedStamp:
      return "odometry stamp repeats";
    case OdometryOutcome::kOutOfOrder:
      return "odometry is older than the newest";
    case OdometryOutcome::kStampOutlier:
      return "odometry stamp is far from the stamps before it";
    case OdometryOutcome::kGap:
      return "odometry was missing for longer than max_odometry_gap";
    case OdometryOutcome::kTimeJumpedBack:
      return "odometry time jumped back";
  }
  return "unknown";
}

bool isUsed(OdometryOutcome outcome) {
  return outcome == OdometryOutcome::kUsed || outcome == OdometryOutcome::kGap ||
         outcome == OdometryOutcome::kTimeJumpedBack;
}

}  // namespace racecar_mcl
