// Thread-safe slot for the newest message.
#pragma once

#include <mutex>
#include <optional>
#include <utility>

namespace racecar_mcl {

template <typename Value>
class Mailbox {
 public:
  /// Returns true if this replaced a value that had not been taken.
  bool put(Value value) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const bool replaced = value_.has_value();
    value_ = std::move(value);
    return replaced;
  }

  std::optional<Value> take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(value_, std::nullopt);
  }

 private:
  std::mutex mutex_;
  std::optional<Value> value_;
};

}  // namespace racecar_mcl
