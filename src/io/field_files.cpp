#include "burnish/io/field_files.h"

#include <fmt/format.h>

#include <array>

#include "burnish/core/error.h"
#include "burnish/io/vdb.h"
#include "cell_stream.h"
#include "suffix.h"

namespace burnish {
namespace detail {
namespace {

template <class T>
void pack_as(const double* values, std::size_t count, char* bytes) {
  for (std::size_t i = 0; i < count; ++i) {
    const T value = static_cast<T>(values[i]);
    std::memcpy(bytes + i * sizeof value, &value, sizeof value);
  }
}

// Bit k moves to bit 3k.
std::uint64_t spread(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x001f00000000ffffull;
  v = (v | v << 16) & 0x001f0000ff0000ffull;
  v = (v | v << 8) & 0x100f00f00f00f00full;
  v = (v | v << 4) & 0x10c30c30c30c30c3ull;
  return (v | v << 2) & 0x1249249249249249ull;
}

std::int32_t gather(std::uint64_t v) {
  v &= 0x1249249249249249ull;
  v = (v | v >> 2) & 0x10c30c30c30c30c3ull;
  v = (v | v >> 4) & 0x100f00f00f00f00full;
  v = (v | v >> 8) & 0x001f0000ff0000ffull;
  v = (v | v >> 16) & 0x001f00000000ffffull;
  return static_cast<std::int32_t>((v | v >> 32) & 0x1fffff);
}

}  // namespace

std::string_view vtk_name(NumberType type) {
  return type == NumberType::float32 ? "Float32" : type == NumberType::int64 ? "Int64" : "UInt8";
}

std::size_t size_of(NumberType type) { return type == NumberType::float32 ? 4 : type == NumberType::int64 ? 8 : 1; }

void pack(NumberType type, const double* values, std::size_t count, char* bytes) {
  switch (type) {
    case NumberType::float32: return pack_as<float>(values, count, bytes);
    case NumberType::int64: return pack_as<std::int64_t>(values, count, bytes);
    case NumberType::uint8: return pack_as<std::uint8_t>(values, count, bytes);
  }
}

std::string vtu_opening(std::size_t points, std::size_t cells) {
  return fmt::format("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
                     "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n  <UnstructuredGrid>\n"
                     "    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
                     points, cells);
}

std::uint64_t morton_key(const LatticePoint& p) {
  const auto bits = [](std::int32_t v) { return spread(static_cast<std::uint64_t>(v)); };
  return bits(p[0]) | bits(p[1]) << 1 | bits(p[2]) << 2;
}

LatticePoint morton_point(std::uint64_t key) { return {gather(key), gather(key >> 1), gather(key >> 2)}; }

std::vector<LatticeCube> cubes_of(const CellGrid& grid, std::size_t begin, std::size_t end) {
  std::vector<LatticeCube> cubes(end - begin);
  grid.cubes(begin, cubes);
  return cubes;
}

int smallest_level(const CellGrid& grid, const std::string& label) {
  const int level = parallel_reduce(
      grid.count, kRange, grid.depth,
      [&](std::size_t begin, std::size_t end) {
        int least = grid.depth;
        for (const LatticeCube& cube : cubes_of(grid, begin, end)) least = std::min(least, static_cast<int>(cube.level));
        return least;
      },
      [](int a, int b) { return std::min(a, b); });
  // The domain's upper walls take one bit more.
  if (grid.depth - level >= kMaxKeyBits)
    throw Error(ErrorCode::memory_limit,
                fmt::format("{}: the domain is 2^{} of its smallest cells wide; at most 2^{} can be written", label, grid.depth - level,
                            kMaxKeyBits - 1),
                "choose a larger cell, or write blocks");
  return level;
}

}  // namespace detail

std::string_view name(FieldFormat format) {
  constexpr std::array<std::string_view, 5> names{".vtu", ".htg", ".vti", ".nrrd", ".vdb"};
  return names[static_cast<std::size_t>(format)];
}

FieldFormat field_format_for_writing(const std::string& path) {
  const std::string suffix = suffix_of(path);
  for (const FieldFormat format : {FieldFormat::vtu, FieldFormat::htg, FieldFormat::vti, FieldFormat::nrrd, FieldFormat::vdb}) {
    if (suffix != name(format)) continue;
    if (format == FieldFormat::vdb) require_openvdb(path);
    return format;
  }
  throw Error(ErrorCode::usage, fmt::format("{}: the suffix does not say which format to write", path),
              "use .vtu (cells and nodes), .htg (the tree), .vti or .nrrd (a uniform grid), or .vdb (OpenVDB)");
}

std::uint64_t bytes_to_write_field(std::size_t cubes, FieldFormat format) {
  // .vtu: keys of points, twice while they are sorted, and before copies are gone. .htg: keys of octants, an eighth of them inner.
  constexpr std::uint64_t kBatches = std::uint64_t{64} << 20;
  return kBatches + cubes * std::uint64_t{format == FieldFormat::vtu ? 32u : 20u};
}

WrittenField write_field(int fd, const std::string& label, const CellGrid& grid, FieldFormat format, Progress& progress) {
  return format == FieldFormat::vtu ? detail::write_vtu(fd, label, grid, progress) : detail::write_htg(fd, label, grid, progress);
}

}  // namespace burnish
