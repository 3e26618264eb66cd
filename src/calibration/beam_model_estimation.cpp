#include "calibration/beam_model_estimation.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace racecar_mcl {
namespace {

enum Component { kHit, kShort, kMax, kRand, kComponents };
using Weights = Eigen::Array<double, kComponents, 1>;

constexpr int kMaxIterations = 2000;
constexpr double kTolerance = 1e-7;         // on the change of weights and log sigma_hit
constexpr double kMinInitialWeight = 0.01;  // EM cannot increase a weight of 0
constexpr double kMinSigma = 0.05;          // pixels; below, all hits fall into one pixel

struct Cell {
  int z, d;
  double count;
};

/// Cumulative sums of a Gaussian at offsets 0 .. k: of g(k) and of k^2 g(k).
struct GaussSums {
  Eigen::ArrayXd value, square;

  GaussSums(double sigma, int width) : value(width), square(width) {
    double v = 0.0, s = 0.0;
    for (int k = 0; k < width; ++k) {
      const double gauss = std::exp(-0.5 * (k / sigma) * (k / sigma));
      value[k] = v += gauss;
      square[k] = s += static_cast<double>(k) * k * gauss;
    }
  }
  /// Sum over all z of column d.
  double columnSum(int d) const { return value[d] + value[value.size() - 1 - d] - 1.0; }
  double columnVariance(int d) const {
    return (square[d] + square[square.size() - 1 - d]) / columnSum(d);
  }
};

/// Expected hits of one iteration: number per column and sum of squared offsets.
struct Hits {
  Eigen::ArrayXd per_column;
  double squares = 0.0;
};

/// Expectation maximisation of the mixture weights and sigma_hit.
class ExpectationMaximization {
 public:
  ExpectationMaximization(const Eigen::ArrayXXd& counts, const BeamTableParameters& start)
      : width_(start.table_width),
        weights_(start.alpha_hit, start.alpha_short, start.alpha_max, start.alpha_rand),
        sigma_(start.sigma_hit),
        column_counts_(counts.colwise().sum().transpose()) {
    for (int d = 0; d < width_; ++d) {
      for (int z = 0; z < width_; ++z) {
        if (counts(z, d) > 0.0) cells_.push_back({z, d, counts(z, d)});
      }
    }
    weights_ = weights_.max(kMinInitialWeight);
    weights_ /= weights_.sum();
  }

  /// One iteration of expectation and maximisation; returns the largest change.
  double iterate() {
    Hits hits{Eigen::ArrayXd::Zero(width_)};
    const Weights expected = expect(&hits);
    const Weights weights = weightsFrom(expected);
    const double sigma = expected[kHit] > 0.0 ? sigmaFrom(hits) : sigma_;
    const double change =
        std::max((weights - weights_).abs().maxCoeff(), std::abs(std::log(sigma / sigma_)));
    weights_ = weights;
    sigma_ = sigma;
    return change;
  }

  BeamTableParameters table() const {
    BeamTableParameters table;
    table.alpha_hit = weights_[kHit];
    table.alpha_short = weights_[kShort];
    table.alpha_max = weights_[kMax];
    table.alpha_rand = weights_[kRand];
    table.sigma_hit = sigma_;
    table.table_width = width_;
    return table;
  }

 private:
  /// The mixture components of one cell before its column is normalised.
  Weights components(int z, int d, const GaussSums& sums) const {
    const double off = (z - d) / sigma_;
    Weights c;
    c[kHit] = std::exp(-0.5 * off * off) / sums.columnSum(d);
    c[kShort] = z <= d && d > 0 ? 2.0 / d * (1.0 - static_cast<double>(z) / d) : 0.0;
    c[kMax] = z == width_ - 1 ? 1.0 : 0.0;
    c[kRand] = 1.0 / (width_ - 1);
    return c;
  }

  /// Each component's sum over a column.
  Weights masses(int d) const {
    return {1.0, d > 0 ? (d + 1.0) / d : 0.0, 1.0, static_cast<double>(width_) / (width_ - 1)};
  }

