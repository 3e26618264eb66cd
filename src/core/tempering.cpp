#include "racecar_mcl/tempering.h"

#include <algorithm>
#include <cmath>

namespace racecar_mcl {
namespace {

double effectiveSize(const Eigen::ArrayXd& log_weights) {
  const double largest = log_weights.maxCoeff();
  const Eigen::ArrayXd weights = (log_weights - largest).exp();
  const double sum = weights.sum();
  return sum * sum / weights.square().sum();
}

}  // namespace

double temperingExponent(const Eigen::ArrayXd& log_weights, const Eigen::ArrayXd& log_likelihoods,
                         double wanted) {
  if (log_weights.size() == 0 || !log_likelihoods.allFinite()) return 1.0;
  if (effectiveSize(log_weights + log_likelihoods) >= wanted) return 1.0;
  if (effectiveSize(log_weights) <= wanted) return 1.0;
  double low = 0.0;
  double high = 1.0;
  for (int step = 0; step < 20; ++step) {
    const double middle = 0.5 * (low + high);
    (effectiveSize(log_weights + middle * log_likelihoods) >= wanted ? low : high) = middle;
  }
  return std::max(low, 1e-6);
}

}  // namespace racecar_mcl
