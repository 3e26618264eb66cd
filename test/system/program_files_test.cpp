// What programs do to the files of their user: inputs, outputs, full disks and interruptions.
#include <gtest/gtest.h>
#include <rosbag/view.h>

#include <cstring>
#include <set>

#include "offline/draft.h"
#include "support/process.h"
#include "support/program.h"
#include "support/room_folder.h"

namespace racecar_mcl {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

class ProgramFiles : public RoomFolder {
 protected:
  ProgramFiles() { writeRoomBag(path("a.bag"), {}); }

  Arguments replayOf(Arguments more) const {
    more.insert(more.begin(), {"--bag", path("a.bag"), "--map", map_, "--initial-pose-from-truth"});
    return more;
  }

  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
      names.insert(entry.path().filename().string());
    }
    return names;
  }

  /// Of a child process: creates and removes drafts until a signal ends it.
  [[noreturn]] void writeDraftsForASecond() const {
    signal(SIGINT, SIG_DFL);  // ignored by children of a script's background jobs
    alarm(1);
    try {
      for (;;) Draft draft(path("film.mp4"));
    } catch (...) {
      _exit(1);
    }
  }

  /// Runs a program that cannot write more than this to a file, as on a full disk.
  static ProgramResult runWithLimit(int kilobytes, const std::string& program,
                                    const Arguments& arguments) {
    std::string script = "trap \"\" XFSZ; ulimit -f " + std::to_string(kilobytes) + "; exec";
    for (const std::string& word : arguments) script += " \"" + word + "\"";
    script.insert(script.find("exec") + 4, " \"" + program + "\"");
    return runProgram("/bin/bash", {"-c", script});
  }

  static void expectError(const ProgramResult& result, const Arguments& words) {
    EXPECT_EQ(result.exit_code, 1) << result.err;
    EXPECT_NE(result.err.find(": error: "), std::string::npos) << result.err;
    for (const std::string& word : words) {
      EXPECT_NE(result.err.find(word), std::string::npos) << word << " in: " << result.err;
    }
  }
};

TEST_F(ProgramFiles, ReplayDoesNotReplaceItsInputs) {
  const std::string truth = folder_.write("run/trajectory.tum", "1500000000 0.8 1 0 0 0 0.05 1\n");
  fs::create_hard_link(path("a.bag"), path("linked.bag"));
  fs::create_symlink(map_, path("linked.yaml"));
  const std::string bag = readWhole(path("a.bag"));
  const std::set<std::string> before = files();
  const std::string out = path("out");
  for (const Arguments& wrong : {Arguments{"--out", out, "--particles", path("a.bag")},
                                 Arguments{"--out", out, "--particles", path("x/../a.bag")},
                                 Arguments{"--out", out, "--particles", path("linked.bag")},
                                 Arguments{"--out", out, "--particles", path("linked.yaml")},
                                 Arguments{"--out", out, "--particles", path("room.pgm")},
                                 Arguments{"--out", out, "--video", path("a.bag")},
                                 Arguments{"--out", path("run"), "--truth", truth}}) {
    expectError(runProgram(REPLAY_PROGRAM, replayOf(wrong)), {"would replace the input"});
    EXPECT_EQ(readWhole(path("a.bag")), bag);
    EXPECT_EQ(files(), before);
  }
  expectError(runProgram(REPLAY_PROGRAM, replayOf({"--out", out, "--particles", path("p.csv"),
                                                   "--video", path("p.csv")})),
              {"two outputs are the same file"});
}

TEST_F(ProgramFiles, SimulateBagDoesNotReplaceItsInputs) {
  for (const std::string& input : {map_, path("room.pgm")}) {
    const std::string before = readWhole(input);
    expectError(runProgram(SIMULATE_BAG_PROGRAM, {"--map", map_, "--out", input}),
                {"would replace the input"});
    expectError(
        runProgram(SIMULATE_BAG_PROGRAM, {"--map", map_, "--out", path("b.bag"), "--truth", input}),
        {"would replace the input"});
    EXPECT_EQ(readWhole(input), before);
  }
}

