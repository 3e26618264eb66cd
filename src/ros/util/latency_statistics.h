// Quantiles of the newest 400 durations.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace racecar_mcl {

class LatencyStatistics {
 public:
  void add(double seconds) {
    if (seconds_.size() < kSize) {
      seconds_.push_back(seconds);
    } else {
      seconds_[next_] = seconds;
    }
    next_ = (next_ + 1) % kSize;
  }

  /// The quantile of the window at `ratio`; 0 while the window is empty.
  double quantile(double ratio) const {
    if (seconds_.empty()) return 0.0;
    std::vector<double> sorted = seconds_;
    const auto rank = static_cast<std::ptrdiff_t>(ratio * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
    return sorted[static_cast<std::size_t>(rank)];
  }

 private:
  static constexpr std::size_t kSize = 400;
  std::vector<double> seconds_;
  std::size_t next_ = 0;
};

}  // namespace racecar_mcl
