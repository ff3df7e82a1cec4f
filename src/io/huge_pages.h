// Large arrays on large pages: faulting in 4 KiB at a time is most of the cost of reading a binary STL.
#pragma once

#include <cstddef>
#include <vector>

namespace burnish {

// Asks the system to back [start, start + size) by huge pages. A hint: it may be ignored, and nothing
// but speed depends on it. Small ranges are left alone.
void advise_huge_pages(void* start, std::size_t size);

// values.reserve(count), on huge pages. Pages that are never written are never there.
template <class T>
void reserve_on_huge_pages(std::vector<T>& values, std::size_t count) {
  values.reserve(count);
  advise_huge_pages(values.data() + values.size(), (values.capacity() - values.size()) * sizeof(T));
}

}  // namespace burnish
