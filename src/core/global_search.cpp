#include "racecar_mcl/global_search.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "racecar_mcl/distance_field.h"
#include "racecar_mcl/require.h"
#include "racecar_mcl/resampling.h"
#include "racecar_mcl/scan_weigher.h"
#include "racecar_mcl/tempering.h"

namespace racecar_mcl {
namespace {

// The coarse field: a beam counts half at one lattice spacing from an obstacle, which forgives what
// the lattice misses; this share of beams ends anywhere, and all together count as this many.
constexpr double kCoarseRand = 0.1;
constexpr double kIndependentBeams = 20.0;
// Lattice poses kept after the coarse comparison, and how many of them must matter.
constexpr std::size_t kKept = 100000;
constexpr double kKeptSurvivors = 3000.0;
// Poses drawn for each candidate wanted, and the share of them that must matter.
constexpr int kDrawsPerCandidate = 4;
constexpr double kDrawnSurvivors = 0.1;

/// Takes the log weights to the power that leaves an effective sample size, and normalises them.
void temper(double survivors, Eigen::ArrayXd* log_weights) {
  *log_weights *=
      temperingExponent(Eigen::ArrayXd::Zero(log_weights->size()), *log_weights, survivors);
  normalizeLogWeights(log_weights);
}

/// The lowest score of the best `count`, to a bin of their histogram.
float scoreOfBest(const Eigen::ArrayXf& scores, std::size_t count) {
  constexpr std::size_t kBins = 4096;
  const float lowest = scores.minCoeff();
  const float bin_width = (scores.maxCoeff() - lowest) / kBins;
  if (!(bin_width > 0.0f)) return lowest;
  std::vector<std::size_t> histogram(kBins + 1, 0);
  for (Eigen::Index i = 0; i < scores.size(); ++i) {
    ++histogram[static_cast<std::size_t>((scores[i] - lowest) / bin_width)];
  }
  std::size_t bin = kBins;
  for (std::size_t above = histogram[bin]; bin > 0 && above < count; above += histogram[bin]) --bin;
  return lowest + bin_width * static_cast<float>(bin);
}

}  // namespace

void validate(const GlobalSearchParameters& p) {
  requireWithin("search_spacing", p.search_spacing, 0.01, 10.0, "m");
  requireWithin("search_yaw_spacing", p.search_yaw_spacing, 0.001, 1.0, "rad");
  requireWithin("search_beams", p.search_beams, 1, 10000);
  requirePositiveUpTo("search_max_range", p.search_max_range, 1000.0, "m");
  requireWithin("search_poses", p.search_poses, 100000, 1000000000);
}

LikelihoodFieldParameters fieldOfPlaces(const GlobalSearchParameters& parameters) {
  LikelihoodFieldParameters field;
  field.field_sigma = 0.12;
  field.field_rand = 0.05;
  field.field_max_range = parameters.search_max_range;
  field.field_squash = 6.4;  // for the 240 beams of the default
  field.field_inside = 0.0;
  return field;
}

GlobalSearch::GlobalSearch(const OccupancyGrid& grid, const GlobalSearchParameters& parameters)
    : GlobalSearch(grid.geometry(), freeCells(grid), findSurfaces(grid), parameters) {}

GlobalSearch::GlobalSearch(const GridGeometry& geometry, const std::vector<Cell>& free_cells,
                           const Surfaces& surfaces, const GlobalSearchParameters& parameters)
    : parameters_((validate(parameters), parameters)),
      field_(geometry, surfaces, fieldOfPlaces(parameters)),
      map_(geometry),
      directions_(std::max(1L, std::lround(2.0 * kPi / parameters.search_yaw_spacing))) {
  layLattice(free_cells);
  std::vector<std::uint8_t> ends(surfaces.visible.size());
  std::transform(surfaces.visible.begin(), surfaces.visible.end(), surfaces.blurred.begin(),
                 ends.begin(), std::bit_or<std::uint8_t>());
  buildCoarseField(obstacleDistances(ends, map_.width, map_.height));
}

void GlobalSearch::layLattice(const std::vector<Cell>& free_cells) {
  std::vector<char> free;
  stride_ =
      std::max(1, static_cast<int>(std::lround(parameters_.search_spacing / map_.resolution)));
  for (;; stride_ *= 2) {
    width_ = (map_.width + stride_ - 1) / stride_;
    height_ = (map_.height + stride_ - 1) / stride_;
    free.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0);
    for (const Cell& cell : free_cells) {
      free[static_cast<std::size_t>(cell.row / stride_) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(cell.column / stride_)] = 1;
    }
    const auto positions = std::count(free.begin(), free.end(), 1);
    if (positions * directions_ <= parameters_.search_poses || positions <= 1) break;
  }
  for (int row = 0; row < height_; ++row) {
    for (int column = 0; column < width_; ++column) {
      if (free[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(column)] == 0) {
        continue;
      }
      const bool continues = !positions_.empty() && positions_.back() == Cell{column - 1, row};
      if (!continues) runs_.push_back({{column, row}, 0});
      ++runs_.back().count;
      positions_.push_back({column, row});
    }
  }
}

