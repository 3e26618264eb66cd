#include "racecar_mcl/geometry/pose_histogram.h"

#include <algorithm>
#include <cmath>

namespace racecar_mcl {
namespace {

std::size_t hashOf(const PoseBin& bin) {
  std::uint64_t hash = static_cast<std::uint32_t>(bin.x) * 0x9e3779b97f4a7c15ULL;
  hash = (hash ^ (hash >> 29)) + static_cast<std::uint32_t>(bin.y) * 0xbf58476d1ce4e5b9ULL;
  hash = (hash ^ (hash >> 31)) + static_cast<std::uint32_t>(bin.yaw) * 0x94d049bb133111ebULL;
  return static_cast<std::size_t>(hash ^ (hash >> 32));
}

}  // namespace

std::int32_t yawBinCount(const PoseBins& bins) {
  return std::max(1, static_cast<std::int32_t>(std::lround(2.0 * kPi / bins.yaw)));
}

PoseBin binOf(const Pose2& pose, const PoseBins& bins) {
  const std::int32_t yaw_bins = yawBinCount(bins);
  const double turn = (wrapAngle(pose.yaw) + kPi) / (2.0 * kPi);
  // Clamped so that far positions do not overflow an index. std::max returns its first argument if
  // the second is NaN.
  const auto index = [&](double position) {
    return static_cast<std::int32_t>(
        std::floor(std::min(std::max(-1e9, position / bins.position), 1e9)));
  };
  return {index(pose.x), index(pose.y),
          std::min(static_cast<std::int32_t>(std::max(0.0, turn) * yaw_bins), yaw_bins - 1)};
}

void BinNumbers::reset(std::size_t capacity) {
  bins_.clear();
  bins_.reserve(capacity);
  std::size_t slots = 2;
  while (slots < 2 * capacity) slots *= 2;
  numbers_.assign(slots, -1);
}

int BinNumbers::add(const PoseBin& bin) {
  int& number = numbers_[slotOf(bin)];
  if (number < 0) {
    number = size();
    bins_.push_back(bin);
  }
  return number;
}

std::size_t BinNumbers::slotOf(const PoseBin& bin) const {
  const std::size_t mask = numbers_.size() - 1;
  std::size_t slot = hashOf(bin) & mask;
  while (numbers_[slot] >= 0 && !((*this)[numbers_[slot]] == bin)) slot = (slot + 1) & mask;
  return slot;
}

}  // namespace racecar_mcl
