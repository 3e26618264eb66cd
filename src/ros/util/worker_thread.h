// A thread that runs posted tasks in order.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

namespace racecar_mcl {

/// Exceptions of a task are passed to `on_error` as text, on the thread; the next task runs as
/// usual. The destructor waits for the running task and drops queued ones.
class WorkerThread {
 public:
  /// `on_error` must not throw.
  explicit WorkerThread(std::function<void(const std::string& what)> on_error)
      : on_error_(std::move(on_error)), thread_([this] { run(); }) {}
  ~WorkerThread() { stop(); }
  WorkerThread(const WorkerThread&) = delete;
  WorkerThread& operator=(const WorkerThread&) = delete;

  void post(std::function<void()> task) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      tasks_.push_back(std::move(task));
    }
    wake_.notify_one();
  }

  /// Ends the thread; tasks that have not started are never run.
  void stop() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      stopping_ = true;
    }
    wake_.notify_one();
    if (thread_.joinable()) thread_.join();
  }

 private:
  void run() {
    std::unique_lock<std::mutex> lock(mutex_);
    while (true) {
      wake_.wait(lock, [this] { return stopping_ || !tasks_.empty(); });
      if (stopping_) return;
      const std::function<void()> task = std::move(tasks_.front());
      tasks_.pop_front();
      lock.unlock();
      attempt(task);
      lock.lock();
    }
  }

  void attempt(const std::function<void()>& task) {
    try {
      task();
    } catch (const std::exception& error) {
      on_error_(error.what());
    } catch (...) {
      on_error_("unknown exception");
    }
  }

  std::function<void(const std::string& what)> on_error_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> tasks_;
  bool stopping_ = false;
  std::thread thread_;
};

/// Runs `task` on a thread and waits for its end; its exception is rethrown here.
template <typename Task>
void runOn(WorkerThread* thread, Task task) {
  const auto packaged = std::make_shared<std::packaged_task<void()>>(std::move(task));
  thread->post([packaged] { (*packaged)(); });
  packaged->get_future().get();
}

}  // namespace racecar_mcl
