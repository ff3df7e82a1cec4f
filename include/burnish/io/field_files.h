// CellGrid: the cubes of an octree with values in and between them, and the files a viewer opens to show them.
//
//   .vtu  VTK's XML UnstructuredGrid. Every cube is a voxel (type 11); cubes share the points they have in common, and a
//         point of a small cube may lie in the middle of a large one's face (a hanging node). Values in cubes and at points.
//   .htg  VTK's XML HyperTreeGrid (version 2.0, VTK 9.1 and later): one tree of branch factor 2 whose root is the whole
//         domain, so cubes need no points. Values in cubes, and in the octants that hold them.
//
// Both keep their arrays behind the XML as raw binary, compressed by zlib (level 1) in blocks; sizes are 64-bit. ParaView,
// and VTK's vtkXMLUnstructuredGridReader and vtkXMLHyperTreeGridReader, read them.
//
// A grid has no arrays of its own: it says how to compute ranges of them, and writing asks for a few thousand items at
// a time, on several threads. So memory does not double. Same bytes for any number of threads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/core/vec.h"

namespace burnish {

// Coordinates in units of the finest cell.
using LatticePoint = std::array<std::int32_t, 3>;

// A cube of side 2^level finest cells, at a multiple of its side.
struct LatticeCube {
  LatticePoint corner{};  // lower
  std::int32_t level = 0;
};

enum class NumberType { float32, int64, uint8 };

// Numbers of cubes or of points. `fill` computes one for each item; it is called for ranges, from several threads.
template <class Item>
struct ItemArray {
  std::string name;
  NumberType type = NumberType::float32;
  std::function<void(std::span<const Item>, double*)> fill;
};

struct CellGrid {
  Vec3 origin;      // model coordinates of lattice point (0, 0, 0), the domain's lower corner
  double cell = 1;  // side of the finest cell in model units
  int depth = 0;    // 2^depth finest cells along each side of the domain
  // The cubes are disjoint and in Morton order (x fastest); those of a .htg tile the domain. `cubes` computes those from number `first` on, as many as there
  // is room for.
  std::size_t count = 0;
  std::function<void(std::size_t first, std::span<LatticeCube>)> cubes;
  // A .htg asks for values of larger octants than the cubes, too, namely all that hold some.
  std::vector<ItemArray<LatticeCube>> cell_arrays;
  std::vector<ItemArray<LatticePoint>> point_arrays;  // left out of a .htg
};

// What a field can be written as: cells (vtu, htg: write_field below), values on a uniform grid (vti, nrrd: io/voxel_volume.h), or a narrow
// band of voxels (vdb: io/vdb.h).
enum class FieldFormat { vtu, htg, vti, nrrd, vdb };

inline constexpr bool holds_cells(FieldFormat format) { return format == FieldFormat::vtu || format == FieldFormat::htg; }
inline constexpr bool holds_samples(FieldFormat format) { return format == FieldFormat::vti || format == FieldFormat::nrrd; }

// ".vtu", ".htg", ".vti", ".nrrd", ".vdb".
std::string_view name(FieldFormat format);

// The format that a path's suffix asks for. Throws Error{usage} for any other one, naming the known ones, and
// for .vdb in a build without OpenVDB.
FieldFormat field_format_for_writing(const std::string& path);

// An upper bound of the memory that writing this many cubes takes.
std::uint64_t bytes_to_write_field(std::size_t cubes, FieldFormat format);

struct WrittenField {
  std::size_t cells = 0;
  std::size_t points = 0;  // of a .vtu
  std::size_t octants = 0; // of a .htg: cells, and what holds them
};

// Writes a .vtu or .htg to the open file descriptor `fd`, which must be able to seek, and leaves it open.
// Throws Error{unwritable_output}, naming `label`, when the system refuses bytes; Error{memory_limit} if the domain is wider than
// 2^20 cubes of the smallest size; Error{interrupted}.
// Cost: about 1.5 us of CPU time a cell and 22 bytes of the file for a .vtu, 0.6 us and 6 bytes for a .htg.
WrittenField write_field(int fd, const std::string& label, const CellGrid& grid, FieldFormat format, Progress& progress = no_progress());

}  // namespace burnish
