#include "range_casters/panorama_cache.h"

#include <algorithm>

namespace racecar_mcl {

PanoramaCache::PanoramaCache(std::size_t bytes, int directions)
    : stride_(static_cast<std::size_t>(directions)),
      slots_(bytes / (sizeof(Slot) + stride_ * sizeof(std::uint16_t)) / kWays * kWays),
      ranges_(new std::uint16_t[slots_.size() * stride_]) {}

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
