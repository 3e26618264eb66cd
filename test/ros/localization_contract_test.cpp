// Interface of the node: topics and tf, with types, frames, rates and contents.
#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <tf2_ros/transform_listener.h>
#include <visualization_msgs/MarkerArray.h>

#include <map>
#include <set>

#include "racecar_mcl/common/errors.h"
#include "support/localization_fixture.h"
#include "support/message_recorder.h"

namespace racecar_mcl {
namespace {

class LocalizationContractTest : public LocalizationTest {
 protected:
  LocalizationContractTest() : tf_listener_(tf_) {}

  /// The pose of a frame in the map, from a tf listener.
  std::optional<Pose2> inMap(const std::string& frame, const ros::Time& stamp) {
    try {
      const auto transform = tf_.lookupTransform("map", frame, stamp).transform;
      return Pose2{transform.translation.x, transform.translation.y, yawOf(transform.rotation)};
    } catch (const tf2::TransformException&) {
      return std::nullopt;
    }
  }

  void expectCarAt(const std::string& frame) {
    const ros::Time stamp(car_.stamp());
    ASSERT_TRUE(listener_.waitFor([&] { return inMap(frame, stamp).has_value(); }));
    EXPECT_LT(distance(*inMap(frame, stamp), car_.baseInMap()), 0.1);
    EXPECT_LT(std::abs(wrapAngle(inMap(frame, stamp)->yaw - car_.baseInMap().yaw)), 0.06);
  }

  /// In real time: odometry at 50 Hz and a scan with every second message.
  void driveLive(double seconds) {
    const ros::WallTime begin = ros::WallTime::now();
    for (int tick = 1; tick <= std::lround(seconds * 50.0); ++tick) {
      ros::WallTime::sleepUntil(begin + ros::WallDuration(0.02 * tick));
      car_.advance(0.02);
      onTick();
      odometry_.publish(car_.odometry());
      if (tick % 2 == 0) scans_.publish(car_.scan());
    }
  }

