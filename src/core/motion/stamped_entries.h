// Searches in buffers whose entries have increasing stamps.
#pragma once

#include <algorithm>

namespace racecar_mcl {

/// The first entry that is newer than `stamp` (s); the end if there is none.
template <typename Entries>
auto firstAfter(const Entries& entries, double stamp) {
  return std::upper_bound(entries.begin(), entries.end(), stamp,
                          [](double value, const auto& entry) { return value < entry.stamp; });
}

/// The entries from the last one that is not newer than `stamp` (s) on; all if each is newer.
template <typename Entries>
Entries entriesSince(const Entries& entries, double stamp) {
  auto first = firstAfter(entries, stamp);
  if (first != entries.begin()) --first;
  return Entries(first, entries.end());
}

}  // namespace racecar_mcl
