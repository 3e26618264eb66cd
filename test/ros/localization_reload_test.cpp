// Parameters that change while the node runs.
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "support/localization_fixture.h"

namespace racecar_mcl {
namespace {

#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
constexpr int kChanges = 100;  // ten times slower
#else
constexpr int kChanges = 1000;
#endif

class LocalizationReloadTest : public LocalizationTest {
 protected:
  std_srvs::TriggerResponse reload() {
    std_srvs::Trigger trigger;
    EXPECT_TRUE(ros::service::call(namespace_ + "/localization/reload_parameters", trigger));
    return trigger.response;
  }

  void expectRefused(const std::string& words) {
    const std_srvs::TriggerResponse response = reload();
    EXPECT_FALSE(response.success);
    EXPECT_NE(response.message.find(words), std::string::npos) << response.message;
    EXPECT_TRUE(listener_.waitForLog("parameters not changed: "));
  }
};

TEST_F(LocalizationReloadTest, ChangesAreAppliedAndThePoseIsKept) {
  startLocalized();
  expectStillLocalizes();
  parameters_.setParam("num_particles", 321);
  parameters_.setParam("num_beams_per_particle", 60);
  parameters_.setParam("input_timeout", 2.5);
  const std_srvs::TriggerResponse response = reload();
  EXPECT_TRUE(response.success);
  EXPECT_EQ(
      response.message,
      "input_timeout: 1 -> 2.5, num_beams_per_particle: 240 -> 60, num_particles: 200 -> 321");
  expectStillLocalizes();
  EXPECT_TRUE(listener_.waitForDiagnostic("particles", "321"));
  EXPECT_TRUE(listener_.waitForDiagnostic("beams", "60"));
  EXPECT_TRUE(listener_.waitForDiagnostic("status", "localized"));
  EXPECT_EQ(reload().message, "none");
}

TEST_F(LocalizationReloadTest, TheSensorModelCanBeExchanged) {
  startLocalized();
  expectStillLocalizes();
  for (const char* model : {"beam", "likelihood_field", "beam"}) {
    parameters_.setParam("sensor_model", model);
    EXPECT_TRUE(reload().success);
    expectStillLocalizes();
  }
}

TEST_F(LocalizationReloadTest, AWrongChangeIsRefusedAndNothingChanges) {
  startLocalized();
  parameters_.setParam("num_beams_per_particle", 60);
  parameters_.setParam("num_particles", -1);
  expectRefused("num_particles is -1");
  parameters_.deleteParam("num_particles");
  parameters_.setParam("num_particels", 300);
  expectRefused("did you mean 'num_particles'?");
  parameters_.deleteParam("num_particels");
  // Refused while the map is built: the range must reach that of the beam table.
  parameters_.setParam("sensor_model", "beam");
  parameters_.setParam("max_range", 1.0);
  expectRefused("max_range is 1 m but the beam table reaches");
  parameters_.deleteParam("sensor_model");
  parameters_.deleteParam("max_range");
  expectStillLocalizes();
  EXPECT_TRUE(listener_.waitForDiagnostic("beams", "240"));
  EXPECT_TRUE(listener_.waitForDiagnostic("particles", "200"));
}

TEST_F(LocalizationReloadTest, AParameterThatNeedsARestartIsRefused) {
  startLocalized();
  parameters_.setParam("tf_mode", "off");
  expectRefused("tf_mode is 'map_to_base' and cannot become 'off' while the node runs");
  parameters_.deleteParam("tf_mode");
  parameters_.setParam("initial_pose", "1 2 0.5");
  expectRefused("initial_pose is '' and cannot become '1 2 0.5'");
  expectStillLocalizes();
}

TEST_F(LocalizationReloadTest, WorksBeforeAMapAndAStart) {
  startNode();
  parameters_.setParam("sensor_model", "beam");
  parameters_.setParam("num_particles", 300);
  EXPECT_TRUE(reload().success);
  publishMap();
  ASSERT_TRUE(listener_.waitForLog("map of"));
  initial_pose_.publish(startMessage(car_.baseInMap()));
  ASSERT_TRUE(listener_.waitForLog("localizing from"));
  expectStillLocalizes();
  EXPECT_TRUE(listener_.waitForDiagnostic("particles", "300"));
}

TEST_F(LocalizationReloadTest, AThousandChangesWhileDrivingKeepThePoseAndTf) {
  car_.setStamp(ros::WallTime::now().toSec());
  startLocalized();
  expectStillLocalizes();
  listener_.forget();
  std::atomic<bool> is_done{false};
  std::thread changes([&] {
    for (int i = 0; i < kChanges; ++i) {
      parameters_.setParam("num_particles", 200 + i % 100);
      parameters_.setParam("yaw_noise_from_translation", 0.04 + 0.0001 * (i % 50));
      // Every tenth change needs new lookup structures of the map.
      parameters_.setParam("field_scale", 0.045 + 0.001 * (i / 10 % 2));
      EXPECT_TRUE(reload().success);
    }
    is_done = true;
  });
  const ros::WallTime begin = ros::WallTime::now();
  double worst = 0.0;
  for (int tick = 1; !is_done; ++tick) {
    ros::WallTime::sleepUntil(begin + ros::WallDuration(0.02 * tick));
    car_.advance(0.02);
    odometry_.publish(car_.odometry());
    if (tick % 2 == 0) scans_.publish(car_.scan());
    const auto pose = listener_.newestPose();
    if (!pose || pose->header.stamp.toSec() < car_.stamp() - 0.1) continue;
    const double moved = std::abs(car_.twist.vx) * (car_.stamp() - pose->header.stamp.toSec());
    worst = std::max(worst, distance(toPose2(pose->pose.pose), car_.baseInMap()) - moved);
  }
  changes.join();
  EXPECT_LT(worst, 0.1);
  expectStillLocalizes();
  EXPECT_TRUE(listener_.waitForDiagnostic("status", "localized"));
  EXPECT_EQ(listener_.logged("lost"), 0);

  std::vector<double> stamps;
  for (const auto& transform : listener_.transformsFrom("map")) {
    stamps.push_back(transform.header.stamp.toSec());
  }
  ASSERT_GT(stamps.size(), 100U);
  std::sort(stamps.begin(), stamps.end());
  double gap = 0.0;
  for (std::size_t i = 1; i < stamps.size(); ++i) gap = std::max(gap, stamps[i] - stamps[i - 1]);
  EXPECT_LT(gap, 0.05);
}

}  // namespace
}  // namespace racecar_mcl
