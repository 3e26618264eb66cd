#include "racecar_mcl/motion/gyro_calibration.h"

#include <cmath>

namespace racecar_mcl {
namespace {

// Turns are compared over this time, so that the scans' noise does not count as a turn, if they
// exceed kMinTurn. The comparison counts after kProofTurn and fades over kMemoryTurn.
constexpr double kComparisonSeconds = 0.5;  // s
constexpr double kMinTurn = 0.1;            // rad
constexpr double kProofTurn = 0.4;          // rad
constexpr double kMemoryTurn = 6.0;         // rad
// Ratios up to this factor from 1 are scale errors; others are another unit or mount.
constexpr double kMaxRatio = 1.3;
// Turns in degrees correlate with the scans'; noise may have any ratio. Fewer comparisons always
// correlate.
constexpr double kMinCorrelation = 0.9;
constexpr int kMinComparisons = 3;
// The gyro is dropped if its error exceeds the odometry's by this factor, and taken up again if it
// does not.
constexpr double kMaxErrorRatio = 1.2;
constexpr double kRadiansPerDegree = kPi / 180.0;
// MEMS gyros: 3 % of scale and 0.05 rad/s of bias beyond that at rest.
const TurnErrors kErrors{0.03, 0.05, 0.1, 0.2, 0.1};

bool isNearOne(double ratio) { return ratio > 1.0 / kMaxRatio && ratio < kMaxRatio; }

}  // namespace

const char* toString(GyroUse use) {
  switch (use) {
    case GyroUse::kNoData:
      return "no data";
    case GyroUse::kUnproven:
      return "not used: waiting for a turn of the car";
    case GyroUse::kUsed:
      return "used";
    case GyroUse::kWorse:
      return "not used: odometry agrees better with the scans";
    case GyroUse::kWrong:
      return "not used: its turns contradict the scans; check its mount and unit";
  }
  return "unknown";
}

GyroCalibration::GyroCalibration(double distance) : calibration_(kErrors, distance) {}

double GyroCalibration::turnOf(const Motion& motion) const {
  return calibration_.correct(unit_ * motion.gyro->turn, motion.duration);
}

void GyroCalibration::compare(const Motion& motion, double true_turn) {
  gyro_turn_ += unit_ * motion.gyro->turn;
  true_turn_ += true_turn;
  seconds_ += motion.duration;
  if (seconds_ < kComparisonSeconds) return;
  if (std::abs(true_turn_) > kMinTurn) {
    const double memory = std::exp(-std::abs(true_turn_) / kMemoryTurn);
    ++comparisons_;
    turned_ = memory * turned_ + std::abs(true_turn_);
    product_ = memory * product_ + gyro_turn_ * true_turn_;
    gyro_squared_ = memory * gyro_squared_ + gyro_turn_ * gyro_turn_;
    true_squared_ = memory * true_squared_ + true_turn_ * true_turn_;
  }
  gyro_turn_ = true_turn_ = seconds_ = 0.0;
}

bool GyroCalibration::measuresDegrees() const {
  return unit_ == 1.0 && comparisons_ >= kMinComparisons &&
         isNearOne(ratio() / kRadiansPerDegree) &&
         product_ > kMinCorrelation * std::sqrt(gyro_squared_ * true_squared_);
}

void GyroCalibration::learn(const Motion& motion, double true_turn, double odometry_error) {
  if (!motion.gyro) return;
  if (use_ == GyroUse::kNoData) use_ = GyroUse::kUnproven;
  compare(motion, true_turn);
  if (turned_ < kProofTurn) return;
  if (measuresDegrees()) {
    unit_ = kRadiansPerDegree;
    product_ *= unit_;
    gyro_squared_ *= unit_ * unit_;
    gyro_turn_ *= unit_;
  }
  if (!isNearOne(ratio())) {
    use_ = GyroUse::kWrong;
    return;
  }
  calibration_.learn({unit_ * motion.gyro->turn, motion.duration, unit_ * motion.gyro->rate},
                     true_turn, motion.distance + motion.rotation);
  use_ = calibration_.error() <= kMaxErrorRatio * odometry_error ? GyroUse::kUsed : GyroUse::kWorse;
}

}  // namespace racecar_mcl
