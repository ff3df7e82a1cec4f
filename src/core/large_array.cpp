#include "burnish/core/large_array.h"

#include <cstdlib>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace burnish::detail {
namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20;
constexpr std::size_t kWorthIt = 4 * kHugePage;

}  // namespace

void* allocate_large(std::size_t bytes) {
  if (bytes < kWorthIt) return ::operator new(bytes);
  const std::size_t rounded = (bytes + kHugePage - 1) / kHugePage * kHugePage;
  void* memory = std::aligned_alloc(kHugePage, rounded);
  if (!memory) throw std::bad_alloc();
#if defined(__linux__)
  static_cast<void>(::madvise(memory, rounded, MADV_HUGEPAGE));  // a hint
#endif
  return memory;
}

void free_large(void* memory, std::size_t bytes) noexcept {
  if (bytes < kWorthIt)
    ::operator delete(memory);
  else
    std::free(memory);
}

}  // namespace burnish::detail
