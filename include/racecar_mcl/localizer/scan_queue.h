// Queue of scans that wait for the odometry that covers their stamps.
//
// A scan often arrives shortly before that odometry. A short wait is more accurate than
// extrapolating the motion.
#pragma once

#include <cstddef>
#include <deque>
#include <limits>
#include <optional>
#include <utility>

namespace racecar_mcl {

/// Maximum time that a scan waits for odometry, s: one period at 50 Hz.
constexpr double kMaxOdometryWait = 0.02;

/// First-in-first-out queue of items with a stamp (s). `now` is the time on any clock, s.
template <typename Item>
class ScanQueue {
 public:
  /// When `capacity` is exceeded, the oldest item is dropped. `max_wait`: s.
  explicit ScanQueue(std::size_t capacity = std::numeric_limits<std::size_t>::max(),
                     double max_wait = kMaxOdometryWait)
      : capacity_(capacity), max_wait_(max_wait) {}

  /// Returns false if the oldest item was dropped.
  bool add(double stamp, double now, Item item) {
    queue_.push_back({stamp, now, std::move(item)});
    if (queue_.size() <= capacity_) return true;
    queue_.pop_front();
    return false;
  }

  bool empty() const { return queue_.empty(); }

  /// Whether the oldest item is ready: `covers(stamp)` is true, it has waited for max_wait, or the
  /// clock was set back.
  template <typename Covers>
  bool isReady(double now, Covers&& covers) const {
    if (queue_.empty()) return false;
    const double waited = now - queue_.front().arrival;
    return waited < 0.0 || waited >= max_wait_ || covers(queue_.front().stamp);
  }

  /// Removes and returns the oldest item if it is ready. Call it until it returns nothing.
  template <typename Covers>
  std::optional<Item> takeReady(double now, Covers&& covers) {
    return isReady(now, covers) ? take() : std::nullopt;
  }

  /// Removes and returns the oldest item, ready or not; none if the queue is empty.
  std::optional<Item> take() {
    if (queue_.empty()) return std::nullopt;
    std::optional<Item> item(std::move(queue_.front().item));
    queue_.pop_front();
    return item;
  }

 private:
  struct Waiting {
    double stamp;
    double arrival;
    Item item;
  };

  std::size_t capacity_;
  double max_wait_;
  std::deque<Waiting> queue_;
};

}  // namespace racecar_mcl
