#include "racecar_mcl/relocalization/global_scan_matcher.h"

#include <algorithm>
#include <cmath>

#include "racecar_mcl/filter/resampling.h"
#include "racecar_mcl/filter/tempering.h"
#include "racecar_mcl/scan/beam_selection.h"
#include "racecar_mcl/sensor/scan_likelihood.h"

namespace racecar_mcl {
namespace {

// Number of independent beams that a scan counts as in the coarse scores.
constexpr double kEffectiveBeams = 20.0;
// Lattice poses used after the coarse evaluation, and effective sample size after tempering.
constexpr std::size_t kMaxLatticePoses = 100000;
constexpr double kEffectiveLatticePoses = 3000.0;
// Poses drawn from the lattice per candidate, and effective fraction of them after tempering.
constexpr int kDrawsPerCandidate = 4;
constexpr double kEffectiveDrawRatio = 0.1;

/// Tempers the weights to an effective sample size and normalises them.
void temper(double effective, Eigen::ArrayXd* log_weights) {
  *log_weights *=
      temperingExponent(Eigen::ArrayXd::Zero(log_weights->size()), *log_weights, effective);
  normalizeLogWeights(log_weights);
}

/// The minimum of the `count` best scores, rounded down to a bin of their histogram.
float minScoreOfBest(const Eigen::ArrayXf& scores, std::size_t count) {
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

std::vector<std::ptrdiff_t> GlobalScanMatcher::endPointOffsets(const Scan& beams,
                                                               double yaw_in_grid) const {
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

Eigen::ArrayXf GlobalScanMatcher::coarseScores(const Scan& beams) const {
  const Scan selected = selectBeams(beams, parameters_.search_beams, 2.0 * kPi);
  Eigen::ArrayXf scores = Eigen::ArrayXf::Zero(static_cast<Eigen::Index>(poses()));
  float* score = scores.data();
  std::size_t compared = 0;
  for (long direction = 0; direction < directions_; ++direction) {
    const std::vector<std::ptrdiff_t> offsets = endPointOffsets(selected, yawOf(direction));
    compared = offsets.size();
    for (const CellRuns::Run& run : positions_.runs()) {
      const float* first = &coarse_field_[coarseIndex(run.first)];
      for (const std::ptrdiff_t offset : offsets) {
        const float* values = first + offset;
        for (int i = 0; i < run.count; ++i) score[i] += values[i];
      }
      score += run.count;
    }
  }
  const double beams_counted = std::max(kEffectiveBeams, static_cast<double>(compared));
  return scores * static_cast<float>(kEffectiveBeams / beams_counted);
}

ParticleSet GlobalScanMatcher::bestPoses(const Eigen::ArrayXf& scores) const {
  const float lowest = minScoreOfBest(scores, kMaxLatticePoses);
  const auto good = static_cast<std::size_t>((scores >= lowest).count());
  // If many poses have the same score, every n-th of them is used.
  const std::size_t every = (good + 2 * kMaxLatticePoses - 1) / (2 * kMaxLatticePoses);

  ParticleSet best;
  best.resize(static_cast<Eigen::Index>((good + every - 1) / every));
  std::size_t seen = 0;
  Eigen::Index taken = 0;
  const float* score = scores.data();
  for (long direction = 0; direction < directions_; ++direction) {
    const double yaw = wrapAngle(yawOf(direction) + map_.origin.yaw);
    for (std::size_t i = 0; i < positions_.size(); ++i, ++score) {
      if (!(*score >= lowest) || seen++ % every != 0) continue;
      const Cell cell = positions_[i];
      const Eigen::Vector2d point =
          gridToWorld(map_, {(cell.column + 0.5) * stride_, (cell.row + 0.5) * stride_});
      best.setPose(taken, {point.x(), point.y(), yaw});
      best.log_weight[taken++] = static_cast<double>(*score);
    }
  }
  return best;
}

ParticleSet GlobalScanMatcher::candidates(const Scan& beams, Eigen::Index count,
                                          Random& random) const {
  ParticleSet lattice = bestPoses(coarseScores(beams));
  temper(kEffectiveLatticePoses, &lattice.log_weight);

  ParticleSet drawn =
      resample(lattice, kDrawsPerCandidate * count, ResamplingMethod::kSystematic, random);
  for (Eigen::Index i = 0; i < drawn.size(); ++i) {
    drawn.x[i] += spacing() * (random.uniform() - 0.5);
    drawn.y[i] += spacing() * (random.uniform() - 0.5);
    drawn.yaw[i] = wrapAngle(drawn.yaw[i] + yawOf(1) * (random.uniform() - 0.5));
  }
  LikelihoodFieldModel field_model(field_);
  ScanLikelihood().evaluate(drawn, beams, &field_model, &drawn.log_weight);
  temper(kEffectiveDrawRatio * static_cast<double>(drawn.size()), &drawn.log_weight);
  return resample(drawn, count, ResamplingMethod::kSystematic, random);
}

}  // namespace racecar_mcl
