#include "markdown_reporter.h"

#include <iomanip>
#include <ostream>
#include <sstream>

namespace racecar_mcl::bench {

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

}  // namespace racecar_mcl::bench
