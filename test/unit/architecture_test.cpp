// The rules of the house that no compiler checks.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace racecar_mcl {
namespace {

namespace fs = std::filesystem;

struct Include {
  std::string file;
  std::string name;
};

/// Every #include of every source file under a folder.
std::vector<Include> includesUnder(const std::string& folder) {
  std::vector<Include> includes;
  const fs::path root = fs::path(RACECAR_MCL_SOURCE_DIR) / folder;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".h" && extension != ".hpp" && extension != ".cpp") continue;
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);) {
      if (line.rfind("#include ", 0) != 0) continue;
      const std::size_t open = line.find_first_of("<\"");
      const std::size_t close = line.find_first_of(">\"", open + 1);
      includes.push_back({entry.path().lexically_relative(root).string(),
                          line.substr(open + 1, close - open - 1)});
    }
  }
  return includes;
}

/// Those whose name starts with one of the given texts, as "file: name".
std::vector<std::string> startingWith(const std::vector<std::string>& beginnings,
                                      const std::vector<Include>& includes) {
  std::vector<std::string> found;
  for (const Include& include : includes) {
    const bool starts = std::any_of(
        beginnings.begin(), beginnings.end(),
        [&](const std::string& beginning) { return include.name.rfind(beginning, 0) == 0; });
    if (starts) found.push_back(include.file + ": " + include.name);
  }
  return found;
}

using None = std::vector<std::string>;

const std::vector<std::string> kRos{"ros/",
                                    "rosbag/",
                                    "roscpp/",
                                    "rosgraph_msgs/",
                                    "std_msgs/",
                                    "std_srvs/",
                                    "geometry_msgs/",
                                    "sensor_msgs/",
                                    "nav_msgs/",
                                    "diagnostic_msgs/",
                                    "visualization_msgs/",
                                    "tf/",
                                    "tf2/",
                                    "tf2_ros/",
                                    "tf2_msgs/",
                                    "tf2_geometry_msgs/",
                                    "nodelet/",
                                    "pluginlib/",
                                    "XmlRpc",
                                    "xmlrpcpp/",
                                    "boost/"};

class RosFree : public testing::TestWithParam<const char*> {};

TEST_P(RosFree, KnowsNoRos) { EXPECT_EQ(startingWith(kRos, includesUnder(GetParam())), None{}); }

INSTANTIATE_TEST_SUITE_P(Folders, RosFree,
                         testing::Values("include/racecar_mcl", "src/core", "src/map_io", "src/sim",
                                         "src/evaluation", "src/calibration", "src/map_changes",
                                         "test/unit", "test/contract"));

TEST(RosCode, IsWhatTheTestWouldFind) {
  EXPECT_FALSE(startingWith(kRos, includesUnder("src/ros")).empty());
}

TEST(PublicHeaders, IncludeOnlyEachOtherEigenAndTheStandardLibrary) {
  for (const Include& include : includesUnder("include/racecar_mcl")) {
    const bool standard = include.name.find('/') == std::string::npos;
    EXPECT_TRUE(standard || include.name.rfind("racecar_mcl/", 0) == 0 ||
                include.name.rfind("Eigen/", 0) == 0)
        << include.file << ": " << include.name;
  }
}

// The floors of the core, lowest first. A folder uses those on its own floor and below.
const std::vector<std::vector<std::string>> kFloors{
    {"common", "geometry"},
    {"map", "simd", "scan"},
    {"raycasting", "motion"},
    {"sensor"},
    {"filter", "monitoring"},
    {"relocalization", "obstacles"},
    {"localizer"},
};

/// The floor of a folder of the core; -1 where it is none.
int floorOf(const std::string& folder) {
  for (std::size_t floor = 0; floor < kFloors.size(); ++floor) {
    const std::vector<std::string>& folders = kFloors[floor];
    if (std::find(folders.begin(), folders.end(), folder) != folders.end()) {
      return static_cast<int>(floor);
    }
  }
  return -1;
}

/// The first folder of a path, after `prefix` where it has that.
std::string folderOf(std::string path, const std::string& prefix = "") {
  if (path.rfind(prefix, 0) == 0) path = path.substr(prefix.size());
  return path.substr(0, path.find('/'));
}

class CoreFolders : public testing::TestWithParam<const char*> {};

TEST_P(CoreFolders, IncludeOnlyFromTheirOwnFloorAndBelow) {
  const std::vector<Include> includes = includesUnder(GetParam());
  int between_folders = 0;
  for (const Include& include : includes) {
    const int from = floorOf(folderOf(include.file));
    EXPECT_GE(from, 0) << include.file << " lies in no folder of a floor";
    const int to = floorOf(folderOf(include.name, "racecar_mcl/"));
    if (include.name.find('/') == std::string::npos || to < 0) continue;
    EXPECT_LE(to, from) << include.file << " includes " << include.name;
    between_folders += to < from ? 1 : 0;
  }
  EXPECT_GT(between_folders, 20) << "the floors are not what the files are in";
}

INSTANTIATE_TEST_SUITE_P(Headers, CoreFolders, testing::Values("include/racecar_mcl", "src/core"));

TEST(Core, ReadsNoClockAndDrawsNoNumbersOfItsOwn) {
  const std::vector<std::string> forbidden{"chrono", "ctime", "random", "time.h"};
  EXPECT_EQ(startingWith(forbidden, includesUnder("src/core")), None{});
  EXPECT_EQ(startingWith(forbidden, includesUnder("include/racecar_mcl")), None{});
}

TEST(SimulatedCar, SeesTheWorldWithItsOwnEyes) {
  // Agreement with the filter means something only where the simulator shares none of its casters.
  // The raceline is planned on the map; it measures nothing.
  const std::vector<std::string> planning{"racing_path.cpp: racecar_mcl/map/distance_field.h"};
  EXPECT_EQ(
      startingWith({"raycasting/", "racecar_mcl/raycasting/", "racecar_mcl/map/distance_field",
                    "racecar_mcl/sensor/", "racecar_mcl/filter/", "racecar_mcl/localizer/"},
                   includesUnder("src/sim")),
      planning);
}

}  // namespace
}  // namespace racecar_mcl
