// A program that runs beside the test and ends with it.
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
  /// The program, looked up in PATH where it is no path, and its arguments.
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
    if (pid_ > 0 && interrupt() == kStubborn) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  static constexpr int kStubborn = -2;

  /// Asks it to end as Ctrl-C does; as `wait`.
  int interrupt(double seconds = 20.0) {
    kill(pid_, SIGINT);
    return wait(seconds);
  }

  /// Its exit code once it has ended, -1 where a signal ended it, kStubborn where it still runs.
  int wait(double seconds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    int status = 0;
    while (waitpid(pid_, &status, WNOHANG) == 0) {
      if (std::chrono::steady_clock::now() > end) return kStubborn;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t pid_ = -1;
};

}  // namespace racecar_mcl
