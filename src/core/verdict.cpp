#include "racecar_mcl/verdict.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
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
// A map that explains less is silent: scans are matched with the scans before them as well.
constexpr double kSilent = 0.75;
constexpr double kRegainedDistance = 1.0;  // m driven with the map that make up for most without it
// A scan that is explained less, or that contradicts the map more, teaches nothing of the map.
constexpr double kTeachesFrom = 0.65;
constexpr double kTeachesConflict = 0.3;
constexpr double kTeachesConflictAtFirst = 0.2;  // before the first time that it is localized
constexpr double kUsualConflictAtFirst = 0.05;
constexpr double kUsualConflictAtMost = 0.25;
// Who explains more is not lost: the right pose explains 0.42 to 0.5 for seconds in Wean Hall.
constexpr double kLostExplained = 0.4;
constexpr int kFewestBeams = 8;  // that returned; fewer prove nothing

std::string percent(double share) { return std::to_string(std::lround(100.0 * share)) + " %"; }

std::string metres(double length) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.2f m", length);
  return text;
}

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
  requireShare("lost_conflict", p.lost_conflict);
  requirePositiveUpTo("localized_sigma", p.localized_sigma, 1000.0, "m");
  requirePositiveUpTo("odometry_disagreement", p.odometry_disagreement, 1000.0);
}

Judge::Judge(const VerdictParameters& parameters, const ProtectionLevelParameters& protection)
    : parameters_((validate(parameters), parameters)),
      protection_((validate(protection), protection)),
      usual_(kUsualOfGoodMaps),
      usual_conflict_(kUsualConflictAtFirst),
      deviation_(kDeviationAtFirst) {}

void Judge::startAgain() {
  verdict_ = Verdict{};
  heard_ = false;
  was_localized_ = false;
  conflict_ = 0.0;
  carried_ = 0.0;
  unusable_since_.reset();
  correction_.setZero();
  travelled_ = 0.0;
}

void Judge::average(const Evidence& evidence) {
  const double elapsed = heard_ ? std::max(0.0, evidence.stamp - last_stamp_) : 1e9;
  const double keep = std::exp(-elapsed / parameters_.verdict_time);
  explained_ = keep * explained_ + (1.0 - keep) * evidence.fit.explained;
  conflict_ = keep * conflict_ + (1.0 - keep) * evidence.fit.conflict();
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
  usual_conflict_ =
      std::min(kUsualConflictAtMost, usual_conflict_ + learnt * (conflict_ - usual_conflict_));
}

double Judge::leastUsual() const { return usual_ - parameters_.degraded_deviations * deviation_; }

bool Judge::mapIsSilent() const { return heard_ && explained_ < kSilent; }

Verdict Judge::conclude(const Evidence& evidence) const {
  const double disagreement = correction_.norm() / (travelled_ + kForgivenDistance);
  const auto verdict = [&](VerdictState state, std::string reason) {
    Verdict made;
    made.state = state;
    made.reason = std::move(reason);
    made.explained = explained_;
    made.usually = usual_;
    made.conflict = excessConflict();
    made.carried = carried_;
    made.disagreement = disagreement;
    return made;
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
  if (excessConflict() > parameters_.lost_conflict && explained_ < kLostExplained) {
    return verdict(VerdictState::kLost,
                   "the scans contradict the map: " + percent(conflict_) + " of the beams");
  }
  const bool is_explained = explained_ >= std::max(leastUsual(), kTeachesFrom);
  const bool is_narrow = evidence.position_sigma <= parameters_.localized_sigma;
  if (!was_localized_ && !(is_explained && is_narrow)) {
    return verdict(VerdictState::kConverging, fit);
  }
  if (!is_explained) {
    return verdict(VerdictState::kDegraded, "the map does not show what the lidar sees: " + fit +
                                                "; the pose is carried +- " +
                                                metres(evidence.position_sigma));
  }
  if (!is_narrow) return verdict(VerdictState::kDegraded, "the position is uncertain");
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
  average(evidence);
  unusable_since_.reset();
  // A single scan that the map explains can lie in a wrong place.
  carried_ = mapIsSilent() ? carried_ + evidence.travelled
                           : carried_ * std::exp(-evidence.travelled / kRegainedDistance);
  verdict_ = conclude(evidence);
  if (verdict_.state == VerdictState::kLocalized || verdict_.state == VerdictState::kDegraded) {
    verdict_.level = protectionLevel(protection_, evidence.estimate, evidence.fit, carried_);
  }
  if (verdict_.state == VerdictState::kLocalized) was_localized_ = true;
  if (!evidence.converging && !evidence.unconfirmed && explained_ >= kTeachesFrom &&
      conflict_ <= (was_localized_ ? kTeachesConflict : kTeachesConflictAtFirst) &&
      evidence.position_sigma <= parameters_.localized_sigma) {
    learnUsual(evidence.travelled);
  }
  return verdict_;
}

const Verdict& Judge::judgeUnusable(double stamp) {
  // What began later than now began in a time that the clock has left.
  if (!unusable_since_ || *unusable_since_ > stamp) unusable_since_ = stamp;
  if (stamp - *unusable_since_ > kUnusableTime && verdict_.state == VerdictState::kLocalized) {
    verdict_.state = VerdictState::kDegraded;
    verdict_.reason = "no usable scan";
  }
  return verdict_;
}

}  // namespace racecar_mcl
