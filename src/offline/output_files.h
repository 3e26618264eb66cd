// Atomic output of files.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace racecar_mcl {

/// Writes a file under a temporary name, then renames it. Throws std::runtime_error.
void writeFile(const std::string& path, const std::string& content);

/// A file's name and content.
using NamedContent = std::pair<std::string, std::string>;

/// Writes files into a temporary folder, then moves them into `directory`; replaces files of the
/// same names. Throws std::runtime_error.
void writeFolder(const std::string& directory, const std::vector<NamedContent>& files);

}  // namespace racecar_mcl
