// Messages about changes of the status.
#include "ros/localization/status_log.h"

#include <gtest/gtest.h>

#include <vector>

namespace racecar_mcl {
namespace {

using State = LocalizationState;

/// Holds a state for some seconds, at 10 Hz, and collects the messages.
class StatusLogTest : public ::testing::Test {
 protected:
  void hold(State state, double seconds, const std::string& reason = "a reason") {
    LocalizationStatus status;
    status.state = state;
    status.reason = reason;
    for (const double end = now_ + seconds; now_ < end - 1e-6; now_ += 0.1) {
      const auto message = log_.update(status, now_);
      if (message) messages_.push_back((message->is_warning ? "WARN " : "INFO ") + message->text);
    }
  }
  std::vector<std::string> messages() { return std::exchange(messages_, {}); }

  StatusLog log_;
  double now_ = 100.0;
  std::vector<std::string> messages_;
};

using Messages = std::vector<std::string>;

TEST_F(StatusLogTest, AJumpOfTheClockIsNoDuration) {
  now_ = 0.0;  // before the first /clock
  hold(State::kDegraded, 0.1);
  now_ = 1000.0;
  hold(State::kDegraded, 0.5);
  hold(State::kLocalized, 2.0);
  EXPECT_EQ(messages(), Messages{"INFO localized"});
}

TEST_F(StatusLogTest, AGoodStartIsNoWarning) {
  hold(State::kInitializing, 4.0);
  hold(State::kDegraded, 0.5);
  hold(State::kLocalized, 10.0);
  EXPECT_EQ(messages(), Messages{"INFO localized"});
}

TEST_F(StatusLogTest, LostIsReportedWithItsReasonAndTheReturnWithTheTime) {
  hold(State::kLocalized, 3.0);
  messages();
  hold(State::kDegraded, 0.5, "slip");
  hold(State::kLost, 2.0, "the scans contradict the map");
  hold(State::kLocalized, 0.9);
  EXPECT_EQ(messages(), Messages{"WARN lost: the scans contradict the map"});
  hold(State::kLocalized, 5.0);
  EXPECT_EQ(messages(), Messages{"INFO localized again after 2.5 s"});
}

TEST_F(StatusLogTest, DegradedIsReportedOnceAndOnlyIfItLasts) {
  hold(State::kLocalized, 3.0);
  messages();
  hold(State::kDegraded, 0.9);
  hold(State::kLocalized, 3.0);
  EXPECT_EQ(messages(), Messages{});
  hold(State::kDegraded, 1.5, "no usable scan for 1.0 s");
  hold(State::kDegraded, 10.0, "no usable scan for 2.0 s");
  EXPECT_EQ(messages(), Messages{"WARN degraded: no usable scan for 1.0 s"});
}

TEST_F(StatusLogTest, AnAlternatingStateIsReportedOnce) {
  hold(State::kLocalized, 3.0);
  messages();
  for (int i = 0; i < 20; ++i) {
    hold(State::kLost, 0.2);
    hold(State::kLocalized, 0.2);
  }
  EXPECT_EQ(messages().size(), 1U);
}

TEST_F(StatusLogTest, ANewStartIsNoReturn) {
  hold(State::kLocalized, 3.0);
  hold(State::kLost, 1.0);
  messages();
  hold(State::kInitializing, 1.0);
  hold(State::kLocalized, 2.0);
  EXPECT_EQ(messages(), Messages{"INFO localized"});
}

TEST_F(StatusLogTest, ACarThatIsLostAfterItsStartCountsFromThere) {
  hold(State::kInitializing, 2.0);
  hold(State::kLost, 3.0);
  hold(State::kLocalized, 2.0);
  EXPECT_EQ(messages(), (Messages{"WARN lost: a reason", "INFO localized again after 3.0 s"}));
}

TEST_F(StatusLogTest, AClockThatIsSetBackDelaysNothingForLong) {
  hold(State::kLocalized, 3.0);
  messages();
  now_ = 10.0;
  hold(State::kDegraded, 2.0);
  EXPECT_EQ(messages(), Messages{"WARN degraded: a reason"});
  hold(State::kLocalized, 2.0);
  EXPECT_EQ(messages(), Messages{"INFO localized again after 2.0 s"});
}

}  // namespace
}  // namespace racecar_mcl
