// The panel, loaded as rviz loads it, without a display.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <rviz/config.h>
#include <rviz/panel.h>
#include <std_srvs/Empty.h>
#include <std_srvs/Trigger.h>

#include <QApplication>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <functional>
#include <memory>
#include <pluginlib/class_loader.hpp>
#include <string>

namespace racecar_mcl {
namespace {

diagnostic_msgs::KeyValue pair(const std::string& key, const std::string& value) {
  diagnostic_msgs::KeyValue pair;
  pair.key = key;
  pair.value = value;
  return pair;
}

/// A panel and the topics and services of a localizer.
class RvizPanelTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    static int argc = 1;
    static char name[] = "rviz_panel_test";
    static char* argv[] = {name, nullptr};
    application_ = std::make_unique<QApplication>(argc, argv);
  }
  static void TearDownTestSuite() { application_.reset(); }

  RvizPanelTest()
      : loader_("rviz", "rviz::Panel"),
        panel_(loader_.createUnmanagedInstance("racecar_mcl/Localization")) {}

  /// Advertises a service that counts its calls.
  template <typename Service>
  void serve(const std::string& name,
             const std::function<void(typename Service::Response*)>& answer) {
    const boost::function<bool(typename Service::Request&, typename Service::Response&)> call =
        [this, answer](typename Service::Request&, typename Service::Response& response) {
          ++calls_;
          answer(&response);
          return true;
        };
    services_.push_back(handle_.advertiseService(name, call));
  }

  std::string text(const std::string& name) const {
    const auto* label = panel_->findChild<QLabel*>(QString::fromStdString(name));
    return label ? label->text().toStdString() : "there is no label " + name;
  }

  void click(const std::string& name) {
    auto* button = panel_->findChild<QPushButton*>(QString::fromStdString(name));
    ASSERT_TRUE(button) << name;
    button->click();
  }

  void enterNode(const QString& name) {
    auto* line = panel_->findChild<QLineEdit*>("node");
    ASSERT_TRUE(line);
    line->setText(name);
    Q_EMIT line->editingFinished();
  }

  /// Processes messages and events as rviz does, until `holds` returns true.
  static bool waitFor(const std::function<bool()>& holds, double seconds = 10.0) {
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(seconds);
    while (!holds()) {
      if (ros::WallTime::now() > end) return false;
      ros::spinOnce();
      QApplication::processEvents();
      ros::WallDuration(0.01).sleep();
    }
    return true;
  }

  bool waitForText(const std::string& name, const std::string& expected) const {
    return waitFor([&] { return text(name) == expected; });
  }

  /// Publishes until the panel shows the state.
  bool showState(const std::string& topic, int level, const std::string& state) {
    ros::Publisher publisher = handle_.advertise<diagnostic_msgs::DiagnosticStatus>(topic, 1);
    diagnostic_msgs::DiagnosticStatus status;
    status.level = static_cast<diagnostic_msgs::DiagnosticStatus::_level_type>(level);
    status.message = state;
    status.values = {pair("reason", "the scans say so"), pair("inlier ratio (%)", "93"),
                     pair("protection level heading (rad)", "0.0349066")};
    return waitFor([&] {
      publisher.publish(status);
      return text("state") == state;
    });
  }

  std::string style() const {
    return panel_->findChild<QLabel*>("state")->styleSheet().toStdString();
  }

  static std::unique_ptr<QApplication> application_;
  ros::NodeHandle handle_;
  pluginlib::ClassLoader<rviz::Panel> loader_;
  std::unique_ptr<rviz::Panel> panel_;
  std::vector<ros::ServiceServer> services_;
  int calls_ = 0;
};

std::unique_ptr<QApplication> RvizPanelTest::application_;

