#include "offline/draft.h"

#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <system_error>

namespace racecar_mcl {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxDrafts = 16;
constexpr std::size_t kMaxPath = 4096;  // bytes, PATH_MAX of Linux

/// The drafts that a signal removes. Fixed arrays: a signal handler must not allocate or lock.
class DraftList {
 public:
  /// Creates a draft by `create`, which fills in `path` and returns whether it succeeded. A signal
  /// meanwhile ends the process when the draft is in the list, not before.
  bool add(std::string& path, const std::function<bool(std::string& path)>& create) {
    const std::lock_guard<std::mutex> lock(mutex_);
    handleSignals();
    state_ = kCreating;
    const bool created = create(path);
    const int error = errno;
    if (created) insert(path);
    const int signal_number = state_.exchange(kIdle);
    if (signal_number > 0) raise(signal_number);
    errno = error;
    return created;
  }

  void remove(const std::string& path) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (auto& entry : paths_) {
      if (path == entry.data()) entry[0] = '\0';
    }
  }

  void handle(int signal_number) {
    int state = kCreating;
    if (state_.compare_exchange_strong(state, signal_number) || state > 0) return;
    unlinkAll();
    signal(signal_number, SIG_DFL);
    raise(signal_number);
  }

 private:
  static constexpr int kIdle = 0;
  static constexpr int kCreating = -1;

  /// Signals that are ignored or handled already are left alone.
  void handleSignals();

  void insert(const std::string& path) {
    for (auto& entry : paths_) {
      if (entry[0] != '\0' || path.size() >= kMaxPath) continue;
      // The first byte last: until then the entry is free.
      std::copy(path.begin() + 1, path.end(), entry.begin() + 1);
      entry[path.size()] = '\0';
      entry[0] = path[0];
      return;
    }
  }

  /// Files first, then the folders that contained them.
  void unlinkAll() {
    for (const auto& entry : paths_) {
      if (entry[0] != '\0') unlink(entry.data());
    }
    for (const auto& entry : paths_) {
      if (entry[0] != '\0') rmdir(entry.data());
    }
  }

  std::mutex mutex_;
  bool handles_signals_ = false;
  /// kIdle, kCreating, or the number of a signal that came while a draft was created.
  std::atomic<int> state_{kIdle};
  std::array<std::array<char, kMaxPath>, kMaxDrafts> paths_ = {};
};

DraftList& drafts() {
  static auto* const list = new DraftList;  // never destroyed: a signal may come at the exit
  return *list;
}

void removeDrafts(int signal_number) { drafts().handle(signal_number); }

void DraftList::handleSignals() {
  if (handles_signals_) return;
  handles_signals_ = true;
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction now = {};
    if (sigaction(number, nullptr, &now) != 0 || now.sa_handler != SIG_DFL) continue;
    struct sigaction ours = {};
    ours.sa_handler = removeDrafts;
    sigaction(number, &ours, nullptr);
  }
}

/// The permissions of a file that is created by open().
mode_t defaultFileMode() {
  const mode_t mask = umask(0);
  umask(mask);
  return 0666 & ~mask;
}

bool createFolder(std::string& path) { return mkdtemp(path.data()) != nullptr; }

bool createFile(std::string& path, const std::string& extension) {
  const int file = mkstemps(path.data(), static_cast<int>(extension.size()));
  if (file < 0) return false;
  fchmod(file, defaultFileMode());
  close(file);
  return true;
}

}  // namespace

Draft::Draft(const std::string& path, Kind kind) : path_(path) {
  const fs::path target(path);
  const std::string extension = kind == Kind::kFile ? target.extension().string() : "";
  draft_ = (target.parent_path() / (target.stem().string() + ".XXXXXX" + extension)).string();
  const bool created = drafts().add(draft_, [&](std::string& name) {
    return kind == Kind::kFolder ? createFolder(name) : createFile(name, extension);
  });
  if (!created) {
    throw std::runtime_error(path +
                             ": cannot be written: " + std::generic_category().message(errno) +
                             "; expected a path in a folder that exists and can be written");
  }
}

Draft::~Draft() {
  std::error_code ignored;
  if (!draft_.empty()) fs::remove_all(draft_, ignored);
  drafts().remove(draft_);
}

void Draft::commit(const std::string& path) {
  std::error_code error;
  fs::rename(draft_, path, error);
  if (error) throw std::runtime_error(path + ": cannot be written: " + error.message());
  drafts().remove(draft_);
  draft_.clear();
}

}  // namespace racecar_mcl