void GlobalSearch::buildCoarseField(const std::vector<float>& surface_distances) {
  // No end of a beam needs to be farther away than beyond the map from everywhere on it.
  margin_ = static_cast<int>(std::min(std::ceil(parameters_.search_max_range / spacing()) + 1.0,
                                      static_cast<double>(std::max(width_, height_))));
  padded_width_ = width_ + 2 * margin_;
  const auto size =
      static_cast<std::size_t>(padded_width_) * static_cast<std::size_t>(height_ + 2 * margin_);
  coarse_field_.assign(size, static_cast<float>(std::log(kCoarseRand)));
  for (int row = 0; row < height_; ++row) {
    for (int column = 0; column < width_; ++column) {
      const int map_column = std::min(column * stride_ + stride_ / 2, map_.width - 1);
      const int map_row = std::min(row * stride_ + stride_ / 2, map_.height - 1);
      const float cells = surface_distances[static_cast<std::size_t>(map_row) *
                                                static_cast<std::size_t>(map_.width) +
                                            static_cast<std::size_t>(map_column)];
      const double spacings = static_cast<double>(cells) / stride_;
      coarse_field_[coarseIndex({column, row})] = static_cast<float>(
          std::log((1.0 - kCoarseRand) / (1.0 + spacings * spacings) + kCoarseRand));
    }
  }
}

std::size_t GlobalSearch::memoryBytes() const {
  return field_.memoryBytes() + coarse_field_.size() * sizeof(float) + runs_.size() * sizeof(Run) +
         positions_.size() * sizeof(Cell);
}

std::vector<std::ptrdiff_t> GlobalSearch::endOffsets(const Scan& beams, double yaw_in_grid) const {
  const Pose2 lidar = compose({0.0, 0.0, yaw_in_grid}, beams.laser_in_base);
  const auto cellsOf = [&](double metres) {
    const double cells = std::round(metres / spacing());
    return static_cast<std::ptrdiff_t>(
        std::min(std::max(cells, -static_cast<double>(margin_)), static_cast<double>(margin_)));
  };
  std::vector<std::ptrdiff_t> offsets;
  for (Eigen::Index k = 0; k < beams.size(); ++k) {
    const double range = static_cast<double>(beams.ranges[k]);
    if (!(range < parameters_.search_max_range)) continue;
    const double bearing = lidar.yaw + static_cast<double>(beams.bearings[k]);
    offsets.push_back(cellsOf(lidar.y + range * std::sin(bearing)) * padded_width_ +
                      cellsOf(lidar.x + range * std::cos(bearing)));
  }
  return offsets;
}

Eigen::ArrayXf GlobalSearch::coarseScores(const Scan& beams) const {
  const Scan few = selectBeams(beams, parameters_.search_beams, 2.0 * kPi);
  Eigen::ArrayXf scores = Eigen::ArrayXf::Zero(static_cast<Eigen::Index>(poses()));
  float* score = scores.data();
  std::size_t compared = 0;
  for (long direction = 0; direction < directions_; ++direction) {
    const std::vector<std::ptrdiff_t> offsets = endOffsets(few, yawOf(direction));
    compared = offsets.size();
    for (const Run& run : runs_) {
      const float* first = &coarse_field_[coarseIndex(run.first)];
      for (const std::ptrdiff_t offset : offsets) {
        const float* ends = first + offset;
        for (int i = 0; i < run.count; ++i) score[i] += ends[i];
      }
      score += run.count;
    }
  }
  const double beams_counted = std::max(kIndependentBeams, static_cast<double>(compared));
  return scores * static_cast<float>(kIndependentBeams / beams_counted);
}

ParticleSet GlobalSearch::bestOfLattice(const Eigen::ArrayXf& scores) const {
  const float lowest = scoreOfBest(scores, kKept);
  const auto good = static_cast<std::size_t>((scores >= lowest).count());
  // Where many score the same, one in so many stands for them.
  const std::size_t one_in = (good + 2 * kKept - 1) / (2 * kKept);

  ParticleSet best;
  best.resize(static_cast<Eigen::Index>((good + one_in - 1) / one_in));
  std::size_t seen = 0;
  Eigen::Index kept = 0;
  for (std::size_t i = 0; i < poses(); ++i) {
    const float score = scores[static_cast<Eigen::Index>(i)];
    if (!(score >= lowest) || seen++ % one_in != 0) continue;
    const Cell& cell = positions_[i % positions_.size()];
    const Eigen::Vector2d point =
        gridToWorld(map_, {(cell.column + 0.5) * stride_, (cell.row + 0.5) * stride_});
    const double yaw = yawOf(static_cast<long>(i / positions_.size())) + map_.origin.yaw;
    best.setPose(kept, {point.x(), point.y(), wrapAngle(yaw)});
    best.log_weight[kept++] = static_cast<double>(score);
  }
  return best;
}

ParticleSet GlobalSearch::candidates(const Scan& beams, Eigen::Index count, Random& random) const {
  ParticleSet lattice = bestOfLattice(coarseScores(beams));
  temper(kKeptSurvivors, &lattice.log_weight);

  ParticleSet drawn =
      resample(lattice, kDrawsPerCandidate * count, ResamplingMethod::kSystematic, random);
  for (Eigen::Index i = 0; i < drawn.size(); ++i) {
    drawn.x[i] += spacing() * (random.uniform() - 0.5);
    drawn.y[i] += spacing() * (random.uniform() - 0.5);
    drawn.yaw[i] = wrapAngle(drawn.yaw[i] + yawOf(1) * (random.uniform() - 0.5));
  }
  drawn.log_weight = ScanWeigher(1).weigh(field_, drawn, beams);
  temper(kDrawnSurvivors * static_cast<double>(drawn.size()), &drawn.log_weight);
  return resample(drawn, count, ResamplingMethod::kSystematic, random);
}

}  // namespace racecar_mcl
