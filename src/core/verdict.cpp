#include "racecar_mcl/verdict.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "racecar_mcl/require.h"

namespace racecar_mcl {
namespace {

// The usual share of explained beams: what it never falls below, and over how many metres it is
// learnt.
constexpr double kUsualAtLeast = 0.7;
constexpr double kUsualDistance = 10.0;  // m
constexpr double kDeviationAtFirst = 0.05;
constexpr double kDeviationAtLeast = 0.02;
// Corrections of the odometry are summed up over so long, and those within a distance forgiven.
constexpr double kCorrectionTime = 2.0;    // s
constexpr double kForgivenDistance = 0.5;  // m
constexpr double kUnusableTime = 0.5;      // s without a usable scan
constexpr int kFewestBeams = 8;            // that returned; fewer prove nothing

std::string percent(double share) { return std::to_string(std::lround(100.0 * share)) + " %"; }

}  // namespace

std::string describe(VerdictState state) {
  switch (state) {
    case VerdictState::kConverging:
      return "converging";
    case VerdictState::kLocalized:
      return "localized";
    case VerdictState::kDegraded:
      return "degraded";
    case VerdictState::kLost:
      return "lost";
  }
  return "unknown";
}

void validate(const VerdictParameters& p) {
  requirePositiveUpTo("verdict_time", p.verdict_time, 100.0, "s");
  requirePositiveUpTo("degraded_deviations", p.degraded_deviations, 1000.0);
  requireShare("lost_below", p.lost_below);
  requirePositiveUpTo("localized_sigma", p.localized_sigma, 1000.0, "m");
  requirePositiveUpTo("odometry_disagreement", p.odometry_disagreement, 1000.0);
}

Judge::Judge(const VerdictParameters& parameters)
    : parameters_((validate(parameters), parameters)),
      usual_(kUsualOfGoodMaps),
      deviation_(kDeviationAtFirst) {}

void Judge::startAgain() {
  verdict_ = Verdict{};
  heard_ = false;
  was_localized_ = false;
  doubtful_since_.reset();
  doubtful_scans_ = 0;
  unusable_since_.reset();
  correction_.setZero();
  travelled_ = 0.0;
}

void Judge::followClock(double stamp) {
  // What began later than now began in a time that the clock has left.
  for (std::optional<double>* since : {&doubtful_since_, &unusable_since_}) {
    if (*since && **since > stamp) *since = stamp;
  }
}

void Judge::average(const Evidence& evidence) {
  const double elapsed = heard_ ? std::max(0.0, evidence.stamp - last_stamp_) : 1e9;
  const double keep = std::exp(-elapsed / parameters_.verdict_time);
  explained_ = keep * explained_ + (1.0 - keep) * evidence.fit.explained;
  last_stamp_ = evidence.stamp;
  heard_ = true;

  const double remember = std::exp(-elapsed / kCorrectionTime);
  if (evidence.converging || evidence.moved) {
    correction_.setZero();
  } else {
    correction_ = remember * correction_ + evidence.correction;
  }
  travelled_ = remember * travelled_ + evidence.travelled;
}

void Judge::learnUsual(double travelled) {
  const double learnt = 1.0 - std::exp(-travelled / kUsualDistance);
  deviation_ += learnt * (std::abs(explained_ - usual_) - deviation_);
  deviation_ = std::max(kDeviationAtLeast, deviation_);
  usual_ = std::max(kUsualAtLeast, usual_ + learnt * (explained_ - usual_));
}

double Judge::leastUsual() const { return usual_ - parameters_.degraded_deviations * deviation_; }

Verdict Judge::conclude(const Evidence& evidence) const {
  const double disagreement = correction_.norm() / (travelled_ + kForgivenDistance);
  const auto verdict = [&](VerdictState state, std::string reason) {
    return Verdict{state, std::move(reason), explained_, usual_, disagreement};
  };
  const std::string fit =
      percent(explained_) + " of the beams are explained; usually " + percent(usual_);
  if (evidence.converging) {
    return was_localized_
               ? verdict(VerdictState::kLost, "searching: particles are in several places")
               : verdict(VerdictState::kConverging, "particles are in several places");
  }
  if (evidence.fit.beams < kFewestBeams) {
    return verdict(VerdictState::kDegraded, "hardly a beam returns");
  }
  if (explained_ < parameters_.lost_below * usual_) return verdict(VerdictState::kLost, fit);
  if (!was_localized_ &&
      (explained_ < leastUsual() || evidence.position_sigma > parameters_.localized_sigma)) {
    return verdict(VerdictState::kConverging, fit);
  }
  if (explained_ < leastUsual()) return verdict(VerdictState::kDegraded, fit);
  if (evidence.position_sigma > parameters_.localized_sigma) {
    return verdict(VerdictState::kDegraded, "the position is uncertain");
  }
  if (disagreement > parameters_.odometry_disagreement) {
    return verdict(VerdictState::kDegraded,
                   "odometry and scans disagree by " + percent(disagreement) + " of the way");
  }
  if (evidence.unconfirmed) {
    return verdict(VerdictState::kConverging, "a second search of the map has not agreed yet");
  }
  return verdict(VerdictState::kLocalized, fit);
}

const Verdict& Judge::judge(const Evidence& evidence) {
  followClock(evidence.stamp);
  average(evidence);
  unusable_since_.reset();
  verdict_ = conclude(evidence);
  if (verdict_.state == VerdictState::kLocalized) {
    was_localized_ = true;
    learnUsual(evidence.travelled);
  }
  const bool doubtful = !evidence.converging && evidence.fit.beams >= kFewestBeams &&
                        explained_ < std::max(leastUsual(), parameters_.lost_below * usual_);
  doubtful_scans_ = doubtful ? doubtful_scans_ + 1 : 0;
  if (!doubtful) {
    doubtful_since_.reset();
  } else if (!doubtful_since_) {
    doubtful_since_ = evidence.stamp;
  }
  return verdict_;
}

const Verdict& Judge::judgeUnusable(double stamp) {
  followClock(stamp);
  if (!unusable_since_) unusable_since_ = stamp;
  if (stamp - *unusable_since_ > kUnusableTime && verdict_.state == VerdictState::kLocalized) {
    verdict_.state = VerdictState::kDegraded;
    verdict_.reason = "no usable scan";
  }
  return verdict_;
}

void Judge::acceptAsUsual() {
  usual_ = std::max(kUsualAtLeast, std::min(usual_, explained_));
  doubtful_since_.reset();
  doubtful_scans_ = 0;
}

}  // namespace racecar_mcl
