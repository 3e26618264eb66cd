// Optional outputs of replay (video, particle sets), and particle_steps.
#include <gtest/gtest.h>

#include <map>
#include <opencv2/videoio.hpp>
#include <sstream>

#include "support/program.h"
#include "support/room_folder.h"

namespace racecar_mcl {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

class ReplayFilm : public RoomFolder {
 protected:
  ReplayFilm() { writeRoomBag(path("a.bag"), {}); }

  ProgramResult replay(Arguments arguments) const {
    arguments.insert(arguments.end(), {"--bag", path("a.bag"), "--map", map_, "--out", path("out"),
                                       "--initial-pose-from-truth"});
    return runProgram(REPLAY_PROGRAM, arguments);
  }
};

TEST_F(ReplayFilm, showsEverySecondOfTheRunAtTheSpeedAskedFor) {
  const ProgramResult result = replay({"--video", path("film.mp4"), "--video-speed", "2"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  cv::VideoCapture film(path("film.mp4"));
  ASSERT_TRUE(film.isOpened());
  // 4 s, from the first estimate on, at double speed and 30 Hz.
  EXPECT_NEAR(film.get(cv::CAP_PROP_FRAME_COUNT), 60, 3);
  cv::Mat first, last, frame;
  ASSERT_TRUE(film.read(first));
  while (film.read(frame)) frame.copyTo(last);
  EXPECT_EQ(first.size(), cv::Size(1280, 720));
  EXPECT_GT(cv::norm(first, last, cv::NORM_L1), 0.0) << "all frames are equal";
  EXPECT_FALSE(fs::exists(path("film.part.mp4")));
}

TEST_F(ReplayFilm, changesNothingOfTheRun) {
  ASSERT_EQ(replay({}).exit_code, 0);
  const std::string plain = readWhole(path("out/trajectory.tum"));
  ASSERT_EQ(replay({"--video", path("film.avi"), "--particles", path("p.csv")}).exit_code, 0);
  EXPECT_EQ(readWhole(path("out/trajectory.tum")), plain);
  EXPECT_TRUE(fs::exists(path("film.avi")));
}

TEST_F(ReplayFilm, saysWhereItCannotBeWrittenAndLeavesNothing) {
  for (const Arguments& wrong :
       {Arguments{"--video", path("nowhere/film.mp4")}, Arguments{"--video", path("film.txt")},
        Arguments{"--video", path("film.mp4"), "--video-speed", "0"},
        Arguments{"--video", path("film.mp4"), "--video-width", "-1"}}) {
    const ProgramResult result = replay(wrong);
    EXPECT_EQ(result.exit_code, 1) << wrong[1];
    EXPECT_NE(result.err.find("replay: error: "), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(path("out"))) << wrong[1];
    EXPECT_FALSE(fs::exists(path("film.part.mp4")));
    EXPECT_FALSE(fs::exists(path("film.part.txt")));
  }
}

/// Rows per value of the first column.
std::map<std::string, int> countFirstColumn(const std::string& csv) {
  std::map<std::string, int> counts;
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) ++counts[line.substr(0, line.find(','))];
  return counts;
}

TEST_F(ReplayFilm, particleTableHoldsASetPerPeriod) {
  ASSERT_EQ(replay({"--particles", path("p.csv"), "--particles-period", "1"}).exit_code, 0);
  const std::string csv = readWhole(path("p.csv"));
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "stamp,x,y,yaw,weight");
  const std::map<std::string, int> counts = countFirstColumn(csv);
  EXPECT_NEAR(static_cast<double>(counts.size()), 5.0, 1.0);
  for (const auto& [stamp, count] : counts) EXPECT_EQ(count, 200) << stamp;
}

TEST_F(ReplayFilm, particleStepsSpreadBySteeringBlindAndGatherByAScan) {
  folder_.write("truth.tum",
                "1500000000 0.8 1.0 0 0 0 0.04998 0.99875\n"
                "1500000001 1.8 1.1 0 0 0 0.09983 0.99500\n");
  folder_.write("steps.yaml", "expert/initial_sigma: 0.1\nnum_particles: 1000\n");
  const ProgramResult result =
      runProgram(PARTICLE_STEPS_PROGRAM,
                 {"--bag", path("a.bag"), "--map", map_, "--truth", path("truth.tum"), "--at",
                  "0.2", "--config", path("steps.yaml"), "--out", path("steps.csv")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  std::map<std::string, std::vector<double>> x;
  std::istringstream lines(readWhole(path("steps.csv")));
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    std::string step, stamp, value;
    std::getline(fields, step, ',');
    std::getline(fields, stamp, ',');
    std::getline(fields, value, ',');
    x[step].push_back(std::stod(value));
  }
  const auto sigma = [&](const std::string& step) {
    const Eigen::Map<const Eigen::ArrayXd> values(x[step].data(),
                                                  static_cast<Eigen::Index>(x[step].size()));
    return std::sqrt((values - values.mean()).square().mean());
  };
  ASSERT_EQ(x.size(), 4u);
  EXPECT_NEAR(sigma("start"), 0.1, 0.01);
  EXPECT_LT(sigma("first_scan"), sigma("start"));
  EXPECT_GT(sigma("moved"), sigma("first_scan"));
  EXPECT_LT(sigma("resampled"), sigma("moved"));
}

}  // namespace
}  // namespace racecar_mcl
