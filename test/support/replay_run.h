// Runs `replay` and reads its output.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "evaluation/trajectory_error.h"
#include "support/program.h"

namespace racecar_mcl {

struct ReplayedRun {
  nlohmann::json summary;
  Trajectory estimate;
  /// updates.csv by column.
  std::map<std::string, std::vector<std::string>> updates;
};

inline std::map<std::string, std::vector<std::string>> readCsv(const std::string& path) {
  const auto cellsOf = [](const std::string& line) {
    std::istringstream stream(line);
    std::vector<std::string> cells;
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    return cells;
  };
  std::istringstream lines(readWhole(path));
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> names = cellsOf(line);
  std::map<std::string, std::vector<std::string>> columns;
  while (std::getline(lines, line)) {
    const std::vector<std::string> cells = cellsOf(line);
    for (std::size_t i = 0; i < names.size(); ++i) columns[names[i]].push_back(cells.at(i));
  }
  return columns;
}

/// Fails the test if the program fails.
inline ReplayedRun runReplay(std::vector<std::string> arguments) {
  const TemporaryDirectory folder;
  const std::string out = (folder.path() / "out").string();
  arguments.insert(arguments.end(), {"--out", out});
  const ProgramResult result = runProgram(REPLAY_PROGRAM, arguments);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  if (result.exit_code != 0) return {};
  return {nlohmann::json::parse(readWhole(out + "/summary.json")), readTum(out + "/trajectory.tum"),
          readCsv(out + "/updates.csv")};
}

}  // namespace racecar_mcl
