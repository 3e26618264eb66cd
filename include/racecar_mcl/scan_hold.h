// A scan often arrives just before the odometry that reaches up to its stamp. Waiting for that
// odometry is better than guessing the last bit of motion, but not for long.
#pragma once

#include <deque>
#include <optional>
#include <utility>

namespace racecar_mcl {

/// A scan waits at most this long for the odometry that covers it.
constexpr double kOdometryPatience = 0.02;  // s

/// Items with a stamp, held in order of arrival. `now` is any clock that the driver keeps, in s.
template <typename Item>
class ScanHold {
 public:
  /// `patience`: s that an item waits at most.
  explicit ScanHold(double patience = kOdometryPatience) : patience_(patience) {}

  void add(double stamp, double now, Item item) { held_.push_back({stamp, now, std::move(item)}); }

  bool empty() const { return held_.empty(); }

  /// The oldest item if it may go: `covers(stamp)` says that odometry has reached its stamp, or its
  /// patience is over, or the clock was set back. Call it until it returns nothing.
  template <typename Covers>
  std::optional<Item> takeReady(double now, Covers&& covers) {
    if (held_.empty()) return std::nullopt;
    const Held& oldest = held_.front();
    const double waited = now - oldest.arrival;
    const bool waits = waited >= 0.0 && waited < patience_;
    if (waits && !covers(oldest.stamp)) return std::nullopt;
    return take();
  }

  /// The oldest item, ready or not; none when empty.
  std::optional<Item> take() {
    if (held_.empty()) return std::nullopt;
    std::optional<Item> item(std::move(held_.front().item));
    held_.pop_front();
    return item;
  }

 private:
  struct Held {
    double stamp;
    double arrival;
    Item item;
  };

  double patience_;
  std::deque<Held> held_;
};

}  // namespace racecar_mcl