  tf2_ros::Buffer tf_;
  tf2_ros::TransformListener tf_listener_;
};

TEST_F(LocalizationContractTest, AdvertisesEveryTopicWithItsType) {
  startNode();
  ros::master::V_TopicInfo topics;
  ASSERT_TRUE(ros::master::getTopics(topics));
  std::map<std::string, std::string> types;
  for (const auto& topic : topics) types[topic.name] = topic.datatype;
  EXPECT_EQ(types[namespace_ + "/pf/pose/odom"], "nav_msgs/Odometry");
  EXPECT_EQ(types[namespace_ + "/pf/status"], "diagnostic_msgs/DiagnosticStatus");
  EXPECT_EQ(types[namespace_ + "/pf/obstacles"], "sensor_msgs/PointCloud2");
  EXPECT_EQ(types[namespace_ + "/pf/viz/obstacles"], "visualization_msgs/MarkerArray");
  EXPECT_EQ(types[namespace_ + "/pf/viz/inferred_pose"], "geometry_msgs/PoseStamped");
  EXPECT_EQ(types[namespace_ + "/pf/viz/particles"], "geometry_msgs/PoseArray");
  EXPECT_EQ(types[namespace_ + "/pf/viz/particle_markers"], "visualization_msgs/MarkerArray");
  EXPECT_EQ(types[namespace_ + "/pf/viz/clusters"], "visualization_msgs/MarkerArray");
  EXPECT_EQ(types[namespace_ + "/pf/viz/status"], "visualization_msgs/Marker");
  EXPECT_EQ(types[namespace_ + "/pf/viz/scan"], "sensor_msgs/LaserScan");
  EXPECT_EQ(types[namespace_ + "/pf/viz/fake_scan"], "sensor_msgs/LaserScan");
  EXPECT_EQ(types[namespace_ + "/amcl_pose"], "geometry_msgs/PoseWithCovarianceStamped");
  EXPECT_EQ(types["/diagnostics"], "diagnostic_msgs/DiagnosticArray");
  EXPECT_EQ(types["/tf"], "tf2_msgs/TFMessage");
  for (const char* service : {"global_localization", "request_nomotion_update", "set_map"}) {
    EXPECT_TRUE(ros::service::exists(namespace_ + "/" + service, false)) << service;
  }
}

TEST_F(LocalizationContractTest, PublishesThePoseAtTheRateOfOdometry) {
  car_.setStamp(ros::WallTime::now().toSec());
  startLocalized();
  driveLive(0.5);
  listener_.forget();
  const double begin = car_.stamp();
  driveLive(2.0);
  std::set<double> stamps;
  for (const auto& pose : listener_.poses()) {
    EXPECT_EQ(pose.header.frame_id, "map");
    EXPECT_EQ(pose.child_frame_id, "base_link");
    EXPECT_NEAR(pose.twist.twist.linear.x, 1.0, 1e-9);
    EXPECT_NEAR(pose.twist.twist.angular.z, 1.0, 1e-9);
    EXPECT_TRUE(stamps.insert(pose.header.stamp.toSec()).second) << "stamps must be unique";
    EXPECT_GT(pose.header.stamp.toSec(), begin - 0.1);
  }
  EXPECT_GE(stamps.size(), 90U) << "100 odometry messages";
  expectLocalized();
}

TEST_F(LocalizationContractTest, FillsTheCovarianceCellsOfXYAndYawAlone) {
  startLocalized();
  drive(1.0);
  const auto covariance = listener_.poses().back().pose.covariance;
  for (std::size_t row = 0; row < 6; ++row) {
    for (std::size_t column = 0; column < 6; ++column) {
      const auto is_planar = [](std::size_t axis) { return axis < 2 || axis == 5; };
      const double cell = covariance[6 * row + column];
      EXPECT_NEAR(cell, covariance[6 * column + row], 1e-12);
      if (!is_planar(row) || !is_planar(column)) {
        EXPECT_EQ(cell, 0.0) << row << ", " << column;
      }
    }
  }
  for (const std::size_t variance : {0U, 7U, 35U}) {
    EXPECT_GT(covariance[variance], 0.0);
    EXPECT_LT(covariance[variance], 0.05);
  }
}

TEST_F(LocalizationContractTest, TfHoldsForEveryStampAsSoonAsAMessageCarriesIt) {
  car_.setStamp(ros::WallTime::now().toSec());
  startLocalized();
  driveLive(1.0);
  int answered = 0;
  double worst = 0.0;
  for (int tick = 0; tick < 75; ++tick) {
    driveLive(0.02);
    const std::optional<Pose2> seen = inMap("base_link", ros::Time(car_.stamp()));
    if (!seen) continue;
    ++answered;
    worst = std::max(worst, distance(*seen, car_.baseInMap()));
  }
  EXPECT_GE(answered, 72) << "of 75; under load some transforms are late";
  EXPECT_LT(worst, 0.1);
  expectCarAt("base_link");
}

TEST_F(LocalizationContractTest, AmclPoseIsLatched) {
  startLocalized();
  drive(0.5);
  const MessageRecorder<geometry_msgs::PoseWithCovarianceStamped> late(handle_, "amcl_pose");
  ASSERT_TRUE(listener_.waitFor([&] { return late.count() > 0; }));
  EXPECT_EQ(late.newest().header.frame_id, "map");
  EXPECT_LT(distance(toPose2(late.newest().pose.pose), car_.baseInMap()), 0.1);
  EXPECT_GT(late.newest().pose.covariance[35], 0.0);
}

TEST_F(LocalizationContractTest, ShowsParticlesScansAndPoseToThoseWhoLook) {
  startLocalized();
  drive(1.0);
  const MessageRecorder<geometry_msgs::PoseStamped> pose(handle_, "pf/viz/inferred_pose");
  const MessageRecorder<geometry_msgs::PoseArray> particles(handle_, "pf/viz/particles");
  const MessageRecorder<visualization_msgs::MarkerArray> markers(handle_,
                                                                 "pf/viz/particle_markers");
  const MessageRecorder<visualization_msgs::MarkerArray> clusters(handle_, "pf/viz/clusters");
  const MessageRecorder<sensor_msgs::LaserScan> scan(handle_, "pf/viz/scan");
  const MessageRecorder<sensor_msgs::LaserScan> fake_scan(handle_, "pf/viz/fake_scan");
  ASSERT_TRUE(listener_.waitFor([&] {
    drive(0.04);
    return pose.count() > 0 && particles.count() > 0 && markers.count() > 0 &&
           clusters.count() > 0 && scan.count() > 0 && fake_scan.count() > 0;
  }));
  EXPECT_EQ(pose.newest().header.frame_id, "map");
  EXPECT_LT(distance(toPose2(pose.newest().pose), car_.baseInMap()), 0.15);
  EXPECT_EQ(particles.newest().header.frame_id, "map");
  EXPECT_EQ(particles.newest().poses.size(), 200U);
  ASSERT_EQ(markers.newest().markers.size(), 1U);
  EXPECT_EQ(markers.newest().markers[0].header.frame_id, "map");
  EXPECT_EQ(markers.newest().markers[0].points.size(), markers.newest().markers[0].colors.size());
  const auto& places = clusters.newest().markers;
  ASSERT_GE(places.size(), 3U) << "DELETEALL and two markers per cluster";
  EXPECT_EQ(places[0].action, visualization_msgs::Marker::DELETEALL);
  EXPECT_EQ(places[1].header.frame_id, "map");
  EXPECT_EQ(places[1].ns, "means");
  EXPECT_LT(distance(toPose2(places[1].pose), car_.baseInMap()), 0.2);
  EXPECT_EQ(places[2].ns, "weights");
  EXPECT_GT(std::atof(places[2].text.c_str()), 0.5);
  EXPECT_EQ(scan.newest().header.frame_id, "laser");
  EXPECT_EQ(fake_scan.newest().header.frame_id, "laser");
  ASSERT_EQ(fake_scan.newest().ranges.size(), scan.newest().ranges.size());
  int alike = 0;
  for (std::size_t i = 0; i < scan.newest().ranges.size(); ++i) {
    alike += std::abs(fake_scan.newest().ranges[i] - scan.newest().ranges[i]) < 0.2f;
  }
  EXPECT_GT(alike, static_cast<int>(scan.newest().ranges.size() * 8 / 10));
}

TEST_F(LocalizationContractTest, ShowsNothingMoreOftenThanVisualizationRate) {
  parameters_.setParam("visualization_rate", 5.0);
  startLocalized();
  const MessageRecorder<geometry_msgs::PoseArray> particles(handle_, "pf/viz/particles");
  const ros::WallTime begin = ros::WallTime::now();
  drive(4.0);
  EXPECT_GE(particles.count(), 1);
  EXPECT_LE(particles.count(), 2.0 + 5.0 * (ros::WallTime::now() - begin).toSec());
}

TEST_F(LocalizationContractTest, RepeatsTheStatusWithNewNumbers) {
  car_.setStamp(ros::WallTime::now().toSec());
  startLocalized();
  driveLive(1.0);
  const MessageRecorder<diagnostic_msgs::DiagnosticStatus> status(handle_, "pf/status");
  const MessageRecorder<visualization_msgs::Marker> marker(handle_, "pf/viz/status");
  driveLive(0.5);
  const int before = status.count();
  driveLive(2.0);
  EXPECT_GE(status.count() - before, 10);
  EXPECT_LE(status.count() - before, 25);
  const auto value = [](const diagnostic_msgs::DiagnosticStatus& message, const std::string& key) {
    for (const auto& pair : message.values) {
      if (pair.key == key) return pair.value;
    }
    return std::string();
  };
  EXPECT_EQ(status.newest().message, "localized");
  EXPECT_GT(std::atof(value(status.newest(), "inlier ratio (%)").c_str()), 50.0);
  EXPECT_LT(std::atof(value(status.newest(), "protection level along (m)").c_str()), 1.0);
  EXPECT_EQ(listener_.logged("lost"), 0);
  EXPECT_EQ(listener_.logged("degraded"), 0);
  EXPECT_TRUE(listener_.waitForLog("localized"));

  ASSERT_GT(marker.count(), 0);
  EXPECT_EQ(marker.newest().header.frame_id, "map");
  EXPECT_EQ(marker.newest().type, visualization_msgs::Marker::TEXT_VIEW_FACING);
  EXPECT_EQ(marker.newest().text.rfind("localized\ninliers ", 0), 0U) << marker.newest().text;
  EXPECT_NE(marker.newest().text.find(" m along, "), std::string::npos) << marker.newest().text;
  EXPECT_LT(distance(toPose2(marker.newest().pose), car_.baseInMap()), 1.5);

  // The reason follows while the state stays.
  ros::WallDuration(1.6).sleep();
  ASSERT_TRUE(listener_.waitFor([&] { return status.newest().message == "degraded"; }));
  const std::string reason = value(status.newest(), "reason");
  EXPECT_TRUE(listener_.waitFor([&] { return value(status.newest(), "reason") != reason; }));
  EXPECT_TRUE(listener_.waitForLog("degraded: no usable scan for "));
  driveLive(1.5);
  EXPECT_TRUE(listener_.waitForLog("localized again after "));
}

TEST_F(LocalizationContractTest, DiagnosticsTellTheStateInNumbers) {
  parameters_.setParam("num_particles", 300);
  parameters_.setParam("num_beams_per_particle", 60);
  startLocalized();
  drive(1.0);
  ASSERT_TRUE(listener_.waitFor(
      [&] { return listener_.diagnostics().message.rfind("localized", 0) == 0; }));
  const auto status = listener_.diagnostics();
  EXPECT_EQ(status.level, diagnostic_msgs::DiagnosticStatus::OK);
  EXPECT_EQ(status.name, namespace_ + "/localization: localization");
  EXPECT_EQ(listener_.diagnostic("particles"), "300");
  EXPECT_EQ(listener_.diagnostic("beams"), "60");
  EXPECT_EQ(listener_.diagnostic("scan direction"), "listed");
  EXPECT_GT(std::atof(listener_.diagnostic("effective sample size").c_str()), 1.0);
  EXPECT_GT(std::atof(listener_.diagnostic("position sigma (m)").c_str()), 0.0);
  EXPECT_GT(std::atof(listener_.diagnostic("scan to tf p50 (ms)").c_str()), 0.0);
  EXPECT_LE(std::atof(listener_.diagnostic("scan to tf p50 (ms)").c_str()),
            std::atof(listener_.diagnostic("scan to tf p99 (ms)").c_str()));
}

TEST_F(LocalizationContractTest, WarnsOnceWhereSomebodyElsePublishesAParentOfBaseLink) {
  startLocalized();
  for (int i = 0; i < 3; ++i) {
    drive(0.1);
    transforms_.sendTransform(car_.baseInOdom());
  }
  EXPECT_TRUE(listener_.waitForLog("publishes odom -> base_link, a second parent"));
  EXPECT_TRUE(listener_.waitForLog("tf_mode to map_to_odom and odom_frame to odom"));
  drive(0.2);
  EXPECT_EQ(listener_.logged("a second parent of base_link"), 1);
}

class LocalizationMapToOdomTest : public LocalizationContractTest {
 protected:
  void onTick() override { transforms_.sendTransform(car_.baseInOdom()); }
};

TEST_F(LocalizationMapToOdomTest, PublishesMapToOdomAlone) {
  parameters_.setParam("tf_mode", "map_to_odom");
  startLocalized();
  drive(1.0);
  EXPECT_GT(listener_.transformsFrom("map").size(), 20U);
  for (const auto& transform : listener_.transformsFrom("map")) {
    EXPECT_EQ(transform.child_frame_id, "odom");
  }
  expectCarAt("base_link");
  EXPECT_EQ(listener_.logged("parent"), 0);
}

TEST_F(LocalizationMapToOdomTest, TakesOdometryFromTf) {
  parameters_.setParam("tf_mode", "map_to_odom");
  parameters_.setParam("motion_from", "tf");
  odometry_.shutdown();
  odometry_ = handle_.advertise<nav_msgs::Odometry>("nobody_listens", 1);
  startLocalized();
  EXPECT_GT(drive(1.0), 20);
  expectCarAt("base_link");
  ASSERT_TRUE(listener_.newestPose());
  EXPECT_NEAR(listener_.newestPose()->twist.twist.linear.x, 1.0, 1e-6);
}

TEST_F(LocalizationMapToOdomTest, RefusesOdometryFromTfWhereItWouldGiveTheBaseASecondParent) {
  parameters_.setParam("motion_from", "tf");
  try {
    startNode();
    ADD_FAILURE() << "no ParameterError was thrown";
  } catch (const ParameterError& error) {
    EXPECT_NE(std::string(error.what()).find("expected map_to_odom or off"), std::string::npos)
        << error.what();
  }
}

TEST_F(LocalizationMapToOdomTest, NamesAnOdometryFrameThatIsNotTheOneItPublishes) {
  parameters_.setParam("tf_mode", "map_to_odom");
  parameters_.setParam("odom_frame", "wheels");
  startLocalized();
  drive(0.2);
  EXPECT_TRUE(listener_.waitForLog("odometry is given in 'odom' but tf goes to 'wheels'"));
}

TEST_F(LocalizationContractTest, PublishesNoTfWhenOff) {
  parameters_.setParam("tf_mode", "off");
  startLocalized();
  drive(0.5);
  expectLocalized();
  EXPECT_TRUE(listener_.transformsFrom("map").empty());
}

TEST_F(LocalizationContractTest, StripsLeadingSlashesOfFrames) {
  parameters_.setParam("map_frame", "/map");
  parameters_.setParam("particle_filter_frame", "/base_link");
  startNode();
  map_.publish(toMessage(testRoom(), "/map", ros::Time(1.0)));
  ASSERT_TRUE(listener_.waitForLog("map of"));
  auto start = startMessage(car_.baseInMap());
  start.header.frame_id = "/map";
  initial_pose_.publish(start);
  ASSERT_TRUE(listener_.waitForLog("localizing from"));
  car_.laser_frame = "/laser";
  car_.base_frame = "/base_link";
  car_.odom_frame = "/odom";
  const MessageRecorder<sensor_msgs::LaserScan> scan(handle_, "pf/viz/scan");
  expectStillLocalizes();
  expectCarAt("base_link");
  EXPECT_EQ(listener_.poses().back().header.frame_id, "map");
  ASSERT_GT(scan.count(), 0);
  EXPECT_EQ(scan.newest().header.frame_id, "laser");
}

TEST_F(LocalizationContractTest, HonoursAnUpsideDownLidar) {
  car_.laser_frame = "laser_upside_down";
  car_.extrinsics.upside_down = true;
  startLocalized();
  expectStillLocalizes();
}

/// With a simulator that publishes the truth as map -> base_link.
class LocalizationBesideTruthTest : public LocalizationContractTest {
 protected:
  void onTick() override {
    geometry_msgs::TransformStamped truth = car_.baseInOdom();
    truth.header.frame_id = "map";
    truth.transform =
        toTransform(compose({0.3, -0.2, 0.5}, car_.baseInMap()));  // of the other publisher
    transforms_.sendTransform(truth);
  }
};

TEST_F(LocalizationBesideTruthTest, LocalizesAFrameThatIsOnlyANameForTheEstimate) {
  parameters_.setParam("particle_filter_frame", "base_link_pf");
  startLocalized();
  expectStillLocalizes();
  EXPECT_EQ(listener_.poses().back().child_frame_id, "base_link_pf");
  expectCarAt("base_link_pf");
}

}  // namespace
}  // namespace racecar_mcl
