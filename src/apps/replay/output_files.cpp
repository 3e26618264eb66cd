#include "output_files.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>

namespace racecar_mcl {
namespace {

namespace fs = std::filesystem;

/// A new empty folder beside a path, gone with its content when this goes.
class SiblingFolder {
 public:
  explicit SiblingFolder(const fs::path& path) {
    std::string name = path.string() + ".XXXXXX";
    if (mkdtemp(name.data()) == nullptr) {
      throw std::runtime_error(path.string() + ": no folder can be made beside it");
    }
    path_ = name;
  }
  ~SiblingFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  SiblingFolder(const SiblingFolder&) = delete;
  SiblingFolder& operator=(const SiblingFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

void writeFile(const std::string& path, const std::string& content) {
  const std::string draft = path + ".part";
  std::ofstream file(draft, std::ios::binary);
  file << content;
  file.close();
  std::error_code error;
  if (file) fs::rename(draft, path, error);
  if (!file || error) throw std::runtime_error(path + ": cannot be written");
}

void writeFolder(const std::string& directory, const std::vector<NamedContent>& files) {
  // Without a trailing slash, so that a sibling is one.
  fs::path target = fs::absolute(directory).lexically_normal();
  if (!target.has_filename()) target = target.parent_path();
  fs::create_directories(target.parent_path());
  const SiblingFolder draft(target);
  for (const auto& [name, content] : files) writeFile((draft.path() / name).string(), content);
  fs::create_directory(target);
  for (const auto& [name, content] : files) fs::rename(draft.path() / name, target / name);
}

}  // namespace racecar_mcl
