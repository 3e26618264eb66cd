// Queue of scans that wait for the odometry that covers their stamps.
//
// A scan often arrives shortly before that odometry. A short wait is more accurate than
// extrapolating the motion.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <limits>
#include <optional>
#include <utility>

namespace racecar_mcl {

/// Maximum time that a scan waits for odometry, s: one period at 50 Hz.
constexpr double kMaxOdometryWait = 0.02;

/// Queue of items with a stamp (s): first in, first out for each lidar, and by stamp among lidars.
/// `now` is the time on any clock, s.
template <typename Item>
class ScanQueue {
 public:
  /// When `capacity` of one lidar is exceeded, its oldest item is dropped. `max_wait`: s.
  explicit ScanQueue(std::size_t capacity = std::numeric_limits<std::size_t>::max(),
                     double max_wait = kMaxOdometryWait)
      : capacity_(capacity), max_wait_(max_wait) {}

  /// Returns false if the lidar's oldest item was dropped.
  bool add(double stamp, double now, Item item, int lidar = 0) {
    auto place = queue_.end();
    while (place != queue_.begin() && (place - 1)->lidar != lidar && (place - 1)->stamp > stamp) {
      --place;
    }
    queue_.insert(place, {lidar, stamp, now, std::move(item)});
    const auto is_of_lidar = [lidar](const Waiting& waiting) { return waiting.lidar == lidar; };
    const auto count = std::count_if(queue_.begin(), queue_.end(), is_of_lidar);
    if (static_cast<std::size_t>(count) <= capacity_) return true;
    queue_.erase(std::find_if(queue_.begin(), queue_.end(), is_of_lidar));
    return false;
  }

  bool empty() const { return queue_.empty(); }

  /// Whether the first item is ready: `covers(stamp)` is true, it has waited for max_wait, or the
  /// clock was set back.
  template <typename Covers>
  bool isReady(double now, Covers&& covers) const {
    if (queue_.empty()) return false;
    const double waited = now - queue_.front().arrival;
    return waited < 0.0 || waited >= max_wait_ || covers(queue_.front().stamp);
  }

  /// Removes and returns the first item if it is ready. Call it until it returns nothing.
  template <typename Covers>
  std::optional<Item> takeReady(double now, Covers&& covers) {
    return isReady(now, covers) ? take() : std::nullopt;
  }

  /// Removes and returns the first item, ready or not; none if the queue is empty.
  std::optional<Item> take() {
    if (queue_.empty()) return std::nullopt;
    std::optional<Item> item(std::move(queue_.front().item));
    queue_.pop_front();
    return item;
  }

 private:
  struct Waiting {
    int lidar;
    double stamp;
    double arrival;
    Item item;
  };

  std::size_t capacity_;
  double max_wait_;
  std::deque<Waiting> queue_;
};

}  // namespace racecar_mcl
