// Result of a particle filter update.
#pragma once

#include <vector>

#include "racecar_mcl/filter/clustering.h"
#include "racecar_mcl/filter/pose_estimate.h"

namespace racecar_mcl {

struct UpdateResult {
  PoseEstimate estimate;               ///< at the scan, from the weights before resampling
  double effective_sample_size = 0.0;  ///< before resampling
  double log_likelihood = 0.0;         ///< of the scan: log of the mean weight
  int beams = 0;                       ///< beams used
  int particles = 0;                   ///< particles evaluated
  bool resampled = false;
  bool weights_vanished = false;  ///< all likelihoods were zero: the scan was not used
  std::vector<Cluster> clusters;  ///< of the particles, heaviest first
};

}  // namespace racecar_mcl
