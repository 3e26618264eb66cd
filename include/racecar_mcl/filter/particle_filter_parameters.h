// Parameters of the particle filter.
#pragma once

#include "racecar_mcl/filter/pose_estimate.h"
#include "racecar_mcl/filter/resampling.h"

namespace racecar_mcl {

struct ParticleFilterParameters {
  int num_particles = 200;    ///< while tracking
  int max_particles = 20000;  ///< after a global start; KLD sampling then reduces the number
  /// Resample if the effective sample size is at most this fraction of the set; 1 = at every scan
  /// (the report), 0 = never.
  double resample_threshold = 0.5;
  /// A likelihood that would leave fewer is applied in annealing steps, with resampling between
  /// them; 0 = never.
  int min_effective_particles = 50;
  ResamplingMethod resampling = ResamplingMethod::kSystematic;
  EstimateFrom estimate = EstimateFrom::kMean;
  double initial_sigma = 0.5;       ///< m and rad, for variances of zero in a start pose
  int regularization_updates = 20;  ///< resampled sets that are smoothed by a kernel after a start
  double scan_decorrelation_distance = 1.0;  ///< m driven, after which a scan counts in full until
                                             ///< the set has converged; 0 = always in full
  bool bound_information = true;             ///< down-weight scans with a low inlier ratio
  /// Threads of the sensor model; 0 = one per core. Results are bit-identical for any number.
  int num_threads = 1;
};

/// Throws ParameterError on a value out of range.
void validate(const ParticleFilterParameters& parameters);

}  // namespace racecar_mcl
