// A benchmark's results as a table to paste into a report.
#pragma once

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

namespace racecar_mcl::bench {

/// Prints a row per benchmark: its name, split at '/', then the counters asked for.
class MarkdownReporter : public benchmark::BenchmarkReporter {
 public:
  struct Column {
    std::string counter;
    std::string title;
    int decimals;
  };

  MarkdownReporter(std::vector<std::string> name_titles, std::vector<Column> columns)
      : name_titles_(std::move(name_titles)), columns_(std::move(columns)) {}

  bool ReportContext(const Context& context) override;
  void ReportRuns(const std::vector<Run>& runs) override;

 private:
  std::vector<std::string> name_titles_;
  std::vector<Column> columns_;
};

}  // namespace racecar_mcl::bench
