// Cache of lookup table rows: the ranges in all directions from one position.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

namespace racecar_mcl {

/// Eight-way set-associative cache with least-recently-used replacement. Nothing is allocated after
/// construction. Memory is requested in huge pages: page faults of the first writes took a tenth of
/// the time of an update (docs/decisions.md).
class LookupTableCache {
 public:
  /// A position, and whether its row is filled.
  struct Slot {
    std::uint64_t position = kNoPosition;
    std::uint32_t last_used = 0;       ///< number of the update
    std::uint32_t rays_requested = 0;  ///< since the position got the slot
    bool is_filled = false;
  };

  /// As many rows of `directions` ranges as fit into `bytes`; none if not even one set fits.
  LookupTableCache(std::size_t bytes, int directions);

  /// The slot of a position, or null.
  const Slot* find(std::uint64_t position) const;

  /// The slot of a position, marked as used in this update; replaces the least recently used slot
  /// if there is none. Null if all slots of the set are used in this update.
  Slot* claim(std::uint64_t position, std::uint32_t update);

  std::uint16_t* ranges(const Slot& slot) {
    return ranges_.get() + static_cast<std::size_t>(&slot - slots_.data()) * stride_;
  }
  const std::uint16_t* ranges(const Slot& slot) const {
    return ranges_.get() + static_cast<std::size_t>(&slot - slots_.data()) * stride_;
  }

  std::size_t memoryBytes() const {
    return slots_.size() * (sizeof(Slot) + stride_ * sizeof(std::uint16_t));
  }

 private:
  static constexpr std::uint64_t kNoPosition = UINT64_MAX;
  static constexpr std::size_t kWays = 8;

  std::size_t firstOfSet(std::uint64_t position) const;

  std::size_t stride_;  ///< ranges per row
  struct Free {
    void operator()(std::uint16_t* memory) const { std::free(memory); }
  };

  std::vector<Slot> slots_;
  std::unique_ptr<std::uint16_t[], Free> ranges_;
};

}  // namespace racecar_mcl
