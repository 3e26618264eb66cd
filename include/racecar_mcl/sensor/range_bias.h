// Online estimation of the range bias: the mean difference of measured ranges and distances to the
// map's surfaces.
//
// Walls of a map are quantized to cells, on either side of the true surface, and lidars have
// offsets. Both add a constant to every range. With a forward-looking lidar this constant becomes
// an error of the position along the path, whatever the number of particles.
#pragma once

#include "racecar_mcl/sensor/scan_score.h"

namespace racecar_mcl {

struct RangeBiasParameters {
  double range_bias = 0.0;  ///< m, initial value: measured minus mapped
  /// Distance constant of the average, m driven; 0 = constant bias.
  double range_bias_distance = 50.0;
};

/// Throws ParameterError on a bias beyond 0.1 m or a distance outside [0, 1e6].
void validate(const RangeBiasParameters& parameters);

/// Maximum-likelihood estimate by Fisher scoring on the likelihood field. The score of each scan is
/// taken with respect to pose and bias, and the pose is marginalised, so that pose errors do not
/// appear as bias (docs/maths.md).
class RangeBias {
 public:
  /// Throws as `validate` does.
  explicit RangeBias(const RangeBiasParameters& parameters = {});

  /// The estimate is kept, unless the initial value changes. Throws as the constructor, and then
  /// changes nothing.
  void setParameters(const RangeBiasParameters& parameters);

  /// Updates the estimate with the score of a corrected and deskewed scan; `travelled`: m driven
  /// since the last one.
  void learn(const ScanScore& scan, double travelled);

  /// Continues from the estimate of an earlier run, within the limits; not if the bias is constant.
  void resume(double bias);

  /// Back to the initial value, as if it was estimated from wrongly deskewed sweeps.
  void reset();

  double bias() const { return bias_; }  ///< m

 private:
  RangeBiasParameters parameters_;
  double bias_ = 0.0;         ///< m
  double information_ = 0.0;  ///< 1/m^2
};

}  // namespace racecar_mcl
