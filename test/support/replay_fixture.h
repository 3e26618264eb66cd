// Runs of the program `replay` over the room's bag.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/program.h"
#include "support/room_folder.h"

namespace racecar_mcl {

using Arguments = std::vector<std::string>;

class Replay : public RoomFolder {
 protected:
  std::string record(const std::string& name, const RoomDrive& drive = {}) const {
    writeRoomBag(path(name), drive);
    return path(name);
  }

  ProgramResult replay(Arguments arguments, const std::string& out = "out") const {
    arguments.insert(arguments.end(), {"--map", map_, "--out", path(out)});
    return runProgram(REPLAY_PROGRAM, arguments);
  }

  /// The summary of a replay that is expected to succeed.
  nlohmann::json summaryOf(const Arguments& arguments, const std::string& out = "out") const {
    const ProgramResult result = replay(arguments, out);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "") << "no progress bar without a terminal";
    return nlohmann::json::parse(readWhole(path(out + "/summary.json")));
  }

  /// Expects a one-line error message that contains all `words`, and no output folder.
  void expectError(const ProgramResult& result, const Arguments& words) const {
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(result.err.find("replay: error: "), 0u) << result.err;
    EXPECT_EQ(result.err.find('\n'), result.err.size() - 1) << result.err;
    for (const std::string& word : words) {
      EXPECT_NE(result.err.find(word), std::string::npos) << word << " in: " << result.err;
    }
    for (const std::filesystem::directory_entry& entry :
         std::filesystem::directory_iterator(folder_.path())) {
      EXPECT_NE(entry.path().filename().string().substr(0, 3), "out") << entry.path();
    }
  }
};

}  // namespace racecar_mcl
