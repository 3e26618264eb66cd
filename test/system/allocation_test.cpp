// Tracking allocates no memory from the second update on. A program of its own, because it replaces
// malloc, which operator new and Eigen use.
#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <limits>
#include <string>

#include "racecar_mcl/filter/particle_filter.h"
#include "racecar_mcl/localizer/localization_map.h"
#include "support/analytic_room.h"
#include "support/map_user.h"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define RACECAR_MCL_COUNTS_ALLOCATIONS 1
namespace {
// Per thread: oneTBB allocates in its worker threads at any time.
thread_local int allocations = 0;
}  // namespace

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  ++allocations;
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  ++allocations;
  *memory = __libc_memalign(alignment, size);
  return *memory != nullptr ? 0 : ENOMEM;
}
}
#endif

namespace racecar_mcl {
namespace {

constexpr int kUpdates = 30;

/// A stationary car in a room, tracked by a filter.
class AllocationTest : public testing::Test {
 protected:
  void SetUp() override {
#ifndef RACECAR_MCL_COUNTS_ALLOCATIONS
    GTEST_SKIP() << "malloc cannot be replaced in this build";
#endif
    parameters_.resample_threshold = 1.0;
    scan_.bearings = Eigen::ArrayXf::LinSpaced(100, -2.3F, 2.3F);
    scan_.ranges.resize(100);
    scan_.seconds_after_stamp = Eigen::ArrayXf::Zero(100);
    for (int k = 0; k < 100; ++k) {
      scan_.ranges[k] =
          static_cast<float>(room_.range(car_, static_cast<double>(scan_.bearings[k])));
    }
  }

  /// `model`: field, or a range method of the beam model.
  void useModel(const std::string& model) {
    sensor_.sensor_model =
        model == "field" ? SensorModelType::kLikelihoodField : SensorModelType::kBeam;
    if (model != "field") sensor_.caster.range_method = model;
  }

  void expectNoneAfterTheFirst(double start_sigma = 0.05) {
#ifdef RACECAR_MCL_COUNTS_ALLOCATIONS
    MapUser map(makeLocalizationMap(room_.grid(), sensor_), sensor_, parameters_.num_threads);
    ParticleFilter filter(parameters_, {}, 1);
    filter.initialize({car_, Eigen::Matrix3d::Identity() * start_sigma * start_sigma});
    Motion motion;
    motion.seconds = 0.025;
    for (int i = 0; i < kUpdates; ++i) {
      const int before = allocations;
      filter.predict(motion);
      const UpdateResult& result = map.update(&filter, scan_);
      const int made = allocations - before;
      ASSERT_TRUE(result.resampled);
      most_places_ = std::max(most_places_, result.clusters.size());
      if (i == 0) {
        ASSERT_GT(made, 0) << "allocations are not counted";
      } else {
        ASSERT_EQ(made, 0) << "in update " << i;
      }
    }
#else
    static_cast<void>(start_sigma);
#endif
  }

  const Room room_;
  const Pose2 car_{2.0, 1.5, 0.4};
  Scan scan_;
  SensorParameters sensor_;
  ParticleFilterParameters parameters_;
  std::size_t most_places_ = 0;  ///< where particles were at once
};

struct Engine {
  std::string model;
  int threads;
};

class AllocationWith : public AllocationTest, public testing::WithParamInterface<Engine> {};

// With two threads, only the allocations of the calling thread are counted.
TEST_P(AllocationWith, AnUpdateAllocatesNothing) {
  useModel(GetParam().model);
  parameters_.num_threads = GetParam().threads;
  expectNoneAfterTheFirst();
}

INSTANTIATE_TEST_SUITE_P(Models, AllocationWith,
                         testing::Values(Engine{"field", 1}, Engine{"bresenham", 1},
                                         Engine{"distance_transform", 1}, Engine{"simd", 1},
                                         Engine{"lut", 1}, Engine{"field", 2}, Engine{"simd", 2}),
                         [](const auto& tested) {
                           return tested.param.model + "_on_" +
                                  std::to_string(tested.param.threads);
                         });

class AllocationFor : public AllocationTest, public testing::WithParamInterface<EstimateFrom> {};

TEST_P(AllocationFor, AnEstimateAllocatesNothing) {
  parameters_.estimate = GetParam();
  expectNoneAfterTheFirst();
}

// Also during regularization, by default 20 updates.
TEST_P(AllocationFor, ASetInManyPlacesAllocatesNothing) {
  parameters_.estimate = GetParam();
  scan_.ranges.setConstant(std::numeric_limits<float>::infinity());  // no information
  expectNoneAfterTheFirst(5.0);
  EXPECT_GT(most_places_, 1U);
}

INSTANTIATE_TEST_SUITE_P(Kinds, AllocationFor,
                         testing::Values(EstimateFrom::kMean, EstimateFrom::kBest,
                                         EstimateFrom::kCluster));

}  // namespace
}  // namespace racecar_mcl
