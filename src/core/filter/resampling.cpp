#include "racecar_mcl/filter/resampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

#include "simd/vector_math.h"

namespace racecar_mcl {

namespace {

RACECAR_MCL_INLINE double maxOf(const double* values, int size) {
  constexpr int kLanes = 8;
  double lanes[kLanes];
  std::fill(lanes, lanes + kLanes, -std::numeric_limits<double>::infinity());
  int i = 0;
  for (; i + kLanes <= size; i += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) {
      lanes[lane] = values[i + lane] > lanes[lane] ? values[i + lane] : lanes[lane];
    }
  }
  for (; i < size; ++i) lanes[0] = values[i] > lanes[0] ? values[i] : lanes[0];
  return *std::max_element(lanes, lanes + kLanes);
}

/// weights = exp(log_weights - largest); returns their sum, NaN if a log weight is NaN.
RACECAR_MCL_INLINE double exponentials(const double* __restrict log_weights, double largest,
                                       int size, double* __restrict weights) {
  LaneSum sum;
  for (int first = 0; first < size; first += kBlockSize) {
    const int count = std::min(kBlockSize, size - first);
    for (int i = first; i < first + count; ++i) {
      weights[i] = expOfNegative(log_weights[i] - largest);
    }
    sum.add(weights + first, count);
  }
  return sum.total();
}

void drawSystematically(const ParticleSet& particles, const Eigen::ArrayXd& weights, double sum,
                        double last_pointer, double offset, ParticleSet* drawn) {
  const double step = sum / static_cast<double>(drawn->size());
  Eigen::Index source = 0;
  double cumulative = weights[0];
  for (Eigen::Index k = 0; k < drawn->size(); ++k) {
    const double pointer = std::min((static_cast<double>(k) + offset) * step, last_pointer);
    while (cumulative <= pointer) cumulative += weights[++source];
    drawn->setPose(k, particles.pose(source));
  }
}

void drawMultinomially(const ParticleSet& particles, const Eigen::ArrayXd& weights, double sum,
                       double last_pointer, Random& random, ParticleSet* drawn) {
  Eigen::ArrayXd cumulative(weights.size());
  std::partial_sum(weights.data(), weights.data() + weights.size(), cumulative.data());
  const double* begin = cumulative.data();
  for (Eigen::Index k = 0; k < drawn->size(); ++k) {
    const double pointer = std::min(random.uniform() * sum, last_pointer);
    const double* found = std::upper_bound(begin, begin + cumulative.size(), pointer);
    drawn->setPose(k, particles.pose(found - begin));
  }
}

}  // namespace

double normalizeLogWeights(Eigen::ArrayXd* log_weights, Eigen::ArrayXd* weights) {
  constexpr double kLogZero = -std::numeric_limits<double>::infinity();
  const int size = static_cast<int>(log_weights->size());
  weights->resize(size);
  double largest = kLogZero;
  double sum = 0.0;
  runWith(fastestInstructionSet(), [&]() RACECAR_MCL_INLINE_LAMBDA {
    largest = maxOf(log_weights->data(), size);
    if (std::isfinite(largest)) {
      sum = exponentials(log_weights->data(), largest, size, weights->data());
    }
  });
  if (!(sum > 0.0)) return kLogZero;
  const double log_sum = largest + std::log(sum);
  *log_weights -= log_sum;
  *weights *= 1.0 / sum;
  return log_sum;
}

double normalizeLogWeights(Eigen::ArrayXd* log_weights) {
  Eigen::ArrayXd weights;
  return normalizeLogWeights(log_weights, &weights);
}

void weightsOf(const ParticleSet& particles, Eigen::ArrayXd* weights) {
  // Eigen's vectorized exp(-inf) is slightly above zero.
  *weights = particles.log_weight.unaryExpr([](double value) { return std::exp(value); });
}

Eigen::ArrayXd weightsOf(const ParticleSet& particles) {
  Eigen::ArrayXd weights;
  weightsOf(particles, &weights);
  return weights;
}

double effectiveSampleSize(const Eigen::ArrayXd& weights) {
  if (weights.size() == 0) return 0.0;
  // Rounding must not make it exceed the number of particles.
  return std::min(static_cast<double>(weights.size()), 1.0 / weights.square().sum());
}

void resample(const ParticleSet& particles, const Eigen::ArrayXd& weights, ResamplingMethod method,
              Random& random, ParticleSet* drawn) {
  const Eigen::Index count = drawn->size();
  drawn->log_weight.setConstant(-std::log(static_cast<double>(count)));
  double sum = 0.0;
  for (Eigen::Index i = 0; i < weights.size(); ++i) sum += weights[i];
  if (!(sum > 0.0 && std::isfinite(sum))) {
    throw std::invalid_argument("cannot resample " + std::to_string(particles.size()) +
                                " particles whose weights sum to " + std::to_string(sum));
  }
  // Rounding must not move a pointer past the last particle with a weight above zero.
  const double last_pointer = std::nextafter(sum, 0.0);
  if (method == ResamplingMethod::kSystematic) {
    drawSystematically(particles, weights, sum, last_pointer, random.uniform(), drawn);
  } else {
    drawMultinomially(particles, weights, sum, last_pointer, random, drawn);
  }
}

ParticleSet resample(const ParticleSet& particles, Eigen::Index count, ResamplingMethod method,
                     Random& random) {
  ParticleSet drawn;
  drawn.resize(count);
  resample(particles, weightsOf(particles), method, random, &drawn);
  return drawn;
}

Eigen::Index countOccupiedBins(const ParticleSet& particles, const PoseBins& bins) {
  BinNumbers numbers;
  numbers.reset(static_cast<std::size_t>(particles.size()));
  for (Eigen::Index i = 0; i < particles.size(); ++i) numbers.add(binOf(particles.pose(i), bins));
  return numbers.size();
}

Eigen::Index kldSampleSize(Eigen::Index occupied_bins, double error, double quantile) {
  if (occupied_bins <= 1) return 1;
  const double k = static_cast<double>(occupied_bins - 1);
  const double a = 2.0 / (9.0 * k);
  const double b = 1.0 - a + std::sqrt(a) * quantile;
  return static_cast<Eigen::Index>(std::ceil(k / (2.0 * error) * b * b * b));
}

}  // namespace racecar_mcl
