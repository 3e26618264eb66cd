#include "markdown_table.h"

#include <benchmark/benchmark.h>

#include <iomanip>
#include <ostream>
#include <sstream>
#include <utility>

namespace racecar_mcl::bench {
namespace {

class MarkdownReporter : public benchmark::BenchmarkReporter {
 public:
  MarkdownReporter(std::vector<std::string> name_titles, std::vector<Column> columns)
      : name_titles_(std::move(name_titles)), columns_(std::move(columns)) {}

  bool ReportContext(const Context& context) override;
  void ReportRuns(const std::vector<Run>& runs) override;

 private:
  std::vector<std::string> name_titles_;
  std::vector<Column> columns_;
};

bool MarkdownReporter::ReportContext(const Context& /*context*/) {
  std::ostream& out = GetOutputStream();
  std::string rule = "|";
  out << "|";
  for (const std::string& title : name_titles_) {
    out << " " << title << " |";
    rule += "---|";
  }
  for (const Column& column : columns_) {
    out << " " << column.title << " |";
    rule += "---:|";
  }
  out << "\n" << rule << std::endl;
  return true;
}

void MarkdownReporter::ReportRuns(const std::vector<Run>& runs) {
  std::ostream& out = GetOutputStream();
  for (const Run& run : runs) {
    out << "|";
    std::istringstream parts(run.run_name.function_name);
    std::string part;
    for (std::size_t i = 0; i < name_titles_.size() && std::getline(parts, part, '/'); ++i) {
      out << " " << part << " |";
    }
    for (const Column& column : columns_) {
      const auto counter = run.counters.find(column.counter);
      out << " ";
      if (counter != run.counters.end()) {
        out << std::fixed << std::setprecision(column.decimals) << counter->second.value;
      }
      out << " |";
    }
    out << std::endl;
  }
}

}  // namespace

int printTable(int argc, char** argv, void (*register_all)(),
               const std::vector<std::string>& name_titles, const std::vector<Column>& columns) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  register_all();
  MarkdownReporter reporter(name_titles, columns);
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}

}  // namespace racecar_mcl::bench
