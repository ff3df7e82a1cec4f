#include "huge_pages.h"

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>

namespace burnish {

void advise_huge_pages(void* start, std::size_t size) {
  constexpr std::uintptr_t kPage = 4096;
  constexpr std::size_t kWorthIt = std::size_t{8} << 20;
  if (size < kWorthIt) return;
  const std::uintptr_t first = reinterpret_cast<std::uintptr_t>(start);
  const std::uintptr_t begin = (first + kPage - 1) & ~(kPage - 1), end = (first + size) & ~(kPage - 1);
  static_cast<void>(::madvise(static_cast<std::byte*>(start) + (begin - first), end - begin, MADV_HUGEPAGE));
}

}  // namespace burnish
