#include "evaluation/sensor_fit.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace racecar_mcl {
namespace {

enum Component { kHit, kShort, kMax, kRand, kComponents };
using Shares = Eigen::Array<double, kComponents, 1>;

constexpr int kMostIterations = 2000;
constexpr double kSettled = 1e-7;     // largest change of a share, and of log sigma_hit
constexpr double kLeastStart = 0.01;  // a share of zero would stay there
constexpr double kLeastSigma = 0.05;  // pixels; below, all hits share one pixel

struct Cell {
  int z, d;
  double count;
};

/// Sums of a Gaussian about 0 over the offsets 0 .. k: of the values, and of offset^2 times them.
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
  /// Over all z of column d.
  double columnSum(int d) const { return value[d] + value[value.size() - 1 - d] - 1.0; }
  double columnVariance(int d) const {
    return (square[d] + square[square.size() - 1 - d]) / columnSum(d);
  }
};

/// What the hits of one pass look like: how many in each column, and their squared offsets.
struct Hits {
  Eigen::ArrayXd per_column;
  double squares = 0.0;
};

class Fit {
 public:
  Fit(const Eigen::ArrayXXd& counts, const SensorTableParameters& start)
      : width_(start.table_width),
        shares_(start.alpha_hit, start.alpha_short, start.alpha_max, start.alpha_rand),
        sigma_(start.sigma_hit),
        column_counts_(counts.colwise().sum().transpose()) {
    for (int d = 0; d < width_; ++d) {
      for (int z = 0; z < width_; ++z) {
        if (counts(z, d) > 0.0) cells_.push_back({z, d, counts(z, d)});
      }
    }
    shares_ = shares_.max(kLeastStart);
    shares_ /= shares_.sum();
  }

  /// One pass of expectation and maximisation; returns the largest change.
  double improve() {
    Hits hits{Eigen::ArrayXd::Zero(width_)};
    const Shares expected = expect(&hits);
    const Shares shares = sharesFrom(expected);
    const double sigma = expected[kHit] > 0.0 ? sigmaFrom(hits) : sigma_;
    const double change =
        std::max((shares - shares_).abs().maxCoeff(), std::abs(std::log(sigma / sigma_)));
    shares_ = shares;
    sigma_ = sigma;
    return change;
  }

  SensorTableParameters table() const {
    SensorTableParameters table;
    table.alpha_hit = shares_[kHit];
    table.alpha_short = shares_[kShort];
    table.alpha_max = shares_[kMax];
    table.alpha_rand = shares_[kRand];
    table.sigma_hit = sigma_;
    table.table_width = width_;
    return table;
  }

 private:
  /// The components of one cell before its column is normalised.
  Shares components(int z, int d, const GaussSums& sums) const {
    const double off = (z - d) / sigma_;
    Shares c;
    c[kHit] = std::exp(-0.5 * off * off) / sums.columnSum(d);
    c[kShort] = z <= d && d > 0 ? 2.0 / d * (1.0 - static_cast<double>(z) / d) : 0.0;
    c[kMax] = z == width_ - 1 ? 1.0 : 0.0;
    c[kRand] = 1.0 / (width_ - 1);
    return c;
  }

  /// What each component sums to over a column.
  Shares masses(int d) const {
    return {1.0, d > 0 ? (d + 1.0) / d : 0.0, 1.0, static_cast<double>(width_) / (width_ - 1)};
  }

  /// How many beams each component accounts for.
  Shares expect(Hits* hits) const {
    const GaussSums sums(sigma_, width_);
    Shares expected = Shares::Zero();
    for (const Cell& cell : cells_) {
      const Shares weighted = shares_ * components(cell.z, cell.d, sums);
      const Shares beams = cell.count / weighted.sum() * weighted;
      expected += beams;
      hits->per_column[cell.d] += beams[kHit];
      hits->squares += beams[kHit] * (cell.z - cell.d) * (cell.z - cell.d);
    }
    return expected;
  }

  /// Columns are normalised after mixing: a column's likelihood is divided by S = sum(share mass).
  /// With -log S bounded from below by its tangent, share = beams / sum(count mass / S).
  Shares sharesFrom(const Shares& expected) const {
    Shares opportunities = Shares::Zero();
    for (int d = 0; d < width_; ++d) {
      if (column_counts_[d] == 0.0) continue;
      const Shares mass = masses(d);
      opportunities += column_counts_[d] / (shares_ * mass).sum() * mass;
    }
    Shares shares = (opportunities > 0.0).select(expected / opportunities.max(1e-300), 0.0);
    return shares / shares.sum();
  }

  /// Where the squared offsets of the hits are what the Gaussians, cut off at the table's ends,
  /// lead to expect: the likelihood's maximum, for they are an exponential family.
  double sigmaFrom(const Hits& hits) const {
    double low = std::log(kLeastSigma), high = std::log(10.0 * width_);
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
  Shares shares_;
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

double meanLogLikelihood(const Eigen::ArrayXXd& counts, const SensorTableParameters& table) {
  // Where nothing was counted, a zero of the table does not count either.
  const Eigen::ArrayXXd log_table = makeSensorTable(table).max(1e-300).log();
  return (counts * log_table).sum() / counts.sum();
}

SensorFit fitSensorTable(const Eigen::ArrayXXd& counts, const SensorTableParameters& start) {
  validate(start);
  if (counts.rows() != start.table_width || counts.cols() != start.table_width) {
    throw std::invalid_argument(
        "the counts are " + std::to_string(counts.rows()) + " x " + std::to_string(counts.cols()) +
        "; expected table_width = " + std::to_string(start.table_width) + " of each");
  }
  if (!(counts.sum() > 0.0)) throw std::invalid_argument("no beam to learn from was counted");
  SensorFit result;
  result.log_likelihood_before = meanLogLikelihood(counts, start);
  Fit fit(counts, start);
  double change = 1.0;
  while (change > kSettled && result.iterations < kMostIterations) {
    change = fit.improve();
    ++result.iterations;
  }
  result.table = fit.table();
  result.log_likelihood = meanLogLikelihood(counts, result.table);
  return result;
}

}  // namespace racecar_mcl
