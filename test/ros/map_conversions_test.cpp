#include "ros/conversions/map_conversions.h"

#include <gtest/gtest.h>

#include <limits>

#include "racecar_mcl/common/errors.h"
#include "support/ascii_map.h"

namespace racecar_mcl {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

const char kDrawing[] = R"(
    ####
    #.?#
    #..#)";

nav_msgs::OccupancyGrid message(double yaw = 0.0) {
  return toMessage(asciiMap(kDrawing, 0.05, {1.0, -2.0, yaw}), "map", ros::Time(12, 34));
}

nav_msgs::OccupancyGrid messageTurned(double x, double y, double z, double w) {
  nav_msgs::OccupancyGrid turned = message();
  turned.info.origin.orientation.x = x;
  turned.info.origin.orientation.y = y;
  turned.info.origin.orientation.z = z;
  turned.info.origin.orientation.w = w;
  return turned;
}

double mapYaw(const nav_msgs::OccupancyGrid& map) {
  return toOccupancyGrid(map).geometry().origin.yaw;
}

TEST(MapConversions, FillsTheMessage) {
  const nav_msgs::OccupancyGrid map = message(kPi / 2);
  EXPECT_EQ(map.header.frame_id, "map");
  EXPECT_EQ(map.header.stamp, ros::Time(12, 34));
  EXPECT_EQ(map.info.map_load_time, ros::Time(12, 34));
  EXPECT_EQ(map.info.width, 4u);
  EXPECT_EQ(map.info.height, 3u);
  EXPECT_EQ(map.info.resolution, 0.05f);
  EXPECT_EQ(map.info.origin.position.x, 1.0);
  EXPECT_EQ(map.info.origin.position.y, -2.0);
  EXPECT_NEAR(map.info.origin.orientation.z, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(map.info.origin.orientation.w, std::sqrt(0.5), 1e-12);
  EXPECT_EQ(map.data,
            (std::vector<std::int8_t>{100, 0, 0, 100, 100, 0, -1, 100, 100, 100, 100, 100}));
}

TEST(MapConversions, ComeBackAsTheyWent) {
  for (const double yaw : {0.0, 0.3, kPi / 2, 3.14, kPi, -1.0, -3.14}) {
    for (const double resolution : {0.05, 0.1, 0.025, 1.0 / 3.0, 1.0}) {
      const OccupancyGrid grid = asciiMap(kDrawing, resolution, {-1.5, 2.25, yaw});
      const OccupancyGrid back = toOccupancyGrid(toMessage(grid, "map", ros::Time()));
      EXPECT_EQ(back.cells(), grid.cells());
      EXPECT_EQ(back.geometry().width, 4);
      EXPECT_EQ(back.geometry().height, 3);
      EXPECT_NEAR(back.geometry().resolution, resolution, 1e-7 * resolution);
      EXPECT_EQ(back.geometry().origin.x, -1.5);
      EXPECT_EQ(back.geometry().origin.y, 2.25);
      EXPECT_NEAR(wrapAngle(back.geometry().origin.yaw - yaw), 0.0, 1e-12);
    }
  }
}

TEST(MapConversions, KeepADecimalResolutionExact) {
  for (const double resolution : {0.01, 0.02, 0.025, 0.03, 0.05, 0.1, 0.0625, 0.062500}) {
    const OccupancyGrid grid = asciiMap(kDrawing, resolution);
    EXPECT_EQ(toOccupancyGrid(toMessage(grid, "map", ros::Time())).geometry().resolution,
              resolution);
  }
}

TEST(MapConversions, TakeQuaternionsOfAnyLengthAndSign) {
  EXPECT_NEAR(mapYaw(messageTurned(0, 0, std::sin(0.35), std::cos(0.35))), 0.7, 1e-12);
  EXPECT_NEAR(mapYaw(messageTurned(0, 0, 3 * std::sin(0.35), 3 * std::cos(0.35))), 0.7, 1e-12);
  EXPECT_NEAR(mapYaw(messageTurned(0, 0, -std::sin(0.35), -std::cos(0.35))), 0.7, 1e-12);
  EXPECT_NEAR(std::abs(mapYaw(messageTurned(0, 0, 1, 0))), kPi, 1e-12);
  EXPECT_NEAR(mapYaw(messageTurned(1e-8, -1e-8, 0, 1)), 0.0, 1e-12);
}

TEST(MapConversions, RejectQuaternionsThatGiveNoYaw) {
  EXPECT_THROW(toOccupancyGrid(messageTurned(0, 0, 0, 0)), MapError);
  EXPECT_THROW(toOccupancyGrid(messageTurned(0, 0, kNaN, 1)), MapError);
  EXPECT_THROW(toOccupancyGrid(messageTurned(0, 0, 0, std::numeric_limits<double>::infinity())),
               MapError);
}

TEST(MapConversions, RejectATiltedMap) {
  EXPECT_THROW(toOccupancyGrid(messageTurned(std::sin(0.05), 0, 0, std::cos(0.05))), MapError);
  EXPECT_THROW(toOccupancyGrid(messageTurned(1, 0, 0, 0)), MapError);
  EXPECT_THROW(toOccupancyGrid(messageTurned(0.5, 0.5, 0.5, 0.5)), MapError);
}

TEST(MapConversions, TakeValuesOutsideTheScaleForUnknown) {
  nav_msgs::OccupancyGrid map = message();
  map.data[0] = 101;
  map.data[1] = -128;
  map.data[2] = 37;
  const std::vector<std::int8_t> cells = toOccupancyGrid(map).cells();
  EXPECT_EQ(cells[0], OccupancyGrid::kUnknown);
  EXPECT_EQ(cells[1], OccupancyGrid::kUnknown);
  EXPECT_EQ(cells[2], 37);
}

TEST(MapConversions, RejectMessagesThatAreNoMap) {
  EXPECT_THROW(toOccupancyGrid(nav_msgs::OccupancyGrid()), MapError);
  const auto expectRejected = [](auto&& spoil) {
    nav_msgs::OccupancyGrid map = message();
    spoil(map);
    EXPECT_THROW(toOccupancyGrid(map), MapError);
  };
  expectRejected([](auto& map) { map.info.width = 0; });
  expectRejected([](auto& map) { map.info.height = 0; });
  expectRejected([](auto& map) { map.info.width = 0xffffffffu; });
  expectRejected([](auto& map) { map.info.width = map.info.height = 0x7fffffffu; });
  expectRejected([](auto& map) { map.data.pop_back(); });
  expectRejected([](auto& map) { map.info.resolution = 0.0f; });
  expectRejected([](auto& map) { map.info.resolution = -0.05f; });
  expectRejected([](auto& map) { map.info.resolution = static_cast<float>(kNaN); });
  expectRejected([](auto& map) { map.info.resolution = 1e38f; });
  expectRejected([](auto& map) { map.info.resolution = 1e-38f; });
  expectRejected([](auto& map) { map.info.origin.position.x = kNaN; });
  expectRejected([](auto& map) { map.info.origin.position.y = 1e308; });
}

}  // namespace
}  // namespace racecar_mcl