TEST_F(ProgramFiles, AFullDiskEndsSimulateBagWithAnError) {
  const std::set<std::string> before = files();
  for (const int kilobytes : {1, 64, 900}) {
    const ProgramResult result =
        runWithLimit(kilobytes, SIMULATE_BAG_PROGRAM,
                     {"--map", map_, "--start", "2 2 0", "--duration", "20", "--out", path("b.bag"),
                      "--truth", path("b.tum")});
    expectError(result, {"b.bag", "is the disk full?"});
    EXPECT_EQ(files(), before) << kilobytes;
  }
}

TEST_F(ProgramFiles, AFullDiskLeavesNothingOfAReplay) {
  const std::set<std::string> before = files();
  for (const Arguments& output : {Arguments{"--particles", path("p.csv")}, Arguments{}}) {
    Arguments all = replayOf({"--out", path("out")});
    all.insert(all.end(), output.begin(), output.end());
    expectError(runWithLimit(4, REPLAY_PROGRAM, all), {"cannot be written"});
    EXPECT_EQ(files(), before);
  }
}

TEST_F(ProgramFiles, AFullStandardOutputIsAnError) {
  const std::string command = std::string("\"") + REPLAY_PROGRAM + "\" --bag \"" + path("a.bag") +
                              "\" --map \"" + map_ + "\" --out \"" + path("out") +
                              "\" --initial-pose-from-truth > /dev/full";
  expectError(runProgram("/bin/sh", {"-c", command}), {"standard output"});
}

TEST_F(ProgramFiles, FilesOfTheUserWithSimilarNamesStay) {
  const Arguments names{"film.part.mp4", "p.csv.part", "out.part"};
  for (const std::string& name : names) folder_.write(name, "mine");
  ASSERT_EQ(runProgram(REPLAY_PROGRAM, replayOf({"--out", path("out"), "--video", path("film.mp4"),
                                                 "--particles", path("p.csv")}))
                .exit_code,
            0);
  for (const std::string& name : names) EXPECT_EQ(readWhole(path(name)), "mine") << name;
  EXPECT_EQ(fs::status(path("p.csv")).permissions(), fs::status(path("a.bag")).permissions());
}

TEST_F(ProgramFiles, AnInterruptedReplayLeavesNothing) {
  RoomDrive drive;
  drive.seconds = 40.0;
  writeRoomBag(path("a.bag"), drive);
  const std::set<std::string> before = files();
  Arguments command = replayOf({"--out", path("out"), "--video", path("film.mp4")});
  command.insert(command.begin(), REPLAY_PROGRAM);
  Process process(command);
  for (int i = 0; i < 2000 && files() == before; ++i) usleep(5000);
  EXPECT_NE(files(), before) << "the draft of the video";
  EXPECT_EQ(process.interrupt(), -1) << "ended by the signal";
  EXPECT_EQ(files(), before);
}

TEST_F(ProgramFiles, ASignalAtAnyMomentLeavesNoDraft) {
  const std::set<std::string> before = files();
  for (int run = 0; run < 300; ++run) {
    const pid_t writer = fork();
    ASSERT_GE(writer, 0);
    if (writer == 0) writeDraftsForASecond();
    for (int i = 0; i < 2000 && files() == before; ++i) usleep(1);
    usleep(run);
    kill(writer, SIGINT);
    int status = 0;
    waitpid(writer, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT) << run;
    ASSERT_EQ(files(), before) << run;
  }
}

TEST_F(ProgramFiles, ADamagedArrayLengthIsFoundByFileTopicAndNumber) {
  std::string bag = readWhole(path("a.bag"));
  // The number of ranges precedes the ranges: 231 floats, twice per file only in scans.
  const char length[] = {'\xe7', 0, 0, 0};
  std::size_t at = bag.find(std::string(length, 4));
  for (int scan = 1; scan < 3; ++scan) at = bag.find(std::string(length, 4), at + 4);
  ASSERT_NE(at, std::string::npos);
  const std::uint32_t absurd = 0xffffffffU;
  std::memcpy(&bag[at], &absurd, 4);
  const std::string damaged = folder_.write("damaged.bag", bag);
  expectError(runProgram(REPLAY_PROGRAM, {"--bag", damaged, "--map", map_, "--out", path("out"),
                                          "--initial-pose", "0.8 1 0.1"}),
              {damaged, "message 3 of /scan is damaged", "an array has 4294967295 elements"});
}

}  // namespace
}  // namespace racecar_mcl
