#include "offline/output_files.h"

#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>

#include "offline/draft.h"

namespace racecar_mcl {
namespace {

namespace fs = std::filesystem;

void writeTo(const Draft& draft, const std::string& path, const std::string& content) {
  std::ofstream file(draft.path(), std::ios::binary);
  file << content;
  file.close();
  if (!file) throw std::runtime_error(path + ": cannot be written; is the disk full?");
}

}  // namespace

void writeFile(const std::string& path, const std::string& content) {
  Draft draft(path);
  writeTo(draft, path, content);
  draft.commit();
}

void writeFolder(const std::string& directory, const std::vector<NamedContent>& files) {
  // Without a trailing slash, so that the draft is a sibling.
  fs::path target = fs::absolute(directory).lexically_normal();
  if (!target.has_filename()) target = target.parent_path();
  fs::create_directories(target.parent_path());
  const Draft folder(target.string(), Draft::Kind::kFolder);
  std::vector<std::unique_ptr<Draft>> drafts;
  for (const auto& [name, content] : files) {
    drafts.push_back(std::make_unique<Draft>((fs::path(folder.path()) / name).string()));
    writeTo(*drafts.back(), (target / name).string(), content);
  }
  fs::create_directory(target);
  for (std::size_t i = 0; i < files.size(); ++i) {
    drafts[i]->commit((target / files[i].first).string());
  }
}

}  // namespace racecar_mcl
