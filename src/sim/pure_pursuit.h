// Pure-pursuit driver on a raceline: Coulter, "Implementation of the pure pursuit path tracking
// algorithm", 1992.
#pragma once

#include <utility>

#include "sim/raceline.h"

namespace racecar_mcl::sim {

struct PurePursuitParameters {
  double look_ahead_time = 0.2;  ///< s; the look-ahead is this times the profile's speed,
  double min_look_ahead = 0.6;   ///< m, but at least this
  CarParameters car;

  /// Throws ParameterError, naming the field.
  void validate() const;
};

class PurePursuit {
 public:
  /// Throws ParameterError.
  PurePursuit(Raceline raceline, const PurePursuitParameters& parameters)
      : raceline_(std::move(raceline)), parameters_(parameters) {
    parameters_.validate();
  }

  const Raceline& raceline() const { return raceline_; }

  /// Steers on the arc through the raceline's point at the look-ahead, at the profile's speed.
  /// `base_in_map`: the true pose or an estimate of it.
  Command drive(const Pose2& base_in_map) const;

 private:
  Raceline raceline_;
  PurePursuitParameters parameters_;
};

}  // namespace racecar_mcl::sim
