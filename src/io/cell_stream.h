// What the writers of .vtu and .htg share: numbers that are computed a range at a time, on several threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/core/progress.h"
#include "burnish/io/field_files.h"
#include "vtk_appended.h"

namespace burnish::detail {

inline constexpr std::size_t kRange = 4096;        // items computed at once
inline constexpr std::size_t kPortion = 64 * kRange;  // items held at once
inline constexpr int kMaxKeyBits = 21;             // of a coordinate in a key

std::string_view vtk_name(NumberType type);
std::size_t size_of(NumberType type);
// Converts to the type's bytes.
void pack(NumberType type, const double* values, std::size_t count, char* bytes);

// The text of a .vtu up to its first array.
std::string vtu_opening(std::size_t points, std::size_t cells);

// Morton order of points with coordinates of up to 21 bits.
std::uint64_t morton_key(const LatticePoint& p);
LatticePoint morton_point(std::uint64_t key);

// Writes an array of `count` items of `bytes` bytes each; `fill(begin, end, to)` computes those of a range.
template <class Fill>
void put_array(VtkAppended& out, std::size_t count, std::size_t bytes, Progress& progress, Fill&& fill) {
  out.begin_array(count * bytes);
  std::vector<char> portion;
  for (std::size_t first = 0; first < count; first += kPortion) {
    progress.check();
    const std::size_t n = std::min(kPortion, count - first);
    portion.resize(n * bytes);
    parallel_ranges(n, kRange, [&](std::size_t begin, std::size_t end) { fill(first + begin, first + end, portion.data() + begin * bytes); });
    out.put(portion.data(), portion.size());
  }
  out.end_array();
}

// The same for an array of the grid: `items(begin, end)` gives a vector of the range's cubes or points.
template <class Item, class Items>
void put_item_array(VtkAppended& out, const ItemArray<Item>& array, std::size_t count, Progress& progress, Items&& items) {
  const std::size_t bytes = size_of(array.type);
  put_array(out, count, bytes, progress, [&](std::size_t begin, std::size_t end, char* to) {
    std::vector<double> values(end - begin);
    array.fill(items(begin, end), values.data());
    pack(array.type, values.data(), values.size(), to);
  });
}

std::vector<LatticeCube> cubes_of(const CellGrid& grid, std::size_t begin, std::size_t end);

// The level of the smallest cubes. Throws Error{memory_limit} if keys cannot number them.
int smallest_level(const CellGrid& grid, const std::string& label);

WrittenField write_vtu(int fd, const std::string& label, const CellGrid& grid, Progress& progress);
WrittenField write_htg(int fd, const std::string& label, const CellGrid& grid, Progress& progress);

}  // namespace burnish::detail
