// A child process that ends with the test.
#pragma once

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

namespace racecar_mcl {

class Process {
 public:
  /// The program (a path, or looked up in PATH) and its arguments.
  explicit Process(const std::vector<std::string>& command) {
    std::vector<char*> words;
    for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    pid_ = fork();
    if (pid_ == 0) {
      execvp(words[0], words.data());
      _exit(127);
    }
  }
  ~Process() {
    if (pid_ > 0 && interrupt() == kStillRunning) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  static constexpr int kStillRunning = -2;

  /// Sends SIGINT; returns as `wait`.
  int interrupt(double seconds = 20.0) {
    kill(pid_, SIGINT);
    return wait(seconds);
  }

  /// The exit code, -1 if a signal ended the process, kStillRunning after `seconds`.
  int wait(double seconds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    int status = 0;
    while (waitpid(pid_, &status, WNOHANG) == 0) {
      if (std::chrono::steady_clock::now() > end) return kStillRunning;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t pid_ = -1;
};

}  // namespace racecar_mcl
