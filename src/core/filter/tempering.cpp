#include "racecar_mcl/filter/tempering.h"

#include <algorithm>

#include "simd/vector_math.h"

namespace racecar_mcl {
namespace {

// Bisection: accepted ratio of the effective sample size to the wanted one, maximum number of steps
// (2^-30 is below the smallest exponent), and smallest exponent.
constexpr double kTolerance = 1.01;
constexpr int kMaxSteps = 30;
constexpr double kMinExponent = 1e-6;

}  // namespace

double temperedSampleSize(const Eigen::ArrayXd& log_weights, double exponent,
                          const Eigen::ArrayXd& log_likelihoods) {
  const int size = static_cast<int>(log_weights.size());
  const double* const before = log_weights.data();
  const double* const scan = log_likelihoods.data();
  const double largest = (log_weights + exponent * log_likelihoods).maxCoeff();
  LaneSum sum, sum_of_squares;
  runWith(fastestInstructionSet(), [&]() RACECAR_MCL_INLINE_LAMBDA {
    alignas(64) double weights[kBlockSize];
    for (int first = 0; first < size; first += kBlockSize) {
      const int count = std::min(kBlockSize, size - first);
      for (int k = 0; k < count; ++k) {
        weights[k] = expOfNegative(before[first + k] + exponent * scan[first + k] - largest);
      }
      sum.add(weights, count);
      for (int k = 0; k < count; ++k) weights[k] *= weights[k];
      sum_of_squares.add(weights, count);
    }
  });
  return sum.total() * sum.total() / sum_of_squares.total();
}

double temperingExponent(const Eigen::ArrayXd& log_weights, const Eigen::ArrayXd& log_likelihoods,
                         double wanted) {
  if (log_weights.size() == 0 || !log_likelihoods.allFinite()) return 1.0;
  if (temperedSampleSize(log_weights, 1.0, log_likelihoods) >= wanted) return 1.0;
  if (temperedSampleSize(log_weights, 0.0, log_likelihoods) <= wanted) return 1.0;
  double low = 0.0;
  double high = 1.0;
  for (int step = 0; step < kMaxSteps; ++step) {
    const double middle = 0.5 * (low + high);
    const double size = temperedSampleSize(log_weights, middle, log_likelihoods);
    (size >= wanted ? low : high) = middle;
    if (size >= wanted && size < kTolerance * wanted) break;
  }
  return std::max(low, kMinExponent);
}

}  // namespace racecar_mcl
