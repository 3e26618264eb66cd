#include "racecar_mcl/scan_weigher.h"

#include <algorithm>
#include <opencv2/core/utility.hpp>

#include "racecar_mcl/map_model.h"
#include "vector_math.h"

namespace racecar_mcl {
namespace {

// Particles cast and weighed together: their ranges stay in the first-level cache.
constexpr Eigen::Index kChunk = 64;

/// Calls `body(job, first, count)` for as many runs of whole chunks as there are jobs.
template <typename Body>
void forEachJob(Eigen::Index size, int jobs, const Body& body) {
  const Eigen::Index chunks = (size + kChunk - 1) / kChunk;
  const auto run = [&](int job) {
    const Eigen::Index first = chunks * job / jobs * kChunk;
    const Eigen::Index end = std::min(size, chunks * (job + 1) / jobs * kChunk);
    if (first < end) body(job, first, end - first);
  };
  if (jobs == 1) return run(0);
  cv::parallel_for_(
      cv::Range(0, jobs),
      [&](const cv::Range& range) {
        for (int job = range.start; job < range.end; ++job) run(job);
      },
      jobs);
}

int jobsFor(int threads, Eigen::Index size) {
  const int wanted = threads == 0 ? std::max(1, cv::getNumberOfCPUs()) : threads;
  return static_cast<int>(std::clamp<Eigen::Index>(size / kChunk, 1, wanted));
}

}  // namespace

void ScanWeigher::place(const ParticleSet& particles, const Pose2& laser_in_base) {
  const int size = static_cast<int>(particles.size());
  lidar_x_.resize(size);
  lidar_y_.resize(size);
  lidar_yaw_.resize(size);
  log_likelihoods_.resize(size);
  const double* const x = particles.x.data();
  const double* const y = particles.y.data();
  const double* const yaw = particles.yaw.data();
  double* __restrict const lidar_x = lidar_x_.data();
  double* __restrict const lidar_y = lidar_y_.data();
  double* __restrict const lidar_yaw = lidar_yaw_.data();
  runWith(fastestInstructionSet(), [&]() RACECAR_MCL_INLINE_LAMBDA {
    const Pose2 laser = laser_in_base;
    for (int i = 0; i < size; ++i) {
      double sine, cosine;
      sinCos(yaw[i], &sine, &cosine);
      lidar_x[i] = x[i] + cosine * laser.x - sine * laser.y;
      lidar_y[i] = y[i] + sine * laser.x + cosine * laser.y;
      lidar_yaw[i] = yaw[i] + laser.yaw;
    }
  });
}

Eigen::ArrayXd& ScanWeigher::weigh(const LikelihoodField& field, const ParticleSet& particles,
                                   const Scan& beams) {
  place(particles, beams.laser_in_base);
  const int jobs = jobsFor(threads_, particles.size());
  forEachJob(particles.size(), jobs, [&](int /*job*/, Eigen::Index first, Eigen::Index count) {
    field.logLikelihood(lidars().segment(first, count), beams,
                        log_likelihoods_.segment(first, count));
  });
  return log_likelihoods_;
}

Eigen::ArrayXd& ScanWeigher::weigh(MapModel* map, const ParticleSet& particles, const Scan& beams) {
  if (map->likelihood_field) return weigh(*map->likelihood_field, particles, beams);
  place(particles, beams.laser_in_base);
  map->caster->prepare(lidars(), beams.bearings);
  const int jobs = jobsFor(threads_, particles.size());
  ranges_.resize(beams.size(), kChunk * jobs);
  forEachJob(particles.size(), jobs, [&](int job, Eigen::Index first, Eigen::Index count) {
    for (const Eigen::Index end = first + count; first < end; first += kChunk) {
      const Eigen::Index some = std::min(kChunk, end - first);
      auto ranges = ranges_.middleCols(kChunk * job, some);
      map->caster->cast(lidars().segment(first, some), beams.bearings, ranges);
      map->beam_model.logLikelihood(beams.ranges, ranges, log_likelihoods_.segment(first, some));
    }
  });
  return log_likelihoods_;
}

}  // namespace racecar_mcl
