#include "racecar_mcl/localizer/scan_result.h"

#include <cmath>
#include <cstdio>

namespace racecar_mcl {
namespace {

constexpr double kMaxOdometryLag = 1.0;  // s, between the stamps of a scan and of odometry

}  // namespace

std::string toString(ScanOutcome outcome) {
  switch (outcome) {
    case ScanOutcome::kUsed:
      return "used";
    case ScanOutcome::kStationary:
      return "stationary: the estimate stays";
    case ScanOutcome::kNoMap:
      return "no map yet";
    case ScanOutcome::kNoStart:
      return "no start pose yet";
    case ScanOutcome::kNotFinite:
      return "scan stamp is not within 1e10 s or its lidar not within 100 m of base_link";
    case ScanOutcome::kRepeatedStamp:
      return "scan stamp repeats";
    case ScanOutcome::kTooManyLidars:
      return "scan is of a ninth lidar; at most 8 are supported";
    case ScanOutcome::kOutOfOrder:
      return "scan is older than the last one";
    case ScanOutcome::kStampOutlier:
      return "scan stamp is far from the stamps before it";
    case ScanOutcome::kTooFewBeams:
      return "scan has too few valid beams";
    case ScanOutcome::kTimeJumpedBack:
      return "scan time jumped back";
    case ScanOutcome::kWeightsVanished:
      return "no particle could have seen this scan";
  }
  return "unknown";
}

std::string clockProblem(const ScanResult& result) {
  if (std::abs(result.odometry_lag) <= kMaxOdometryLag) return "";
  char text[160];
  std::snprintf(text, sizeof(text),
                "stamps of scans are %.1f s %s the newest odometry; expected stamps of one clock, "
                "and odometry up to the scan",
                std::abs(result.odometry_lag), result.odometry_lag < 0.0 ? "behind" : "ahead of");
  return text;
}

bool hasEstimate(ScanOutcome outcome) {
  return outcome == ScanOutcome::kUsed || outcome == ScanOutcome::kStationary ||
         outcome == ScanOutcome::kWeightsVanished;
}

}  // namespace racecar_mcl
