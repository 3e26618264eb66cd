// The rules of the house that no compiler checks.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

namespace racecar_mcl {
namespace {

namespace fs = std::filesystem;

/// Every #include of every source file under a folder, as "file: name".
std::vector<std::string> includesUnder(const std::string& folder) {
  std::vector<std::string> includes;
  const fs::path root = fs::path(RACECAR_MCL_SOURCE_DIR) / folder;
  const std::regex include(R"rx(^\s*#\s*include\s*[<"]([^>"]+)[>"].*$)rx");
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".h" && extension != ".hpp" && extension != ".cpp") continue;
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);) {
      std::smatch parts;
      if (!std::regex_match(line, parts, include)) continue;
      includes.push_back(entry.path().lexically_relative(root).string() + ": " + parts[1].str());
    }
  }
  return includes;
}

std::vector<std::string> matching(const std::vector<std::string>& includes,
                                  const std::string& pattern) {
  std::vector<std::string> found;
  const std::regex forbidden(".*: (" + pattern + ")");
  std::copy_if(includes.begin(), includes.end(), std::back_inserter(found),
               [&](const std::string& line) { return std::regex_match(line, forbidden); });
  return found;
}

using None = std::vector<std::string>;

constexpr const char* kRos =
    "ros/.*|ros\\w*/.*|tf2?/.*|tf2_\\w+/.*|\\w+_msgs/.*|\\w+_srvs/.*|nodelet/.*|pluginlib/.*|"
    "XmlRpc.*|xmlrpcpp/.*|boost/.*";

class RosFree : public testing::TestWithParam<const char*> {};

TEST_P(RosFree, KnowsNoRos) { EXPECT_EQ(matching(includesUnder(GetParam()), kRos), None{}); }

INSTANTIATE_TEST_SUITE_P(Folders, RosFree,
                         testing::Values("include/racecar_mcl", "src/core", "src/sim", "test/unit",
                                         "test/contract"));

TEST(PublicHeaders, KeepOpenCvAndYamlToThemselves) {
  EXPECT_EQ(matching(includesUnder("include/racecar_mcl"), "opencv2?/.*|yaml-cpp/.*"), None{});
}

TEST(PublicHeaders, IncludeNothingPrivate) {
  for (const std::string& include : includesUnder("include/racecar_mcl")) {
    const std::string name = include.substr(include.find(": ") + 2);
    if (name.find('/') == std::string::npos) continue;  // the standard library's
    EXPECT_TRUE(name.rfind("racecar_mcl/", 0) == 0 || name.rfind("Eigen/", 0) == 0) << include;
  }
}

TEST(Core, ReadsNoClockAndDrawsNoNumbersOfItsOwn) {
  EXPECT_EQ(matching(includesUnder("src/core"), "chrono|ctime|random|time\\.h"), None{});
  EXPECT_EQ(matching(includesUnder("include/racecar_mcl"), "chrono|ctime|random|time\\.h"), None{});
}

TEST(SimulatedCar, SeesTheWorldWithItsOwnEyes) {
  // Agreement with the filter means something only where the simulator shares none of its casters.
  EXPECT_EQ(matching(includesUnder("src/sim"),
                     "range_casters/.*|racecar_mcl/(range_caster|distance_field|likelihood_field|"
                     "beam_model|sensor_table|particle_filter|localizer)\\.h"),
            None{});
}

}  // namespace
}  // namespace racecar_mcl
