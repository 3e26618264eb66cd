// The localizer as a nodelet in a manager, and as a program.
#include <nodelet/NodeletLoad.h>
#include <nodelet/NodeletUnload.h>

#include <atomic>
#include <thread>
#include <vector>

#include "support/localization_fixture.h"
#include "support/process.h"
#include "support/program.h"

namespace racecar_mcl {
namespace {

const char* const kProgram = RACECAR_MCL_PROGRAM_DIR "/localization_node";

/// Only the car is in this process.
class LocalizationProcessTest : public LocalizationTest {
 protected:
  void publishMount() { static_transforms_.sendTransform(car_.laserInBase()); }

  void startHere() {
    ASSERT_TRUE(listener_.waitFor([&] {
      return odometry_.getNumSubscribers() > 0 && scans_.getNumSubscribers() > 0 &&
             initial_pose_.getNumSubscribers() > 0;
    }));
    publishMap();
    ASSERT_TRUE(listener_.waitForLog("map of"));
    initial_pose_.publish(startMessage(car_.baseInMap()));
    ASSERT_TRUE(listener_.waitForLog("localizing from"));
  }
};

class LocalizationNodeletTest : public LocalizationProcessTest {
 protected:
  void SetUp() override {
    ASSERT_TRUE(listener_.waitForLogOf(2)) << "logs of the manager and of this process";
  }

  std::string nodelet() const { return namespace_ + "/localization"; }

  bool load() {
    publishMount();
    nodelet::NodeletLoad request;
    request.request.name = nodelet();
    request.request.type = "racecar_mcl/LocalizationNodelet";
    return ros::service::waitForService("/manager/load_nodelet", 10000) &&
           ros::service::call("/manager/load_nodelet", request) && request.response.success;
  }
  bool unload() {
    nodelet::NodeletUnload request;
    request.request.name = nodelet();
    return ros::service::call("/manager/unload_nodelet", request) && request.response.success;
  }
};

TEST_F(LocalizationNodeletTest, LocalizesInAManager) {
  ASSERT_TRUE(load());
  startHere();
  drive(0.5);
  expectStillLocalizes();
  EXPECT_TRUE(unload());
  EXPECT_TRUE(listener_.waitFor([&] { return scans_.getNumSubscribers() == 0; }));
}

TEST_F(LocalizationNodeletTest, NamesAnotherLocalizer) {
  ASSERT_TRUE(load());
  startHere();
  geometry_msgs::TransformStamped rival = car_.baseInOdom();
  rival.header.frame_id = "map";
  EXPECT_TRUE(listener_.waitFor([&] {
    transforms_.sendTransform(rival);
    drive(0.04);
    return listener_.logged("also publishes map -> base_link") > 0;
  }));
  EXPECT_TRUE(unload());
}

TEST_F(LocalizationNodeletTest, ComesAndGoesAmidMessages) {
  std::atomic<bool> driving{true};
  std::thread driver([&] {
    while (driving) {
      car_.advance(0.005);
      odometry_.publish(car_.odometry());
      scans_.publish(car_.scan());
      initial_pose_.publish(startMessage(car_.baseInMap()));
      ros::WallDuration(0.005).sleep();
    }
  });
  publishMap();
  for (int round = 0; round < 8; ++round) {
    EXPECT_TRUE(load());
    const std::size_t before = listener_.scanPoseCount();
    EXPECT_TRUE(listener_.waitFor([&] { return listener_.scanPoseCount() > before; }));
    EXPECT_TRUE(unload()) << "the manager is running";
  }
  driving = false;
  driver.join();
}

TEST_F(LocalizationNodeletTest, StaysUnconfiguredWithWrongParametersAndSaysSo) {
  parameters_.setParam("num_particles", -5);
  load();
  EXPECT_TRUE(listener_.waitForLog("not localizing: num_particles is -5"));
  EXPECT_EQ(scans_.getNumSubscribers(), 0U);
  unload();
  parameters_.deleteParam("num_particles");
  EXPECT_TRUE(load()) << "the manager is running";
  startHere();
  expectStillLocalizes();
  EXPECT_TRUE(unload());
}

class LocalizationProgramTest : public LocalizationProcessTest {};

TEST_F(LocalizationProgramTest, LocalizesAndEndsWhenAskedTo) {
  publishMount();
  Process program({kProgram, "__name:=localization", "__ns:=" + namespace_});
  ASSERT_TRUE(listener_.waitForLogOf(3)) << "logs of the program, the manager and this process";
  startHere();
  drive(0.5);
  expectStillLocalizes();
  EXPECT_EQ(program.interrupt(), 0);
}

struct WrongParameter {
  std::string name;
  std::vector<std::string> arguments;
  std::string words;
};
std::ostream& operator<<(std::ostream& stream, const WrongParameter& wrong) {
  return stream << wrong.name;
}
class LocalizationProgramRefusesTest : public ::testing::TestWithParam<WrongParameter> {};

TEST_P(LocalizationProgramRefusesTest, AndExitsWithTheReason) {
  std::vector<std::string> arguments = GetParam().arguments;
  arguments.push_back("__name:=refusing_" + GetParam().name);
  const ProgramResult result = runProgram(kProgram, arguments);
  EXPECT_EQ(result.exit_code, 1);
  const std::string said = result.out + result.err;
  EXPECT_NE(said.find("not localizing: "), std::string::npos) << said;
  EXPECT_NE(said.find(GetParam().words), std::string::npos) << said;
}

INSTANTIATE_TEST_SUITE_P(
    , LocalizationProgramRefusesTest,
    ::testing::Values(
        WrongParameter{"OutOfRange", {"_num_particles:=0"}, "num_particles is 0"},
        WrongParameter{"UnknownName", {"_num_partikles:=200"}, "num_particles"},
        WrongParameter{"WrongType", {"_num_particles:=many"}, "num_particles"},
        WrongParameter{"SharesThatDoNotSumToOne", {"_alpha_hit:=0.9"}, "it must be 1"},
        WrongParameter{"UnknownCaster", {"_range_method:=magic"}, "range_method is 'magic'"},
        WrongParameter{"UnknownTfMode", {"_tf_mode:=sideways"}, "tf_mode is 'sideways'"},
        WrongParameter{"TwoStarts",
                       {"_initial_pose:=0 0 0", "_global_start:=true"},
                       "initial_pose and global_start are both set"},
        WrongParameter{"PoseOfTwoNumbers",
                       {"_initial_pose:=1.0 2.0"},
                       "initial_pose is '1.0 2.0'; expected 'x y yaw'"},
        WrongParameter{"EqualFrames", {"_particle_filter_frame:=map"}, "must differ"},
        WrongParameter{"NegativeTolerance", {"_transform_tolerance:=-1.0"}, "transform_tolerance"},
        WrongParameter{"HugeSeed", {"_seed:=1e300"}, "seed"},
        WrongParameter{"NoSilence", {"_input_timeout:=0"}, "input_timeout is 0"},
        WrongParameter{"NoRate", {"_diagnostics_rate:=0.0"}, "diagnostics_rate is 0"}),
    [](const auto& wrong) { return wrong.param.name; });

}  // namespace
}  // namespace racecar_mcl
