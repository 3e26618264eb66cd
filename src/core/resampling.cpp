#include "racecar_mcl/resampling.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pose_bins.h"

namespace racecar_mcl {

double normalizeLogWeights(Eigen::ArrayXd* log_weights) {
  constexpr double kNothing = -std::numeric_limits<double>::infinity();
  if (log_weights->size() == 0) return kNothing;
  // A NaN compares false with everything, so it is looked for by itself.
  const double largest = log_weights->maxCoeff();
  if (!std::isfinite(largest) || log_weights->isNaN().any()) return kNothing;
  const double log_sum = largest + std::log((*log_weights - largest).exp().sum());
  *log_weights -= log_sum;
  return log_sum;
}

double effectiveSampleSize(const Eigen::ArrayXd& log_weights) {
  if (log_weights.size() == 0) return 0.0;
  return 1.0 / (2.0 * log_weights).exp().sum();
}

ParticleSet resample(const ParticleSet& particles, Eigen::Index count, ResamplingMethod method,
                     Random& random) {
  ParticleSet drawn;
  drawn.resize(count);
  drawn.log_weight.setConstant(-std::log(static_cast<double>(count)));

  Eigen::ArrayXd cumulative(particles.size());
  double sum = 0.0;
  for (Eigen::Index i = 0; i < particles.size(); ++i) {
    sum += std::exp(particles.log_weight[i]);
    cumulative[i] = sum;
  }
  const double step = sum / static_cast<double>(count);
  const double offset = random.uniform();
  Eigen::Index source = 0;
  for (Eigen::Index k = 0; k < count; ++k) {
    if (method == ResamplingMethod::kSystematic) {
      const double pointer = (static_cast<double>(k) + offset) * step;
      while (source + 1 < particles.size() && cumulative[source] <= pointer) ++source;
    } else {
      const double pointer = random.uniform() * sum;
      const double* begin = cumulative.data();
      const double* found = std::upper_bound(begin, begin + cumulative.size(), pointer);
      source = std::min<Eigen::Index>(found - begin, particles.size() - 1);
    }
    drawn.setPose(k, particles.pose(source));
  }
  return drawn;
}

Eigen::Index countOccupiedBins(const ParticleSet& particles, const PoseBins& bins) {
  return static_cast<Eigen::Index>(groupByBin(particles, bins).size());
}

Eigen::Index kldSampleSize(Eigen::Index occupied_bins, double error, double quantile) {
  if (occupied_bins <= 1) return 1;
  const double k = static_cast<double>(occupied_bins - 1);
  const double a = 2.0 / (9.0 * k);
  const double b = 1.0 - a + std::sqrt(a) * quantile;
  return static_cast<Eigen::Index>(std::ceil(k / (2.0 * error) * b * b * b));
}

}  // namespace racecar_mcl
