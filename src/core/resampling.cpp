#include "racecar_mcl/resampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

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
  // Rounding must not lift a uniform set above its own size.
  return std::min(static_cast<double>(log_weights.size()), 1.0 / (2.0 * log_weights).exp().sum());
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
  if (!(sum > 0.0 && std::isfinite(sum))) {
    throw std::invalid_argument("nothing can be drawn from " + std::to_string(particles.size()) +
                                " particles whose weights sum to " + std::to_string(sum));
  }
  const double step = sum / static_cast<double>(count);
  // Rounding must not carry a pointer past the last particle that has a weight.
  const double last_pointer = std::nextafter(sum, 0.0);
  const double offset = random.uniform();
  Eigen::Index source = 0;
  for (Eigen::Index k = 0; k < count; ++k) {
    if (method == ResamplingMethod::kSystematic) {
      const double pointer = std::min((static_cast<double>(k) + offset) * step, last_pointer);
      while (cumulative[source] <= pointer) ++source;
    } else {
      const double pointer = std::min(random.uniform() * sum, last_pointer);
      const double* begin = cumulative.data();
      const double* found = std::upper_bound(begin, begin + cumulative.size(), pointer);
      source = found - begin;
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
