// A bounded store of panoramas, found by where they were taken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

namespace racecar_mcl {

/// Works as a processor's cache does: a place maps to a set of eight slots, and takes over the slot
/// that has been out of use for longest. Nothing is allocated after construction. Memory that was
/// never written costs none; the kernel is asked to give it in huge pages, for a fault on every
/// other panorama would add a tenth to the time of an update.
class PanoramaCache {
 public:
  /// A place, and whether its panorama exists.
  struct Slot {
    std::uint64_t place = kNowhere;
    std::uint32_t last_used = 0;    ///< round
    std::uint32_t rays_wanted = 0;  ///< since the place got the slot
    bool built = false;
  };

  /// As many panoramas of `directions` ranges as fit into `bytes`; none where not even one set
  /// fits.
  PanoramaCache(std::size_t bytes, int directions);

  /// The slot of a place, or null.
  const Slot* find(std::uint64_t place) const;

  /// The slot of a place, in use in this round. Makes one where there is none; null if the whole
  /// set is in use.
  Slot* claim(std::uint64_t place, std::uint32_t round);

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
  static constexpr std::uint64_t kNowhere = UINT64_MAX;
  static constexpr std::size_t kWays = 8;

  std::size_t firstOfSet(std::uint64_t place) const;

  std::size_t stride_;  ///< ranges from one panorama to the next
  struct Free {
    void operator()(std::uint16_t* memory) const { std::free(memory); }
  };

  std::vector<Slot> slots_;
  std::unique_ptr<std::uint16_t[], Free> ranges_;
};

}  // namespace racecar_mcl
