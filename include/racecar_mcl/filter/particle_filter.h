// Particle filter of Monte Carlo localization: initialize, predict, update (report, section 2.3).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "racecar_mcl/common/random.h"
#include "racecar_mcl/filter/clustering.h"
#include "racecar_mcl/filter/particle_filter_parameters.h"
#include "racecar_mcl/filter/pose_estimate.h"
#include "racecar_mcl/filter/update_result.h"
#include "racecar_mcl/geometry/particle_set.h"
#include "racecar_mcl/monitoring/scan_match.h"
#include "racecar_mcl/motion/motion_model.h"
#include "racecar_mcl/scan/scan.h"
#include "racecar_mcl/sensor/map_view.h"
#include "racecar_mcl/sensor/scan_likelihood.h"
#include "racecar_mcl/sensor/sensor_model.h"

namespace racecar_mcl {

/// Draws `count` poses with equal weights.
using PoseSampler = std::function<ParticleSet(Eigen::Index count, Random& random)>;

/// Deterministic: all random numbers derive from the seed.
class ParticleFilter {
 public:
  ParticleFilter(const ParticleFilterParameters& parameters, const MotionModelParameters& motion,
                 std::uint64_t seed);

  /// The particles are kept; the next update resamples them if num_particles changes. Throws
  /// ParameterError, and then changes nothing.
  void setParameters(const ParticleFilterParameters& parameters,
                     const MotionModelParameters& motion);

  /// Samples num_particles from a Gaussian. Variances of zero are replaced by initial_sigma
  /// squared. Throws ParameterError if the pose or covariance is not finite, if a coordinate or
  /// standard deviation exceeds 1e7 m, or if the covariance is not positive semi-definite.
  void initialize(const PoseEstimate& start);

  /// Replaces the set by max_particles poses from `sample`. The set is then not converged: the
  /// estimate is its heaviest cluster until a single cluster is left. The result is valid until the
  /// next update.
  const UpdateResult& initializeGlobally(const PoseSampler& sample);

  /// Replaces the set by a converged (unimodal) one. The result is valid until the next update.
  const UpdateResult& replaceSet(const ParticleSet& particles);

  bool initialized() const { return particles_.size() > 0; }
  /// False after a global start until a single cluster is left.
  bool converged() const { return converged_; }

  /// Samples the motion model for every particle.
  void predict(const Motion& motion);

  /// Reweights the set by a deskewed scan, and resamples. For a converged set, scans closer
  /// together than `decorrelation_distance` (m) have correlated errors and are down-weighted; with
  /// `map`, so are scans with a low inlier ratio (bound_information). Throws std::logic_error
  /// before a start. The result is valid until the next update. Allocates nothing once the set has
  /// converged and its size is constant.
  const UpdateResult& update(const Scan& scan, SensorModel* model, const MapView* map = nullptr,
                             double decorrelation_distance = 0.0);

  const ParticleSet& particles() const { return particles_; }
  /// The estimate of the current set. Throws std::logic_error before a start.
  PoseEstimate estimate() const;

 private:
  /// Takes a new set, with equal weights, and restarts the regularization.
  const UpdateResult& startFrom(ParticleSet particles, bool converged);
  void requireStart() const;
  /// The exponent of a scan's likelihood after the motion since the last scan of its lidar; none
  /// before the first.
  double decorrelationExponent(const std::optional<Motion>& moved, double distance) const;
  /// The exponent of a scan's likelihood by its inlier ratio at the most likely particle.
  double informationExponent(const MapView& map, const Scan& scan);
  /// Raises the likelihoods to `exponent`; tempers them as well until the set has converged.
  void scaleLogLikelihoods(double exponent);
  /// Annealed particle filter (Deutscher et al. 2000): reweights and resamples the set by a power
  /// of the likelihood until the rest of it, in `log_likelihoods_`, leaves enough effective
  /// particles. Returns the log-likelihood of the powers used.
  double anneal(const Scan& scan, SensorModel* model, double exponent);
  /// Adds `log_likelihoods_` to the log weights if any is finite; returns the log of the mean
  /// weight.
  double reweight();
  /// Marks the set as converged if a single cluster is left, and removes particles outside it.
  void collapseToMode(const std::vector<Cluster>& clusters);
  /// Fills `result_` from the set and `weights_`.
  void summarizeSet(int beams);
  EstimateFrom estimateKind() const;
  /// The estimate of the set with `weights_`, whose clusters are given.
  PoseEstimate estimateFrom(const std::vector<Cluster>& clusters) const;
  Eigen::Index nextSize() const;
  void resampleAndRegularize();

  ParticleFilterParameters parameters_;
  MotionModelParameters motion_parameters_;
  Random random_;
  ParticleSet particles_;
  int regularization_updates_left_ = 0;
  std::int64_t converged_updates_ = 0;  ///< updates since the set converged
  bool converged_ = true;
  bool resize_is_due_ = false;  ///< num_particles has changed since the start or resampling
  /// Motion since the last scan of each lidar; none before a motion.
  std::array<std::optional<Motion>, kMaxLidars> moved_;
  // Reused from update to update, so that tracking allocates nothing.
  UpdateResult result_;
  ScanLikelihood scan_likelihood_;
  ScanMatchEvaluator match_evaluator_;
  ClusterFinder cluster_finder_;
  Eigen::ArrayXd log_likelihoods_;  ///< of the scan, during an update
  Eigen::ArrayXd weights_;          ///< of particles_, during an update
  ParticleSet drawn_;
};

}  // namespace racecar_mcl