TEST_F(RvizPanelTest, AStatusChangesTextsAndColour) {
  EXPECT_EQ(text("state"), "no localizer");
  const std::string before = style();
  ASSERT_TRUE(showState("/pf/status", diagnostic_msgs::DiagnosticStatus::OK, "localized"));
  const std::string localized = style();
  EXPECT_EQ(text("reason"), "the scans say so");
  EXPECT_EQ(text("explained"), "93 %");
  EXPECT_EQ(text("heading_bound"), "2.0°");
  EXPECT_NE(localized, before);
  ASSERT_TRUE(showState("/pf/status", diagnostic_msgs::DiagnosticStatus::ERROR, "lost"));
  EXPECT_NE(style(), localized);
}

TEST_F(RvizPanelTest, DiagnosticsOfTheNodeAreShownAndThoseOfOthersAreNot) {
  ros::Publisher publisher = handle_.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 1);
  diagnostic_msgs::DiagnosticArray array;
  for (const char* name : {"/localization: localization", "/other: localization"}) {
    array.status.emplace_back();
    array.status.back().name = name;
    array.status.back().message = std::string("of ") + name;
  }
  ASSERT_TRUE(waitFor([&] {
    publisher.publish(array);
    return text("state") != "no localizer";
  }));
  EXPECT_EQ(text("state"), "of /localization: localization");
}

TEST_F(RvizPanelTest, AStatusThatEndsIsNoLongerShown) {
  ASSERT_TRUE(showState("/pf/status", diagnostic_msgs::DiagnosticStatus::OK, "localized"));
  EXPECT_TRUE(waitForText("state", "no localizer"));
}

TEST_F(RvizPanelTest, ButtonsCallTheServicesAndShowTheirAnswers) {
  serve<std_srvs::Empty>("/global_localization", [](auto*) {});
  serve<std_srvs::Trigger>("/localization/save_pose", [](auto* response) {
    response->success = true;
    response->message = "saved in a file";
  });
  serve<std_srvs::Trigger>("/localization/reload_parameters", [](auto* response) {
    response->success = false;
    response->message = "num_particles is -1";
  });
  click("global_localization");
  EXPECT_TRUE(waitForText("answer", "done"));
  click("~save_pose");
  EXPECT_TRUE(waitForText("answer", "done: saved in a file"));
  click("~reload_parameters");
  EXPECT_TRUE(waitForText("answer", "refused: num_particles is -1"));
  EXPECT_EQ(calls_, 3);
}

TEST_F(RvizPanelTest, ClosesWhileACallWaitsForItsAnswer) {
  serve<std_srvs::Trigger>("/localization/save_pose", [](auto*) {});
  click("~save_pose");
  ros::WallDuration(0.5).sleep();  // the call waits: this thread would answer
  panel_.reset();
  EXPECT_EQ(calls_, 0);
}

TEST_F(RvizPanelTest, AMissingServiceIsNamedAndTheButtonsStayUsable) {
  for (int i = 0; i < 2; ++i) {
    click("~save_pose");
    EXPECT_EQ(text("answer"), "waiting for an answer");
    EXPECT_TRUE(waitForText("answer", "there is no service /localization/save_pose"));
  }
}

TEST_F(RvizPanelTest, TheNodeCanBeChangedAndIsSaved) {
  enterNode("/car2/mcl");
  ASSERT_TRUE(showState("/car2/pf/status", diagnostic_msgs::DiagnosticStatus::OK, "localized"));
  click("~save_pose");
  EXPECT_TRUE(waitForText("answer", "there is no service /car2/mcl/save_pose"));
  click("global_localization");
  EXPECT_TRUE(waitForText("answer", "there is no service /car2/global_localization"));
  rviz::Config config;
  panel_->save(config);
  panel_.reset(loader_.createUnmanagedInstance("racecar_mcl/Localization"));
  panel_->load(config);
  ASSERT_TRUE(showState("/car2/pf/status", diagnostic_msgs::DiagnosticStatus::OK, "localized"));
}

TEST_F(RvizPanelTest, AWrongNodeIsRefused) {
  enterNode("my node!");
  EXPECT_EQ(text("answer").rfind("'my node!' is no name of a node", 0), 0U) << text("answer");
  EXPECT_EQ(panel_->findChild<QLineEdit*>("node")->text(), "/localization");
}

}  // namespace
}  // namespace racecar_mcl
