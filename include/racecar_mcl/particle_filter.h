// Monte Carlo localization: initialise, predict, update (report, section 2.3).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "racecar_mcl/clusters.h"
#include "racecar_mcl/map_model.h"
#include "racecar_mcl/motion_model.h"
#include "racecar_mcl/particles.h"
#include "racecar_mcl/pose_estimate.h"
#include "racecar_mcl/random.h"
#include "racecar_mcl/resampling.h"
#include "racecar_mcl/scan.h"
#include "racecar_mcl/scan_fit.h"
#include "racecar_mcl/scan_weigher.h"

namespace racecar_mcl {

struct ParticleFilterParameters {
  int num_particles = 200;  ///< while tracking
  int global_particles =
      20000;  ///< after a global start; fewer as the set concentrates (KLD sampling)
  double resample_threshold = 0.5;  ///< resample when the effective sample size is at most this
                                    ///< share of the set; 1 = at every scan (the report), 0 = never
  int min_effective_particles = 100;  ///< a scan that would leave less is weighed in steps, with
                                      ///< the set resampled and spread between them; 0 = never
  ResamplingMethod resampling = ResamplingMethod::kSystematic;
  EstimateFrom estimate = EstimateFrom::kMean;
  double initial_sigma = 0.5;  ///< m and rad, where a start pose brings no spread of its own
  int settling_updates = 20;   ///< after a start the resampled set is smoothed this many times, so
                               ///< that few particles close in on a pose that none of them hit
  double news_distance = 1.0;  ///< m; while the set is in several places, a scan counts in full
                               ///< after this much driving
  bool bound_information = true;  ///< a scan counts by what the map explains of it
  int num_threads = 1;            ///< that weigh the particles; 0 = one per core. The result is the
                                  ///< same to the bit
};

/// Throws ParameterError on a value out of range.
void validate(const ParticleFilterParameters& parameters);

/// What one scan did to the filter.
struct UpdateResult {
  PoseEstimate estimate;               ///< at the scan, from the weights before resampling
  double effective_sample_size = 0.0;  ///< before resampling
  double log_likelihood = 0.0;         ///< of the scan, squashed: log of the mean weight
  int beams = 0;                       ///< beams weighed
  int particles = 0;                   ///< particles weighed
  bool resampled = false;
  bool weights_vanished = false;  ///< no particle could have seen this scan: it was not used
  bool converging = false;        ///< since a global start no single place was settled on
  std::vector<Cluster> clusters;  ///< places where particles are, heaviest first
};

/// The particle set and the steps that change it. Every random number comes from the seed.
class ParticleFilter {
 public:
  ParticleFilter(const ParticleFilterParameters& parameters, const MotionModelParameters& motion,
                 std::uint64_t seed);

  /// Samples the set around a pose. Variances of zero are taken as initial_sigma squared. Throws
  /// ParameterError on a pose or covariance that is not finite or beyond 1e7 m, or a covariance
  /// that is none.
  void initialize(const PoseEstimate& start);

  /// Spreads global_particles evenly over the free space of the map. The set then converges: it is
  /// weighed by the map's field of places, and estimated by its heaviest cluster, until a single
  /// place is left.
  void initializeGlobally(const MapModel& map);

  bool initialized() const { return particles_.size() > 0; }
  /// Since a global start no single place was settled on.
  bool converging() const { return converging_; }

  /// The same, but starting where a scan fits, in as many places as it fits in. What it returns is
  /// valid until the next update.
  const UpdateResult& initializeGlobally(const MapModel& map, const Scan& beams);

  /// Takes a set that stands in one place for its own. Returns as initializeGlobally.
  const UpdateResult& initialize(const ParticleSet& particles, const Scan& beams);

  /// Moves the set by the car's motion.
  void predict(const Motion& motion);

  /// Weighs the set by a scan whose beams were all taken from where the particles are. Once the set
  /// has settled, scans closer together than `repeat_distance` (m) err alike, and each counts by
  /// what is news in it. Throws std::logic_error before a start. What it returns is valid until
  /// the next update. Once the set has settled on a place and on its size, an update allocates
  /// nothing.
  const UpdateResult& update(MapModel* map, const Scan& beams, double repeat_distance = 0.0);

  /// The same by a likelihood field alone, for a set that is in one place.
  const UpdateResult& update(const LikelihoodField& field, const Scan& beams);

  const ParticleSet& particles() const { return particles_; }
  /// Of the set as it stands now. Throws std::logic_error before a start.
  PoseEstimate estimate() const;

 private:
  /// Takes a set, with equal weights, that is still to settle and perhaps to converge.
  void startFrom(ParticleSet particles, bool converging);
  /// The result of a start, of which a scan has said nothing yet.
  const UpdateResult& reportStart(const Scan& beams);
  void requireStart() const;
  double news(double repeat_distance) const;
  /// The share of a scan's information that is left where the map explains little of it, by the
  /// particle that explains most.
  double mappedInformation(MapModel* map, const Scan& beams, const Eigen::ArrayXd& log_likelihoods);
  /// `weigh(set)` gives the log-likelihood of the scan for each particle, in the weigher's own
  /// array, and `log_likelihoods` holds what it gave for the set as it is.
  template <typename Weigh>
  const UpdateResult& updateBy(const Weigh& weigh, Eigen::ArrayXd& log_likelihoods,
                               const Scan& beams);
  /// From the log-likelihoods of a scan to those of what counts in it, tempered while the set
  /// converges.
  void scaleToNews(Eigen::ArrayXd* log_likelihoods) const;
  /// Weighs and resamples the set by parts of a scan until what is left of it leaves enough
  /// effective particles (an annealed particle filter). In: the scan's log likelihoods, in the
  /// weigher's own array; out: those of what is left, at the new particles. Returns the log
  /// likelihood of the parts.
  template <typename Weigh>
  double anneal(const Weigh& weigh, Eigen::ArrayXd* log_likelihoods, bool* resampled);
  /// Ends the convergence where a single place is left, and leaves the others.
  void settleOn(const std::vector<Cluster>& clusters);
  /// Fills what a scan's result says of the set, by `weights_`.
  void reportSet(const Scan& beams);
  EstimateFrom kindOfEstimate() const;
  /// By `weights_`, with the clusters they make.
  PoseEstimate estimateFrom(const std::vector<Cluster>& clusters) const;
  Eigen::Index nextSize() const;
  void resampleAndSettle();

  ParticleFilterParameters parameters_;
  MotionModelParameters motion_parameters_;
  Random random_;
  ParticleSet particles_;
  int settling_updates_left_ = 0;
  std::int64_t settled_updates_ = 0;  ///< since the set settled on a place
  bool converging_ = false;
  std::optional<Motion> moved_;  ///< since the last scan; none before the first
  double news_ = 1.0;            ///< share of the scan being weighed that counts
  // Kept from update to update, so that tracking allocates nothing.
  UpdateResult result_;
  ScanWeigher weigher_;
  ScanMatcher matcher_;
  ClusterFinder cluster_finder_;
  Eigen::ArrayXd weights_;  ///< of particles_, within an update
  ParticleSet drawn_;
};

}  // namespace racecar_mcl
