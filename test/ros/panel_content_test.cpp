#include "ros/rviz_panel/panel_content.h"

#include <gtest/gtest.h>

#include <map>

namespace racecar_mcl {
namespace {

using Status = diagnostic_msgs::DiagnosticStatus;

Status makeStatus(int level, const std::string& message,
                  const std::map<std::string, std::string>& values) {
  Status status;
  status.level = static_cast<Status::_level_type>(level);
  status.message = message;
  for (const auto& [key, value] : values) {
    status.values.emplace_back();
    status.values.back().key = key;
    status.values.back().value = value;
  }
  return status;
}

Status localized() {
  return makeStatus(Status::OK, "localized",
                    {{"reason", "the scans match the map"},
                     {"inlier ratio (%)", "93.4"},
                     {"baseline inlier ratio (%)", "95.6"},
                     {"protection level along (m)", "0.246"},
                     {"protection level across (m)", "0.118"},
                     {"protection level heading (rad)", "0.0349066"}});
}

Status diagnostics() {
  return makeStatus(Status::OK, "localized: the scans match the map",
                    {{"particles", "200"},
                     {"position sigma (m)", "0.0213"},
                     {"yaw sigma (rad)", "0.00698"},
                     {"scan to tf p50 (ms)", "2.04"},
                     {"scan to tf p99 (ms)", "5.26"},
                     {"last problem", "no odometry"}});
}

TEST(PanelContent, ShowsTheNumbersOfBothMessages) {
  const PanelContent content = panelContent(localized(), diagnostics());
  EXPECT_EQ(content.state, "localized");
  EXPECT_EQ(content.reason, "the scans match the map");
  EXPECT_EQ(content.explained, "93 %, usually 96 %");
  EXPECT_EQ(content.position_bound, "0.25 m along, 0.12 m across");
  EXPECT_EQ(content.heading_bound, "2.0°");
  EXPECT_EQ(content.sigma, "0.021 m, 0.4°");
  EXPECT_EQ(content.particles, "200");
  EXPECT_EQ(content.latency, "2.0 ms, 99 %: 5.3 ms");
}

TEST(PanelContent, TheColourIsThatOfTheLevel) {
  std::map<std::string, int> colours;
  for (const int level : {Status::OK, Status::WARN, Status::ERROR, Status::STALE}) {
    Status status = localized();
    status.level = static_cast<Status::_level_type>(level);
    const std::string colour = panelContent(status, std::nullopt).colour;
    EXPECT_EQ(colour.size(), 7U);
    EXPECT_EQ(colour[0], '#');
    ++colours[colour];
  }
  EXPECT_EQ(colours.size(), 4U);
  EXPECT_EQ(panelContent(std::nullopt, std::nullopt).colour,
            panelContent(makeStatus(Status::STALE, "", {}), std::nullopt).colour);
}

TEST(PanelContent, BeforeAStartTheDiagnosticsSayWhatIsMissing) {
  Status waiting = diagnostics();
  waiting.level = Status::WARN;
  waiting.message = "waiting for a start pose";
  const PanelContent content = panelContent(std::nullopt, waiting);
  EXPECT_EQ(content.state, "waiting for a start pose");
  EXPECT_EQ(content.reason, "no odometry");
  EXPECT_EQ(content.particles, "-");
  EXPECT_EQ(content.explained, "-");
}

TEST(PanelContent, WithoutMessagesThereIsNoLocalizer) {
  const PanelContent content = panelContent(std::nullopt, std::nullopt);
  EXPECT_EQ(content.state, "no localizer");
  for (const std::string& text : {content.explained, content.position_bound, content.heading_bound,
                                  content.sigma, content.particles, content.latency}) {
    EXPECT_EQ(text, "-");
  }
}

TEST(PanelContent, NumbersThatAreNotFiniteOrMissingAreUnknown) {
  const Status status = makeStatus(Status::WARN, "initializing",
                                   {{"inlier ratio (%)", "nan"},
                                    {"protection level along (m)", "inf"},
                                    {"protection level across (m)", "0.1"}});
  const PanelContent content = panelContent(status, makeStatus(Status::WARN, "", {}));
  EXPECT_EQ(content.explained, "-");
  EXPECT_EQ(content.position_bound, "-");
  EXPECT_EQ(content.heading_bound, "-");
  EXPECT_EQ(content.sigma, "-");
  EXPECT_EQ(content.particles, "-");
  EXPECT_EQ(content.latency, "-");
}

}  // namespace
}  // namespace racecar_mcl
