// Chooses the changes of the localization status that are logged.
#pragma once

#include <cstdio>
#include <optional>
#include <string>

#include "racecar_mcl/monitoring/localization_monitor.h"

namespace racecar_mcl {

/// Lost is reported at once, degraded and localized if they last for a second, so that a state that
/// alternates does not fill the console. A start is not reported: until the first localized, only
/// lost and degraded are warnings.
class StatusLog {
 public:
  struct Message {
    bool is_warning = false;
    std::string text;  ///< one line
  };

  /// The message that is due at `now` (s on any clock), if any. Call it with every status.
  std::optional<Message> update(const LocalizationStatus& status, double now) {
    // Simulated time is 0 until the first /clock.
    const bool clock_jumped = now < last_ || last_ == 0.0;
    last_ = now;
    if (status.state != state_ || clock_jumped) {
      const bool begins = state_ == LocalizationState::kLocalized ||
                          state_ == LocalizationState::kInitializing || clock_jumped;
      if (begins) trouble_since_ = now;
      state_ = status.state;
      since_ = now;
    }
    if (state_ == LocalizationState::kInitializing) reported_ = state_;
    const bool is_due = state_ == LocalizationState::kLost || now - since_ >= kMinDuration;
    if (state_ == reported_ || !is_due) return std::nullopt;
    const bool was_in_trouble = reported_ != LocalizationState::kInitializing;
    reported_ = state_;
    if (state_ != LocalizationState::kLocalized) {
      return Message{true, toString(state_) + ": " + status.reason};
    }
    if (!was_in_trouble) return Message{false, "localized"};
    char text[64];
    std::snprintf(text, sizeof(text), "localized again after %.1f s", since_ - trouble_since_);
    return Message{false, text};
  }

 private:
  static constexpr double kMinDuration = 1.0;  // s

  LocalizationState state_ = LocalizationState::kInitializing;
  LocalizationState reported_ = LocalizationState::kInitializing;
  double last_ = 0.0;           ///< s, of the last update
  double since_ = 0.0;          ///< s, of `state_`
  double trouble_since_ = 0.0;  ///< s, of the first state after localized or initializing
};

}  // namespace racecar_mcl
