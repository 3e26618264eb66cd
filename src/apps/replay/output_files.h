// Files that are never half there.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace racecar_mcl {

/// Writes a file under another name first. Throws std::runtime_error.
void writeFile(const std::string& path, const std::string& content);

/// A file's name and content.
using NamedContent = std::pair<std::string, std::string>;

/// Writes files into a folder beside `directory` first, then moves them in; files of the same names
/// are replaced. Throws std::runtime_error.
void writeFolder(const std::string& directory, const std::vector<NamedContent>& files);

}  // namespace racecar_mcl