  /// The expected number of beams of each component.
  Weights expect(Hits* hits) const {
    const GaussSums sums(sigma_, width_);
    Weights expected = Weights::Zero();
    for (const Cell& cell : cells_) {
      const Weights weighted = weights_ * components(cell.z, cell.d, sums);
      const Weights beams = cell.count / weighted.sum() * weighted;
      expected += beams;
      hits->per_column[cell.d] += beams[kHit];
      hits->squares += beams[kHit] * (cell.z - cell.d) * (cell.z - cell.d);
    }
    return expected;
  }

  /// Columns are normalised after mixing: a column's likelihood is divided by S = sum(weight mass).
  /// With -log S bounded from below by its tangent, weight = beams / sum(count mass / S).
  Weights weightsFrom(const Weights& expected) const {
    Weights normalizers = Weights::Zero();
    for (int d = 0; d < width_; ++d) {
      if (column_counts_[d] == 0.0) continue;
      const Weights mass = masses(d);
      normalizers += column_counts_[d] / (weights_ * mass).sum() * mass;
    }
    Weights weights = (normalizers > 0.0).select(expected / normalizers.max(1e-300), 0.0);
    return weights / weights.sum();
  }

  /// Solves by bisection for the sigma at which the expected squared offset of the truncated
  /// Gaussians equals the observed one: the maximum of the likelihood (exponential family).
  double sigmaFrom(const Hits& hits) const {
    double low = std::log(kMinSigma), high = std::log(10.0 * width_);
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      const GaussSums sums(std::exp(middle), width_);
      double squares = 0.0;
      for (int d = 0; d < width_; ++d) {
        if (hits.per_column[d] > 0.0) squares += hits.per_column[d] * sums.columnVariance(d);
      }
      (squares < hits.squares ? low : high) = middle;
    }
    return std::exp(0.5 * (low + high));
  }

  int width_;
  Weights weights_;
  double sigma_;
  Eigen::ArrayXd column_counts_;
  std::vector<Cell> cells_;
};

}  // namespace

RangeCounts::RangeCounts(const BeamModelParameters& parameters, double resolution)
    : counts_(Eigen::ArrayXXd::Zero(parameters.table.table_width, parameters.table.table_width)),
      pixel_(BeamModel(parameters, resolution).maxRange() / (parameters.table.table_width - 1)) {}

void RangeCounts::add(const Eigen::ArrayXf& measured, const Eigen::ArrayXf& expected) {
  const auto last = static_cast<double>(counts_.rows() - 1);
  const auto pixelOf = [&](float range) {
    const double pixels = static_cast<double>(range) / pixel_;
    return static_cast<Eigen::Index>(std::min(std::max(0.0, pixels), last) + 0.5);
  };
  for (Eigen::Index k = 0; k < measured.size(); ++k) {
    counts_(pixelOf(measured[k]), pixelOf(expected[k])) += 1.0;
  }
}

double meanLogLikelihood(const Eigen::ArrayXXd& counts, const BeamTableParameters& table) {
  // Zeros of the table are clamped; cells without counts contribute nothing.
  const Eigen::ArrayXXd log_table = makeBeamTable(table).max(1e-300).log();
  return (counts * log_table).sum() / counts.sum();
}

BeamModelEstimate estimateBeamModel(const Eigen::ArrayXXd& counts,
                                    const BeamTableParameters& start) {
  validate(start);
  if (counts.rows() != start.table_width || counts.cols() != start.table_width) {
    throw std::invalid_argument(
        "the counts are " + std::to_string(counts.rows()) + " x " + std::to_string(counts.cols()) +
        "; expected table_width = " + std::to_string(start.table_width) + " rows and columns");
  }
  if (!(counts.sum() > 0.0)) throw std::invalid_argument("no beams were counted");
  BeamModelEstimate result;
  result.log_likelihood_before = meanLogLikelihood(counts, start);
  ExpectationMaximization em(counts, start);
  double change = 1.0;
  while (change > kTolerance && result.iterations < kMaxIterations) {
    change = em.iterate();
    ++result.iterations;
  }
  result.table = em.table();
  result.log_likelihood = meanLogLikelihood(counts, result.table);
  return result;
}

}  // namespace racecar_mcl
