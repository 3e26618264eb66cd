#include "range_casters/panorama_cache.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

#include <algorithm>
#include <new>

namespace racecar_mcl {
namespace {

/// Memory that nothing was written to, on huge pages where the system has them.
std::uint16_t* allocate(std::size_t count) {
  constexpr std::size_t kHugePage = 2 << 20;
  const std::size_t bytes = (count * sizeof(std::uint16_t) / kHugePage + 1) * kHugePage;
  void* const memory = std::aligned_alloc(kHugePage, bytes);
  if (memory == nullptr) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
  madvise(memory, bytes, MADV_HUGEPAGE);  // a wish: where it is not granted, pages are small
#endif
  return static_cast<std::uint16_t*>(memory);
}

}  // namespace

PanoramaCache::PanoramaCache(std::size_t bytes, int directions)
    : stride_(static_cast<std::size_t>(directions)),
      slots_(bytes / (sizeof(Slot) + stride_ * sizeof(std::uint16_t)) / kWays * kWays),
      ranges_(allocate(slots_.size() * stride_)) {}

std::size_t PanoramaCache::firstOfSet(std::uint64_t place) const {
  // The upper half of a product with a large odd number is well mixed (Knuth's multiplicative
  // hash); scaled to the number of sets.
  const std::uint64_t mixed = ((place ^ (place >> 29)) * 0x9E3779B97F4A7C15U) >> 32;
  return static_cast<std::size_t>((mixed * (slots_.size() / kWays)) >> 32) * kWays;
}

const PanoramaCache::Slot* PanoramaCache::find(std::uint64_t place) const {
  if (slots_.empty()) return nullptr;
  const Slot* set = slots_.data() + firstOfSet(place);
  const Slot* found =
      std::find_if(set, set + kWays, [&](const Slot& s) { return s.place == place; });
  return found == set + kWays ? nullptr : found;
}

PanoramaCache::Slot* PanoramaCache::claim(std::uint64_t place, std::uint32_t round) {
  if (slots_.empty()) return nullptr;
  Slot* slot = const_cast<Slot*>(find(place));
  if (slot == nullptr) {
    Slot* set = slots_.data() + firstOfSet(place);
    slot = std::min_element(set, set + kWays, [&](const Slot& a, const Slot& b) {
      return round - a.last_used > round - b.last_used;
    });
    if (slot->last_used == round) return nullptr;
    *slot = {place, round, 0, false};
  }
  slot->last_used = round;
  return slot;
}

}  // namespace racecar_mcl
