// Tracking allocates nothing from the second update on. A program of its own, for it takes the
// place of malloc, which everything else goes through: operator new and Eigen's arrays.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "racecar_mcl/particle_filter.h"
#include "support/room.h"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define RACECAR_MCL_COUNTS_ALLOCATIONS 1
namespace {
thread_local int allocations = 0;
}  // namespace

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
}
#endif

namespace racecar_mcl {
namespace {

class AllocationWith : public testing::TestWithParam<std::string> {};

TEST_P(AllocationWith, AnUpdateAllocatesOnlyItsResult) {
#ifndef RACECAR_MCL_COUNTS_ALLOCATIONS
  GTEST_SKIP() << "malloc cannot be counted here";
#else
  const Room room;
  SensorParameters sensor;
  sensor.sensor_model = GetParam() == "field" ? SensorModel::kLikelihoodField : SensorModel::kBeam;
  if (GetParam() != "field") sensor.caster.range_method = GetParam();
  const auto map = makeMapModel(room.grid(), sensor);
  ParticleFilterParameters parameters;
  parameters.settling_updates = 0;
  parameters.resample_threshold = 1.0;
  ParticleFilter filter(parameters, {}, 1);
  const Pose2 car{2.0, 1.5, 0.4};
  filter.initialize({car, Eigen::Matrix3d::Identity() * 0.0025});
  Scan scan;
  scan.bearings = Eigen::ArrayXf::LinSpaced(100, -2.3F, 2.3F);
  scan.ranges.resize(100);
  scan.seconds_after_stamp = Eigen::ArrayXf::Zero(100);
  for (int k = 0; k < 100; ++k) {
    scan.ranges[k] = static_cast<float>(room.range(car, static_cast<double>(scan.bearings[k])));
  }
  Motion motion;
  motion.seconds = 0.025;
  for (int i = 0; i < 20; ++i) {
    const int before = allocations;
    filter.predict(motion);
    const UpdateResult result = filter.update(map.get(), scan);
    const int made = allocations - before;
    ASSERT_TRUE(result.resampled);
    // The first makes the filter's arrays; each returns its list of places.
    if (i == 0) {
      ASSERT_GT(made, 1) << "nothing is counted";
    } else {
      ASSERT_EQ(made, 1) << "in update " << i;
    }
  }
#endif
}

INSTANTIATE_TEST_SUITE_P(Models, AllocationWith,
                         testing::Values("field", "bresenham", "distance_transform", "simd",
                                         "panorama"),
                         [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace racecar_mcl
