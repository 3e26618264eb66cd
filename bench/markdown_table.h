// A benchmark's results as a table to paste into a report.
#pragma once

#include <string>
#include <vector>

namespace racecar_mcl::bench {

struct Column {
  std::string counter;
  std::string title;
  int decimals;
};

/// The benchmark program: takes Google Benchmark's options, lets `register_all` register, and
/// prints a row per benchmark: its name, split at '/', under `name_titles`, then the counters asked
/// for. Returns the exit code.
int printTable(int argc, char** argv, void (*register_all)(),
               const std::vector<std::string>& name_titles, const std::vector<Column>& columns);

}  // namespace racecar_mcl::bench
