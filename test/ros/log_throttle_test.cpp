#include "ros/util/log_throttle.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>

namespace racecar_mcl {
namespace {

TEST(LogThrottle, ATextIsDueOnce) {
  LogThrottle throttle;
  EXPECT_TRUE(throttle.isDue("scan", "empty"));
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(throttle.isDue("scan", "empty"));
  EXPECT_TRUE(throttle.isDue("odometry", "empty"));
}

TEST(LogThrottle, AnotherTextOfTheSameSubjectIsDueAfterASecond) {
  LogThrottle throttle;
  EXPECT_TRUE(throttle.isDue("scan", "empty"));
  EXPECT_FALSE(throttle.isDue("scan", "late"));
  std::this_thread::sleep_for(std::chrono::milliseconds(1050));
  EXPECT_TRUE(throttle.isDue("scan", "late"));
  EXPECT_FALSE(throttle.isDue("scan", "empty"));
}

TEST(LogThrottle, AllTogetherAreLimited) {
  LogThrottle throttle;
  std::size_t lines = 0;
  for (int i = 0; i < 100; ++i) {
    lines += throttle.isDue("subject " + std::to_string(i), "text") ? 1 : 0;
    lines += throttle.isFirst("first " + std::to_string(i)) ? 1 : 0;
    lines += throttle.isDue() ? 1 : 0;
  }
  EXPECT_EQ(lines, LogThrottle::kMaxLines);
  std::this_thread::sleep_for(std::chrono::milliseconds(1050));
  EXPECT_TRUE(throttle.isFirst("first 99")) << "not lost";
  EXPECT_FALSE(throttle.isFirst("first 99"));
  EXPECT_TRUE(throttle.isDue("subject 99", "text")) << "not lost";
}

}  // namespace
}  // namespace racecar_mcl
