// Interface of the sensor models, p(scan | pose, map) (Probabilistic Robotics, chapter 6).
#pragma once

#include <Eigen/Core>
#include <memory>

#include "racecar_mcl/geometry/pose_batch.h"
#include "racecar_mcl/raycasting/range_caster.h"
#include "racecar_mcl/scan/scan.h"
#include "racecar_mcl/sensor/beam_model.h"
#include "racecar_mcl/sensor/likelihood_field.h"

namespace racecar_mcl {

/// Not thread-safe: a model has working arrays and may fill a table on demand.
class SensorModel {
 public:
  virtual ~SensorModel() = default;

  /// Writes the log-likelihood of the scan from each of N lidar poses (map frame) to N values: the
  /// sum over the beams times the model's exponent, since errors of neighbouring beams are
  /// correlated.
  virtual void logLikelihoods(const PoseBatch& lidar_in_map, const Scan& scan,
                              Eigen::Ref<Eigen::ArrayXd> log_likelihoods) = 0;
};

/// Likelihood field model; the field must outlive it. `threads`: 0 = one per core; results are
/// bit-identical for any number.
class LikelihoodFieldModel : public SensorModel {
 public:
  explicit LikelihoodFieldModel(const LikelihoodField& field, int threads = 1)
      : field_(&field), threads_(threads) {}

  void logLikelihoods(const PoseBatch& lidar_in_map, const Scan& scan,
                      Eigen::Ref<Eigen::ArrayXd> log_likelihoods) override;

 private:
  const LikelihoodField* field_;
  int threads_;
};

/// Beam model with ray casting. The model owns the caster, which may fill a cache.
class RayCastingModel : public SensorModel {
 public:
  RayCastingModel(BeamModel beam_model, std::unique_ptr<RangeCaster> caster, int threads = 1);

  void logLikelihoods(const PoseBatch& lidar_in_map, const Scan& scan,
                      Eigen::Ref<Eigen::ArrayXd> log_likelihoods) override;

 private:
  BeamModel beam_model_;
  std::unique_ptr<RangeCaster> caster_;
  int threads_;
  Eigen::ArrayXXf ranges_;  ///< m, expected ranges of a few poses per thread, one column per pose
};

}  // namespace racecar_mcl
