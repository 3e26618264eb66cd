#include "offline/particle_recorder.h"

#include <cstdio>

namespace racecar_mcl {

void ParticleRecorder::onScan(const Scan& scan, const ScanRow& row, const Localizer& localizer) {
  if (last_ && scan.stamp >= *last_ && scan.stamp < *last_ + period_) return;
  last_ = scan.stamp;
  const ParticleSet& particles = localizer.particles();
  const double total = particles.log_weight.exp().sum();
  const std::string stamp = formatStamp(row.stamp);
  char line[128];
  for (Eigen::Index i = 0; i < particles.size(); ++i) {
    std::snprintf(line, sizeof(line), ",%.6f,%.6f,%.9f,%.9g\n", particles.x[i], particles.y[i],
                  particles.yaw[i], std::exp(particles.log_weight[i]) / total);
    text_ += stamp + line;
  }
}

}  // namespace racecar_mcl
