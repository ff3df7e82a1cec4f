// A set of a few numbers that is emptied in no time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace burnish::denoising {

// Open addressing. Slots are a power of two, and more than the numbers that are ever in the set.
template <std::size_t kSlots>
class StampedSet {
  static_assert(kSlots > 0 && (kSlots & (kSlots - 1)) == 0);

 public:
  void clear() {
    if (++stamp_ == 0) {
      std::fill(stamps_.begin(), stamps_.end(), 0);
      stamp_ = 1;
    }
  }
  // False: it is there already.
  bool insert(std::uint32_t key) {
    std::size_t at = (key * 2654435761u >> 7) & kMask;
    while (stamps_[at] == stamp_ && keys_[at] != key) at = (at + 1) & kMask;
    if (stamps_[at] == stamp_) return false;
    stamps_[at] = stamp_;
    keys_[at] = key;
    return true;
  }

 private:
  static constexpr std::size_t kMask = kSlots - 1;
  std::vector<std::uint32_t> stamps_ = std::vector<std::uint32_t>(kSlots, 0), keys_ = std::vector<std::uint32_t>(kSlots, 0);
  std::uint32_t stamp_ = 1;
};

}  // namespace burnish::denoising
