#include "racecar_mcl/localizer/scan_queue.h"

#include <gtest/gtest.h>

namespace racecar_mcl {
namespace {

/// Odometry up to a stamp.
auto upTo(double newest) {
  return [newest](double stamp) { return newest >= stamp; };
}

TEST(ScanQueue, ReleasesAScanThatOdometryCovers) {
  ScanQueue<int> queue(10, 0.1);
  queue.add(10.0, 20.0, 1);
  EXPECT_FALSE(queue.takeReady(20.0, upTo(9.98)));
  EXPECT_EQ(queue.takeReady(20.02, upTo(10.0)), 1);
  EXPECT_TRUE(queue.empty());
}

TEST(ScanQueue, WaitsNoLongerThanMaxWait) {
  ScanQueue<int> queue(10, 0.1);
  queue.add(10.0, 20.0, 1);
  EXPECT_FALSE(queue.takeReady(20.09, upTo(9.0)));
  EXPECT_EQ(queue.takeReady(20.11, upTo(9.0)), 1);
}

TEST(ScanQueue, KeepsTheOrderOfArrival) {
  ScanQueue<int> queue(10, 0.1);
  queue.add(10.0, 20.0, 1);
  queue.add(10.05, 20.05, 2);
  EXPECT_EQ(queue.takeReady(20.12, upTo(10.0)), 1);
  EXPECT_FALSE(queue.takeReady(20.12, upTo(10.0)));
  EXPECT_EQ(queue.take(), 2);
  EXPECT_FALSE(queue.take());
}

TEST(ScanQueue, ReleasesWhenTheClockIsSetBack) {
  ScanQueue<int> queue(10, 0.1);
  queue.add(10.0, 20.0, 1);
  EXPECT_EQ(queue.takeReady(3.0, upTo(2.0)), 1);
}

TEST(ScanQueue, DropsTheOldestAboveItsCapacity) {
  ScanQueue<int> queue(1, 0.1);
  EXPECT_TRUE(queue.add(10.0, 20.0, 1));
  EXPECT_FALSE(queue.add(10.05, 20.05, 2));
  EXPECT_EQ(queue.takeReady(20.05, upTo(10.1)), 2);
  EXPECT_TRUE(queue.empty());
}

TEST(ScanQueue, SortsTheScansOfLidarsByStamp) {
  ScanQueue<int> queue;
  queue.add(10.05, 20.0, 1, 0);
  queue.add(10.02, 20.0, 2, 1);
  queue.add(10.04, 20.0, 3, 1);
  queue.add(10.03, 20.0, 4, 2);
  for (const int item : {2, 4, 3, 1}) EXPECT_EQ(queue.take(), item);
  queue.add(10.05, 20.0, 1, 0);
  queue.add(10.02, 20.0, 2, 0);
  EXPECT_EQ(queue.take(), 1) << "those of one lidar keep the order of arrival";
}

TEST(ScanQueue, TheNewestScanOfEachLidarWaits) {
  ScanQueue<int> queue(1, 0.1);
  EXPECT_TRUE(queue.add(10.00, 20.0, 1, 0));
  EXPECT_TRUE(queue.add(10.01, 20.0, 2, 1));
  EXPECT_FALSE(queue.add(10.02, 20.0, 3, 0));
  for (const int item : {2, 3}) EXPECT_EQ(queue.take(), item);
  EXPECT_TRUE(queue.empty());
}

}  // namespace
}  // namespace racecar_mcl
