#include "racecar_mcl/filter/particle_filter_parameters.h"

#include <string>

#include "racecar_mcl/common/validation.h"

namespace racecar_mcl {

void validate(const ParticleFilterParameters& p) {
  constexpr int kMaxParticles = 10000000;  // 320 MB of particles
  requireWithin("num_particles", p.num_particles, 1, kMaxParticles);
  require(p.max_particles >= p.num_particles && p.max_particles <= kMaxParticles, "max_particles",
          p.max_particles, "between num_particles and " + std::to_string(kMaxParticles));
  requireShare("resample_threshold", p.resample_threshold);
  requireNotNegative("min_effective_particles", p.min_effective_particles);
  requirePositiveUpTo("initial_sigma", p.initial_sigma, 1000.0);
  requireWithin("scan_decorrelation_distance", p.scan_decorrelation_distance, 0.0, 1000.0, "m");
  requireNotNegative("regularization_updates", p.regularization_updates);
  requireWithin("num_threads", p.num_threads, 0, 1024);
}

}  // namespace racecar_mcl
