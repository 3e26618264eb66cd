// Prints benchmark results as a Markdown table.
#pragma once

#include <string>
#include <vector>

namespace racecar_mcl::bench {

struct Column {
  std::string counter;
  std::string title;
  int decimals;
};

/// main() of a benchmark: parses Google Benchmark options, calls `register_all` and prints one row
/// per benchmark: its name, split at '/', under `name_titles`, then `columns`. Returns the exit
/// code.
int printTable(int argc, char** argv, void (*register_all)(),
               const std::vector<std::string>& name_titles, const std::vector<Column>& columns);

}  // namespace racecar_mcl::bench
