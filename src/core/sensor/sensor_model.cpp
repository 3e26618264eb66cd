#include "racecar_mcl/sensor/sensor_model.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "common/parallel.h"

namespace racecar_mcl {
namespace {

// Poses that are cast and evaluated together: their ranges stay in the first-level cache.
constexpr Eigen::Index kChunk = 64;

/// Divides the poses into one interval of whole chunks per job and calls `body(job, first, count)`
/// for each, in parallel.
template <typename Body>
void forEachJob(Eigen::Index size, int jobs, const Body& body) {
  const Eigen::Index chunks = (size + kChunk - 1) / kChunk;
  const auto run = [&](int job) {
    const Eigen::Index first = chunks * job / jobs * kChunk;
    const Eigen::Index end = std::min(size, chunks * (job + 1) / jobs * kChunk);
    if (first < end) body(job, first, end - first);
  };
  if (jobs == 1) return run(0);
  parallelFor(jobs, std::ref(run));  // a function of a reference allocates nothing
}

int jobsFor(int threads, Eigen::Index size) {
  const int max_jobs = threads == 0 ? maxThreads() : threads;
  return static_cast<int>(std::clamp<Eigen::Index>(size / kChunk, 1, max_jobs));
}

}  // namespace

void LikelihoodFieldModel::logLikelihoods(const PoseBatch& lidar_in_map, const Scan& scan,
                                          Eigen::Ref<Eigen::ArrayXd> log_likelihoods) {
  const int jobs = jobsFor(threads_, lidar_in_map.size);
  forEachJob(lidar_in_map.size, jobs, [&](int /*job*/, Eigen::Index first, Eigen::Index count) {
    field_->logLikelihood(lidar_in_map.segment(first, count), scan,
                          log_likelihoods.segment(first, count));
  });
}

RayCastingModel::RayCastingModel(BeamModel beam_model, std::unique_ptr<RangeCaster> caster,
                                 int threads)
    : beam_model_(std::move(beam_model)), caster_(std::move(caster)), threads_(threads) {}

void RayCastingModel::logLikelihoods(const PoseBatch& lidar_in_map, const Scan& scan,
                                     Eigen::Ref<Eigen::ArrayXd> log_likelihoods) {
  caster_->prepare(lidar_in_map, scan.bearings);
  const int jobs = jobsFor(threads_, lidar_in_map.size);
  ranges_.resize(scan.size(), kChunk * jobs);
  forEachJob(lidar_in_map.size, jobs, [&](int job, Eigen::Index first, Eigen::Index count) {
    for (const Eigen::Index end = first + count; first < end; first += kChunk) {
      const Eigen::Index poses = std::min(kChunk, end - first);
      auto ranges = ranges_.middleCols(kChunk * job, poses);
      caster_->cast(lidar_in_map.segment(first, poses), scan.bearings, ranges);
      beam_model_.logLikelihood(scan.ranges, ranges, log_likelihoods.segment(first, poses));
    }
  });
}

}  // namespace racecar_mcl
