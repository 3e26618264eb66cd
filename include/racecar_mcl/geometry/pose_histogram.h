// Sparse histogram over (x, y, yaw): only occupied bins are stored.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "racecar_mcl/geometry/pose2.h"

namespace racecar_mcl {

/// Size of one bin.
struct PoseBins {
  double position = 0.5;  ///< m
  double yaw = 0.35;      ///< rad
};

/// Indices of a bin. Yaw bins wrap round: there are yawBinCount of them.
struct PoseBin {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t yaw = 0;

  bool operator==(const PoseBin& other) const {
    return x == other.x && y == other.y && yaw == other.yaw;
  }
};

std::int32_t yawBinCount(const PoseBins& bins);

PoseBin binOf(const Pose2& pose, const PoseBins& bins);

/// Assigns consecutive numbers to bins, from 0 on, in the order of insertion. Reuses its storage.
class BinNumbers {
 public:
  /// Removes all bins and reserves space for `capacity` of them.
  void reset(std::size_t capacity);

  /// The number of a bin; a new bin gets the next number. Precondition: at most `capacity`
  /// different bins are added.
  int add(const PoseBin& bin);
  /// The number of a bin, or -1 if it was not added.
  int find(const PoseBin& bin) const { return numbers_[slotOf(bin)]; }

  int size() const { return static_cast<int>(bins_.size()); }
  const PoseBin& operator[](int number) const { return bins_[static_cast<std::size_t>(number)]; }

 private:
  /// The slot of the bin in the hash table, or the empty slot for it.
  std::size_t slotOf(const PoseBin& bin) const;

  std::vector<PoseBin> bins_;
  std::vector<int> numbers_;  ///< open-addressing hash table, at most half full; empty slots are -1
};

}  // namespace racecar_mcl
