// A histogram over (x, y, yaw) that stores only the bins that hold particles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "racecar_mcl/pose.h"

namespace racecar_mcl {

/// Size of one bin.
struct PoseBins {
  double position = 0.5;  ///< m
  double yaw = 0.35;      ///< rad
};

/// The bin of a pose. Yaw bins wrap round: there are yawBinCount of them.
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

/// Numbers bins from 0 on, in the order in which they come. Keeps its storage from use to use.
class BinNumbers {
 public:
  /// Forgets all bins and makes room for `most`.
  void startAgain(std::size_t most);

  /// The number of a bin, a new one where it comes for the first time. At most as many bins may
  /// come as there is room for.
  int add(const PoseBin& bin);
  /// The number of a bin, or -1 where it has not come.
  int find(const PoseBin& bin) const { return numbers_[slotOf(bin)]; }

  int size() const { return static_cast<int>(bins_.size()); }
  const PoseBin& operator[](int number) const { return bins_[static_cast<std::size_t>(number)]; }

 private:
  /// Where the bin's number stands, or would.
  std::size_t slotOf(const PoseBin& bin) const;

  std::vector<PoseBin> bins_;
  std::vector<int> numbers_;  ///< by the bins' hashes; at most half are in use, the others are -1
};

}  // namespace racecar_mcl
