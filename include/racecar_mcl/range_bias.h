// By how much measured ranges are longer than the distances to the map's surfaces, learned while
// driving.
//
// A map's walls are drawn to whole cells, from the inside or the outside of the true surface, and
// lidars have offsets of their own. Both act like a constant added to every range. A lidar that
// looks ahead turns that constant into a lead along the way, which no number of particles removes.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/likelihood_field.h"
#include "racecar_mcl/pose.h"
#include "racecar_mcl/scan.h"

namespace racecar_mcl {

struct RangeBiasParameters {
  double range_bias = 0.0;            ///< m, at the start: measured less mapped
  double range_bias_distance = 50.0;  ///< m driven, over which it is averaged; 0 = not learned
};

/// Throws ParameterError on a bias beyond 0.1 m or a distance outside [0, 1e6].
void validate(const RangeBiasParameters& parameters);

/// A maximum-likelihood estimate by Fisher scoring on the likelihood field. Each scan is scored
/// with respect to pose and bias together and the pose is marginalised, so that an error of the
/// pose is not taken for a bias: only what the walls on both sides agree on is.
class RangeBias {
 public:
  /// Throws as `validate` does.
  explicit RangeBias(const RangeBiasParameters& parameters = {});

  /// Subtracts the bias from every range. Ranges stay above zero.
  void correct(Scan* scan) const;

  /// Learns from a corrected and deskewed scan, taken from this pose after driving `travelled` m.
  void learn(const LikelihoodField& field, const Pose2& base_in_map, const Scan& beams,
             double travelled);

  /// Forgets what was learned, as where it was learned from bent sweeps.
  void reset();

  double bias() const { return bias_; }  ///< m

 private:
  RangeBiasParameters parameters_;
  double bias_ = 0.0;         ///< m
  double information_ = 0.0;  ///< 1/m^2
};

}  // namespace racecar_mcl
