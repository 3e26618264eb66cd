// A file or folder under a temporary name until it is complete.
#pragma once

#include <string>

namespace racecar_mcl {

/// A new empty file or folder next to `path`, with a unique name and the extension of `path`. The
/// destructor removes it unless it was committed, and so do SIGINT, SIGTERM and SIGHUP if they end
/// the process.
class Draft {
 public:
  enum class Kind { kFile, kFolder };

  /// Throws std::runtime_error if it cannot be created.
  explicit Draft(const std::string& path, Kind kind = Kind::kFile);
  ~Draft();
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  /// The temporary name.
  const std::string& path() const { return draft_; }

  /// Renames the file to the path it is for, or to `path`. Throws std::runtime_error.
  void commit() { commit(path_); }
  void commit(const std::string& path);

 private:
  std::string path_;
  std::string draft_;
};

}  // namespace racecar_mcl
