#include "racecar_mcl/motion/turn_calibration.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "motion/scalars.h"

namespace racecar_mcl {
namespace {

// Distance driven plus turn (m, rad) over which turns are summed for scale and offset.
constexpr double kBlockDistance = 1.0;
// Standard deviation of the difference of a turn measured by the sensor and by the scans: constant,
// and in proportion to the turn (docs/maths.md).
constexpr double kTurnSigma = 0.05;        // rad
constexpr double kTurnSigmaPerTurn = 0.2;  // rad per rad
// Prior information of a delay of zero, so that no single turn determines the delay.
constexpr double kTurnDelayPrior = 4.0;  // (rad/s)^2
// Largest curvature error that is taken from one block: larger ones are slip or wrong matches.
constexpr double kMaxCurvature = 0.1;  // rad/m
constexpr double kErrorScans = 30.0;   // scans, over which the error fades

}  // namespace

TurnCalibration::TurnCalibration(const TurnErrors& errors, double distance)
    : errors_(errors), distance_(distance) {}

double TurnCalibration::error() const { return std::sqrt(squared_error_); }

void TurnCalibration::learn(const MeasuredTurn& measured, double true_turn, double travelled) {
  const double error = true_turn - correct(measured.turn, measured.exposure);
  scans_ = std::min(scans_ + 1.0, kErrorScans);
  squared_error_ += (error * error - squared_error_) / scans_;
  if (distance_ == 0.0) return;
  learnDelay(measured.rate_change, error, std::exp(-travelled / distance_));
  block_.turn += measured.turn;
  block_.exposure += measured.exposure;
  block_.true_turn += true_turn;
  block_.travelled += travelled;
  if (block_.travelled < kBlockDistance) return;
  if (!block_is_first_) learnBlock();
  block_ = {};
  block_is_first_ = false;
}

void TurnCalibration::resume(const TurnConstants& constants) {
  if (distance_ == 0.0) return;
  estimates_ = {boundedScale(constants.scale), bounded(constants.offset, errors_.max_offset),
                bounded(constants.delay, errors_.max_delay)};
}

double TurnCalibration::boundedScale(double scale) const {
  return std::clamp(scale, 1.0 / (1.0 + errors_.max_scale_error),
                    1.0 / (1.0 - errors_.max_scale_error));
}

void TurnCalibration::restart() {
  block_ = {};
  block_is_first_ = true;
}

void TurnCalibration::learnBlock() {
  const double predicted = correct(block_.turn, block_.exposure);
  const double limit = std::abs(block_.true_turn) + kMaxCurvature * block_.travelled;
  const double error = bounded(block_.true_turn - predicted, limit);
  const double variance =
      kTurnSigma * kTurnSigma + std::pow(kTurnSigmaPerTurn * block_.true_turn, 2);
  // By the relative error of the scale, and the offset.
  const Eigen::Vector2d regressor(estimates_.scale * block_.turn, block_.exposure);
  information_ = std::exp(-block_.travelled / distance_) * information_ +
                 regressor * regressor.transpose() / variance;
  Eigen::Matrix2d total = information_;
  total(0, 0) += 1.0 / (errors_.scale_sigma * errors_.scale_sigma);
  total(1, 1) += 1.0 / (errors_.offset_sigma * errors_.offset_sigma);
  const Eigen::Vector2d step = total.inverse() * regressor * (error / variance);
  estimates_.scale = boundedScale(estimates_.scale * (1.0 + step[0]));
  estimates_.offset = bounded(estimates_.offset + step[1], errors_.max_offset);
}

void TurnCalibration::learnDelay(double rate_change, double error, double memory) {
  const double change = estimates_.scale * rate_change;
  delay_information_ = memory * delay_information_ + change * change;
  const double explained = bounded(error, errors_.max_delay * std::abs(change));
  const double step = change * explained / (kTurnDelayPrior + delay_information_);
  estimates_.delay = bounded(estimates_.delay + step, errors_.max_delay);
}

}  // namespace racecar_mcl
