// The map nodelet and node. Runs with a nodelet manager that has loaded a MapNodelet with
// test/data/small_map.yaml: see map_nodelet.test.
#include <gtest/gtest.h>
#include <nav_msgs/GetMap.h>
#include <nav_msgs/OccupancyGrid.h>
#include <nodelet/NodeletLoad.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>

#include "ros/conversions/map_conversions.h"
#include "support/ascii_map.h"
#include "support/temporary_directory.h"

namespace racecar_mcl {
namespace {

const ros::Duration kPatience(20.0);
const std::string kSmallMap = RACECAR_MCL_SOURCE_DIR "/test/data/small_map.yaml";
const std::string kMapNode = RACECAR_MCL_PROGRAM_DIR "/map_node";
const std::string kSmallRoom =
    "######\n"
    "#...?#\n"
    "#....#\n"
    "######\n";

template <typename Message>
typename Message::ConstPtr receive(const std::string& topic, ros::Duration max_wait = kPatience) {
  return ros::topic::waitForMessage<Message>(topic, max_wait);
}

void loadNodelet(const std::string& name) {
  ASSERT_TRUE(ros::service::waitForService("manager/load_nodelet", kPatience));
  nodelet::NodeletLoad load;
  load.request.name = name;
  load.request.type = "racecar_mcl/MapNodelet";
  for (const char* topic : {"map", "map_metadata", "static_map"}) {
    load.request.remap_source_args.push_back(std::string("/") + topic);
    load.request.remap_target_args.push_back(name + "/" + topic);
  }
  ASSERT_TRUE(ros::service::call("manager/load_nodelet", load));
}

struct Run {
  int exit_code = -1;
  std::string output;
};

/// Runs map_node, which must exit by itself, and captures its output.
Run runMapNode(const std::string& arguments) {
  Run run;
  FILE* pipe = popen(("timeout 20 " + kMapNode + " " + arguments + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return run;
  char text[256];
  while (std::fgets(text, sizeof(text), pipe) != nullptr) run.output += text;
  const int status = pclose(pipe);
  if (WIFEXITED(status)) run.exit_code = WEXITSTATUS(status);
  return run;
}

void expectRefused(const std::string& arguments, const std::string& complaint) {
  const Run run = runMapNode(arguments);
  EXPECT_EQ(run.exit_code, 1) << arguments;
  const std::size_t found = run.output.find(complaint);
  ASSERT_NE(found, std::string::npos) << "'" << complaint << "' not in: " << run.output;
  EXPECT_EQ(run.output.find(complaint, found + 1), std::string::npos) << "reported twice";
}

std::string mapYaml(const std::string& image) {
  return "image: " + image +
         "\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\n"
         "free_thresh: 0.196\n";
}

TEST(MapNodelet, LatchesTheMap) {
  const auto map = receive<nav_msgs::OccupancyGrid>("map");
  ASSERT_TRUE(map);
  EXPECT_EQ(map->header.frame_id, "map");
  const OccupancyGrid grid = toOccupancyGrid(*map);
  EXPECT_EQ(toAscii(grid), kSmallRoom);
  EXPECT_EQ(grid.geometry().resolution, 0.1);
  EXPECT_NEAR(grid.geometry().origin.yaw, 3.14, 1e-12);
  // A later subscriber receives it, too.
  EXPECT_TRUE(receive<nav_msgs::OccupancyGrid>("map"));
}

TEST(MapNodelet, LatchesTheMetadata) {
  const auto metadata = receive<nav_msgs::MapMetaData>("map_metadata");
  ASSERT_TRUE(metadata);
  EXPECT_EQ(metadata->width, 6u);
  EXPECT_EQ(metadata->height, 4u);
  EXPECT_EQ(metadata->resolution, 0.1f);
  EXPECT_EQ(metadata->origin.position.x, -1.5);
  EXPECT_EQ(metadata->origin.position.y, 2.25);
}

TEST(MapNodelet, ServesTheMap) {
  ASSERT_TRUE(ros::service::waitForService("static_map", kPatience));
  nav_msgs::GetMap service;
  ASSERT_TRUE(ros::service::call("static_map", service));
  const auto map = receive<nav_msgs::OccupancyGrid>("map");
  ASSERT_TRUE(map);
  const auto& served = service.response.map.info;
  EXPECT_EQ(served.map_load_time, map->info.map_load_time);
  EXPECT_EQ(served.resolution, map->info.resolution);
  EXPECT_EQ(served.width, map->info.width);
  EXPECT_EQ(served.height, map->info.height);
  EXPECT_EQ(served.origin.position.x, map->info.origin.position.x);
  EXPECT_EQ(served.origin.position.y, map->info.origin.position.y);
  EXPECT_EQ(service.response.map.data, map->data);
}

TEST(MapNodelet, ReloadsAnotherMapAndKeepsItWhereTheNextIsBroken) {
  const TemporaryDirectory directory;
  directory.write("other.pgm", "P2\n2 1\n255\n255 0\n");
  const std::string other = directory.write("other.yaml", mapYaml("other.pgm"));
  ros::param::set("reloaded/yaml_filename", kSmallMap);
  ros::param::set("reloaded/frame_id", "/basement");
  loadNodelet("/reloaded");
  const auto first = receive<nav_msgs::OccupancyGrid>("reloaded/map");
  ASSERT_TRUE(first);
  EXPECT_EQ(first->header.frame_id, "basement");

  std_srvs::Trigger reload;
  ros::param::set("reloaded/yaml_filename", other);
  ASSERT_TRUE(ros::service::call("reloaded/reload", reload));
  EXPECT_TRUE(reload.response.success) << reload.response.message;
  const auto second = receive<nav_msgs::OccupancyGrid>("reloaded/map");
  ASSERT_TRUE(second);
  EXPECT_EQ(toAscii(toOccupancyGrid(*second)), ".#\n");

  ros::param::set("reloaded/yaml_filename", directory.write("broken.yaml", "image: [\n"));
  ASSERT_TRUE(ros::service::call("reloaded/reload", reload));
  EXPECT_FALSE(reload.response.success);
  EXPECT_NE(reload.response.message.find("broken.yaml"), std::string::npos);
  nav_msgs::GetMap service;
  ASSERT_TRUE(ros::service::call("reloaded/static_map", service));
  EXPECT_EQ(service.response.map.data, second->data);
}

TEST(MapNodelet, StaysUnconfiguredOnABadMapWhileItsManagerLivesOn) {
  const TemporaryDirectory directory;
  ros::param::set("broken/yaml_filename", directory.write("broken.yaml", "resolution: none\n"));
  loadNodelet("/broken");
  loadNodelet("/unnamed");
  EXPECT_FALSE(receive<nav_msgs::OccupancyGrid>("broken/map", ros::Duration(0.5)));
  EXPECT_FALSE(ros::service::exists("broken/static_map", false));
  EXPECT_FALSE(ros::service::exists("unnamed/static_map", false));
  EXPECT_TRUE(ros::service::exists("static_map", false));
}

TEST(MapNode, ServesTheMapItIsGiven) {
  const TemporaryDirectory directory;
  directory.write("solid.pgm", "P2\n2 1\n255\n0 0\n");
  const std::string solid = directory.write("solid.yaml", mapYaml("solid.pgm"));
  // A relative path, as on a command line. The node runs until the test has received its map.
  const std::string start = "cd " + directory.path().string() + " && { " + kMapNode +
                            " solid.yaml __ns:=/program & echo $! > pid; }";
  ASSERT_EQ(std::system(start.c_str()), 0);
  const auto map = receive<nav_msgs::OccupancyGrid>("/program/map");
  EXPECT_EQ(std::system(("kill $(cat " + directory.path().string() + "/pid)").c_str()), 0);
  ASSERT_TRUE(map);
  EXPECT_EQ(toAscii(toOccupancyGrid(*map)), "##\n");
  std::string path;
  ros::param::get("/program/map_node/yaml_filename", path);
  EXPECT_EQ(path, solid);
}

TEST(MapNode, SaysWhyAndEndsWithOneOnABadMap) {
  const TemporaryDirectory directory;
  const std::string broken = directory.write("broken.yaml", "image: [\n");
  const std::string imageless = directory.write("imageless.yaml", mapYaml("none.pgm"));
  expectRefused("__name:=a", "/a/yaml_filename is not set");
  expectRefused(broken + " __name:=b", "broken.yaml', line 2, is not valid YAML");
  expectRefused(imageless + " __name:=c", "none.pgm' does not exist");
  expectRefused("nowhere.yaml __name:=d", "nowhere.yaml' does not exist");
  expectRefused("one.yaml two.yaml", "usage: map_node");
  EXPECT_EQ(runMapNode("--help").exit_code, 0);
}

}  // namespace
}  // namespace racecar_mcl
