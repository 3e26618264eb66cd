#include "ros/util/worker_thread.h"

#include <gtest/gtest.h>

#include <future>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace racecar_mcl {
namespace {

TEST(WorkerThread, RunsTasksInTheirOrder) {
  std::vector<int> ran;
  std::promise<void> done;
  WorkerThread thread([](const std::string& what) { ADD_FAILURE() << what; });
  for (int i = 0; i < 3; ++i) thread.post([&ran, i] { ran.push_back(i); });
  thread.post([&done] { done.set_value(); });
  done.get_future().wait();
  EXPECT_EQ(ran, (std::vector<int>{0, 1, 2}));
}

TEST(WorkerThread, SurvivesATaskThatThrows) {
  std::vector<std::string> errors;
  std::promise<void> done;
  WorkerThread thread([&errors](const std::string& what) { errors.push_back(what); });
  thread.post([] { throw std::runtime_error("no root of this matrix"); });
  thread.post([] { throw 1; });
  thread.post([&done] { done.set_value(); });
  done.get_future().wait();
  EXPECT_EQ(errors, (std::vector<std::string>{"no root of this matrix", "unknown exception"}));
}

TEST(WorkerThread, RunOnWaitsAndPassesTheExceptionToItsCaller) {
  WorkerThread thread([](const std::string& what) { ADD_FAILURE() << what; });
  std::thread::id id;
  runOn(&thread, [&id] { id = std::this_thread::get_id(); });
  EXPECT_NE(id, std::thread::id());
  EXPECT_NE(id, std::this_thread::get_id());
  EXPECT_THROW(runOn(&thread, [] { throw std::runtime_error("no root"); }), std::runtime_error);
}

}  // namespace
}  // namespace racecar_mcl
