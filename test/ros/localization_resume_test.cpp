// The last pose in a file: saving it, and continuing from it.
#include <std_srvs/Trigger.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/localization_fixture.h"
#include "support/program.h"
#include "support/temporary_directory.h"

namespace racecar_mcl {
namespace {

/// A node that saves its pose, and a second one that starts afterwards.
class LocalizationResumeTest : public LocalizationTest {
 protected:
  LocalizationResumeTest() { parameters_.setParam("last_pose_file", file_); }

  void restartNode() {
    node_.reset();
    listener_.forget();
    startNode();
    ASSERT_TRUE(listener_.waitForLog("map of"));
  }

  void localizeAndEnd() {
    startLocalized();
    expectStillLocalizes();
    ASSERT_TRUE(listener_.waitForDiagnostic("status", "localized"));
    node_.reset();
  }

  std_srvs::TriggerResponse savePose() {
    std_srvs::Trigger trigger;
    EXPECT_TRUE(ros::service::call(namespace_ + "/localization/save_pose", trigger));
    return trigger.response;
  }

  void expectNotSaved(const std::string& words) {
    const std_srvs::TriggerResponse response = savePose();
    EXPECT_FALSE(response.success);
    EXPECT_NE(response.message.find(words), std::string::npos) << response.message;
    EXPECT_TRUE(listener_.waitForLog("pose not saved: "));
  }

  TemporaryDirectory folder_;
  std::string file_ = (folder_.path() / "last_pose.yaml").string();
};

TEST_F(LocalizationResumeTest, ContinuesFromTheLastPoseAndTheMotionSince) {
  localizeAndEnd();
  car_.advance(1.0);  // a metre, while there is no node
  restartNode();
  EXPECT_TRUE(listener_.waitFor([&] { return drive(0.1) > 0; }));
  EXPECT_EQ(listener_.logged("continuing from the last pose in " + file_), 1);
  expectStillLocalizes();
  EXPECT_TRUE(listener_.waitForDiagnostic("status", "localized"));
}

TEST_F(LocalizationResumeTest, ContinuesWithTheSavedCalibration) {
  localizeAndEnd();
  std::string text = readWhole(file_);
  // As after a long run, which determines the scale.
  for (const std::string number : {"distance_scale: 1.1", "scale_distance: 100"}) {
    const std::size_t begin = text.find(number.substr(0, number.find(' ')));
    ASSERT_NE(begin, std::string::npos) << text;
    text.replace(begin, text.find('\n', begin) - begin, number);
  }
  std::ofstream(file_) << text;
  restartNode();
  EXPECT_TRUE(listener_.waitFor([&] {
    const double now = std::strtod(listener_.diagnostic("distance scale").c_str(), nullptr);
    return drive(0.1) > 0 && std::abs(now - 1.1) < 0.02;
  })) << listener_.diagnostic("distance scale");
}

TEST_F(LocalizationResumeTest, ADamagedCalibrationIsNamedAndThePoseIsUsed) {
  localizeAndEnd();
  const std::string text = readWhole(file_);
  std::ofstream(file_) << text.substr(0, text.find("  distance_scale:")) << "  distance_scale: x\n";
  restartNode();
  EXPECT_EQ(listener_.logged("the calibration cannot be read from " + file_), 1);
  EXPECT_TRUE(listener_.waitFor([&] { return drive(0.1) > 0; }));
  EXPECT_EQ(listener_.logged("continuing from the last pose in " + file_), 1);
  expectStillLocalizes();
}

TEST_F(LocalizationResumeTest, AStartPoseHasPriorityUnlessTheNodeIsRespawned) {
  startLocalized();
  expectStillLocalizes();
  ASSERT_TRUE(listener_.waitForDiagnostic("status", "localized"));
  parameters_.setParam("initial_pose", "2 2 0");
  restartNode();  // has run before with the same parameters: a respawn
  EXPECT_EQ(listener_.logged("localizing from"), 0);
  EXPECT_TRUE(listener_.waitFor([&] { return drive(0.1) > 0; }));
  EXPECT_EQ(listener_.logged("continuing from the last pose"), 1);
  expectStillLocalizes();

  node_.reset();
  parameters_.deleteParam("started");  // as a launch does
  listener_.forget();
  startNode();
  EXPECT_TRUE(listener_.waitForLog("localizing from (2.000 m, 2.000 m"));
  EXPECT_EQ(listener_.logged("continuing from the last pose"), 0);
}

TEST_F(LocalizationResumeTest, ADamagedFileOrAnotherMapIsNamedAndTheNodeWaitsForAStart) {
  std::ofstream(file_) << "map: of nowhere\nbase_in_map: [1, 2";
  startNode();
  EXPECT_TRUE(listener_.waitForLog("the last pose cannot be read from " + file_));
  node_.reset();
  std::ofstream(file_) << "map: of nowhere\nbase_in_map: [1, 2, 0]\n";
  startNode();
  publishMap();
  ASSERT_TRUE(listener_.waitForLog("map of"));
  drive(0.2);
  EXPECT_TRUE(listener_.waitForLog("has of nowhere; this one 162 x 122 cells"));
  EXPECT_TRUE(listener_.waitFor(
      [&] { return listener_.diagnostics().message == "waiting for a start pose"; }));
}

TEST_F(LocalizationResumeTest, APoseThatCannotBeSavedIsAWarning) {
  parameters_.setParam("last_pose_file", (folder_.path() / "none/last_pose.yaml").string());
  startLocalized();
  expectStillLocalizes();
  EXPECT_TRUE(listener_.waitFor([&] {
    drive(0.2);
    return listener_.logged("the last pose cannot be written to") > 0;
  }));
  expectStillLocalizes();
}

TEST_F(LocalizationResumeTest, SavePoseWritesTheFileAtOnce) {
  startLocalized();
  expectStillLocalizes();
  ASSERT_TRUE(listener_.waitForDiagnostic("status", "localized"));
  std::filesystem::remove(file_);
  const std_srvs::TriggerResponse response = savePose();
  EXPECT_TRUE(response.success) << response.message;
  EXPECT_NE(response.message.find("saved in " + file_), std::string::npos) << response.message;
  const std::optional<SavedPose> saved = readPoseFile(file_);
  ASSERT_TRUE(saved);
  EXPECT_LT(distance(saved->base_in_map, car_.baseInMap()), 0.1);
}

TEST_F(LocalizationResumeTest, SavePoseStatesWhyItCannot) {
  startNode();
  expectNotSaved("the status is initializing: no scan yet; a pose is saved while");
  node_.reset();
  parameters_.setParam("last_pose_file", (folder_.path() / "none/last_pose.yaml").string());
  startLocalized();
  expectStillLocalizes();
  ASSERT_TRUE(listener_.waitForDiagnostic("status", "localized"));
  expectNotSaved("the last pose cannot be written to");
  node_.reset();
  parameters_.deleteParam("last_pose_file");
  startNode();
  expectNotSaved("last_pose_file is not set");
}

}  // namespace
}  // namespace racecar_mcl
