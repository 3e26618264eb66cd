#include "raycasting/lookup_table_cache.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

#include <algorithm>
#include <new>

namespace racecar_mcl {
namespace {

/// Uninitialized memory, in huge pages if the system grants them.
std::uint16_t* allocate(std::size_t count) {
  constexpr std::size_t kHugePage = 2 << 20;
  const std::size_t bytes = (count * sizeof(std::uint16_t) / kHugePage + 1) * kHugePage;
  void* const memory = std::aligned_alloc(kHugePage, bytes);
  if (memory == nullptr) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
  madvise(memory, bytes, MADV_HUGEPAGE);  // a hint, which the system may ignore
#endif
  return static_cast<std::uint16_t*>(memory);
}

}  // namespace

LookupTableCache::LookupTableCache(std::size_t bytes, int directions)
    : stride_(static_cast<std::size_t>(directions)),
      slots_(bytes / (sizeof(Slot) + stride_ * sizeof(std::uint16_t)) / kWays * kWays),
      ranges_(allocate(slots_.size() * stride_)) {}

std::size_t LookupTableCache::firstOfSet(std::uint64_t position) const {
  // The upper half of a product with a large odd number is well mixed (Knuth's multiplicative
  // hash); scaled to the number of sets.
  const std::uint64_t mixed = ((position ^ (position >> 29)) * 0x9E3779B97F4A7C15U) >> 32;
  return static_cast<std::size_t>((mixed * (slots_.size() / kWays)) >> 32) * kWays;
}

const LookupTableCache::Slot* LookupTableCache::find(std::uint64_t position) const {
  if (slots_.empty()) return nullptr;
  const Slot* set = slots_.data() + firstOfSet(position);
  const Slot* found =
      std::find_if(set, set + kWays, [&](const Slot& s) { return s.position == position; });
  return found == set + kWays ? nullptr : found;
}

LookupTableCache::Slot* LookupTableCache::claim(std::uint64_t position, std::uint32_t update) {
  if (slots_.empty()) return nullptr;
  Slot* slot = const_cast<Slot*>(find(position));
  if (slot == nullptr) {
    Slot* set = slots_.data() + firstOfSet(position);
    slot = std::min_element(set, set + kWays, [&](const Slot& a, const Slot& b) {
      return update - a.last_used > update - b.last_used;
    });
    if (slot->last_used == update) return nullptr;
    *slot = {position, update, 0, false};
  }
  slot->last_used = update;
  return slot;
}

}  // namespace racecar_mcl
