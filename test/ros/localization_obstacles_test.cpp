// Topics of obstacles that the map lacks: points around them, tracks, and no work without
// subscribers.
#include <sensor_msgs/PointCloud2.h>
#include <sensor_msgs/point_cloud2_iterator.h>
#include <visualization_msgs/MarkerArray.h>

#include <cstdlib>

#include "support/localization_fixture.h"
#include "support/message_recorder.h"

namespace racecar_mcl {
namespace {

using Clouds = MessageRecorder<sensor_msgs::PointCloud2>;
using Markers = MessageRecorder<visualization_msgs::MarkerArray>;

/// The car drives circles around a disc that the map lacks.
class LocalizationObstaclesTest : public LocalizationTest {
 protected:
  void placeDisc() { car_.obstacles = {disc_}; }

  /// m, of a point of the map from the edge of the disc.
  double distanceToDisc(double x, double y) const {
    return std::hypot(x - disc_.in_map.x, y - disc_.in_map.y) - disc_.radius;
  }

  /// Drives until the recorder has a message.
  template <typename Recorder>
  bool driveUntilReceived(const Recorder& recorder) {
    const int before = recorder.count();
    return listener_.waitFor([&] {
      drive(0.04);
      return recorder.count() > before;
    });
  }

  /// Waits until everything of the last scan is published, which is later than its pose: the thread
  /// that publishes answers this call afterwards.
  bool finishedLastScan() const {
    std_srvs::Trigger reload;
    return ros::service::call(namespace_ + "/localization/reload_parameters", reload);
  }

  sim::Obstacle disc_ = [] {
    sim::Obstacle disc;
    disc.radius = 0.2;
    disc.in_map = compose(roomInMap(), {4.0, 3.0, 0.0});
    return disc;
  }();
};

TEST_F(LocalizationObstaclesTest, PublishesPointsAroundAnObstacleInTheMap) {
  placeDisc();
  startLocalized();
  drive(1.0);
  const Clouds clouds(handle_, "pf/obstacles");
  ASSERT_TRUE(driveUntilReceived(clouds));
  const sensor_msgs::PointCloud2 cloud = clouds.newest();
  EXPECT_EQ(cloud.header.frame_id, "map");
  EXPECT_NEAR(cloud.header.stamp.toSec(), car_.stamp(), 0.05);
  EXPECT_EQ(cloud.height, 1u);
  EXPECT_GE(cloud.width, 10u);
  ASSERT_EQ(cloud.data.size(), cloud.width * cloud.point_step);
  for (sensor_msgs::PointCloud2ConstIterator<float> point(cloud, "x"); point != point.end();
       ++point) {
    EXPECT_LT(
        std::abs(distanceToDisc(static_cast<double>(point[0]), static_cast<double>(point[1]))),
        0.15);
    EXPECT_EQ(point[2], 0.0f);
  }
}

TEST_F(LocalizationObstaclesTest, PublishesAnEmptyCloudWhereTheMapExplainsTheScan) {
  startLocalized();
  drive(1.0);
  const Clouds clouds(handle_, "pf/obstacles");
  ASSERT_TRUE(driveUntilReceived(clouds));
  EXPECT_EQ(clouds.newest().width, 0u);
  EXPECT_EQ(clouds.newest().header.frame_id, "map");
  EXPECT_EQ(clouds.newest().fields.size(), 3u);
  placeDisc();
  EXPECT_TRUE(listener_.waitFor([&] {
    drive(0.1);
    return clouds.count() > 0 && clouds.newest().width > 0u;
  }));
}

TEST_F(LocalizationObstaclesTest, ShowsTracksWithStableIdsAndSpeeds) {
  placeDisc();
  startLocalized();
  drive(1.0);
  const Markers markers(handle_, "pf/viz/obstacles");
  ASSERT_TRUE(driveUntilReceived(markers));
  // The tracker starts with the subscription, and confirms a track after five scans.
  EXPECT_LE(markers.newest().markers.size(), 1u);
  const auto driveUntilMarkers = [&](std::size_t count) {
    return listener_.waitFor([&] {
      drive(0.1);
      return markers.newest().markers.size() == count;
    });
  };
  ASSERT_TRUE(driveUntilMarkers(4)) << "DELETEALL and three markers of one track";
  const auto tracks = markers.newest().markers;
  EXPECT_EQ(tracks[0].action, visualization_msgs::Marker::DELETEALL);
  for (std::size_t i = 1; i < tracks.size(); ++i) {
    EXPECT_EQ(tracks[i].header.frame_id, "map");
    EXPECT_EQ(tracks[i].id, 1);
  }
  EXPECT_EQ(tracks[1].ns, "extents");
  EXPECT_LT(distanceToDisc(tracks[1].pose.position.x, tracks[1].pose.position.y), 0.0);
  EXPECT_EQ(tracks[2].ns, "velocities");
  EXPECT_EQ(tracks[2].points.size(), 2u);
  EXPECT_EQ(tracks[3].ns, "speeds");
  EXPECT_TRUE(listener_.waitFor([&] {
    drive(0.1);
    const auto newest = markers.newest().markers;
    return newest.size() == 4u && std::atof(newest[3].text.c_str()) < 0.3;
  })) << "it stands";
  car_.obstacles.clear();
  EXPECT_TRUE(driveUntilMarkers(1)) << "deleted";
}

TEST_F(LocalizationObstaclesTest, PublishesNothingWithoutSubscribers) {
  placeDisc();
  startLocalized();
  drive(1.0);
  ASSERT_TRUE(finishedLastScan());
  const Clouds clouds(handle_, "pf/obstacles");
  const Markers markers(handle_, "pf/viz/obstacles");
  ros::WallDuration(0.5).sleep();
  EXPECT_EQ(clouds.count(), 0) << "not latched";
  EXPECT_EQ(markers.count(), 0);
  EXPECT_TRUE(driveUntilReceived(clouds));
}

TEST_F(LocalizationObstaclesTest, TakesTheParametersOfTheDetection) {
  parameters_.setParam("obstacle_distance", 5.0);
  placeDisc();
  startLocalized();
  drive(1.0);
  const Clouds clouds(handle_, "pf/obstacles");
  ASSERT_TRUE(driveUntilReceived(clouds));
  EXPECT_EQ(clouds.newest().width, 0u);
  parameters_.setParam("obstacle_distance", 0.1);
  std_srvs::Trigger reload;
  ASSERT_TRUE(ros::service::call(namespace_ + "/localization/reload_parameters", reload));
  EXPECT_TRUE(reload.response.success) << reload.response.message;
  EXPECT_TRUE(listener_.waitFor([&] {
    drive(0.1);
    return clouds.count() > 0 && clouds.newest().width > 0u;
  }));
}

}  // namespace
}  // namespace racecar_mcl
