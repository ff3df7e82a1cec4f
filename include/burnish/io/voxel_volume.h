// VoxelVolume: numbers on a uniform grid, and the files that hold them: .vti (VTK ImageData), .nrrd.
//
// What tomography delivers, and what image tools and solvers read. Values are at the grid's nodes, x fastest. Axes are parallel to the coordinate axes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/core/vec.h"

namespace burnish {

enum class VoxelType : std::uint8_t { uint8, int8, uint16, int16, uint32, int32, uint64, int64, float32, float64 };

std::string_view name(VoxelType type);  // "uint8" ... "float64"

struct VoxelVolume {
  std::array<std::uint32_t, 3> nodes{};  // along x, y, z
  Vec3 origin;                           // of node (0, 0, 0)
  Vec3 spacing{1, 1, 1};                 // positive
  std::string name;                      // of the array, if the file says
  VoxelType type = VoxelType::float32;   // of the file; values below hold those of up to 16 bits and float32 exactly, others rounded
  std::vector<float> values;

  std::size_t size() const { return std::size_t{nodes[0]} * nodes[1] * nodes[2]; }
};

// Reads a .vti (XML; one piece; ascii, base64 inline, appended raw or base64; zlib or no compression; UInt32 or UInt64 headers; both byte orders; PointData;
// CellData become nodes at cell centres) or a .nrrd, .nhdr (attached or detached data; raw, gzip, ascii encodings; both byte orders; `spacings`, `space
// directions` along the axes, or `axis mins` and `axis maxs`, which are samples unless `centers` says cell; three axes, or four with one of length 1). Axes that
// run backwards are turned round. Spacings are within 1e-60 to 1e60, and at least 2^-40 of the largest coordinate: all else is an error. `array`: which of several; empty: the active
// scalars, else the first of one component. Values may be NaN or infinite: whoever uses them has to look.
// Sizes in the file are believed only as far as its bytes can hold them. Throws Error{unreadable_input} with the place, what was expected and what was found;
// Error{memory_limit} if the values do not fit into `memory` bytes; Error{interrupted}.
VoxelVolume read_voxels(const std::string& path, const std::string& array = {}, std::uint64_t memory = UINT64_MAX, Progress& progress = no_progress());
// The same of bytes in memory, whose format `label`'s suffix tells; data that stand in another file are an error.
VoxelVolume read_voxels(std::span<const std::byte> bytes, const std::string& label, const std::string& array = {}, std::uint64_t memory = UINT64_MAX,
                        Progress& progress = no_progress());

// True if the path's suffix is one that read_voxels knows.
bool is_voxel_file(const std::string& path);

enum class VoxelFormat : std::uint8_t { vti, nrrd };

// A volume to be written: `fill` computes the nodes of a slab of z-layers [first, last), is called in order and may use all threads itself.
struct VoxelSource {
  std::array<std::uint32_t, 3> nodes{};
  Vec3 origin, spacing{1, 1, 1};
  std::string name = "phi";
  std::function<void(std::uint32_t first_layer, std::uint32_t last_layer, std::span<float> values)> fill;
};

// About the memory that writing a volume of so many nodes takes: slabs of 16 MB, or of one layer if that is more, and compressed pieces.
std::uint64_t bytes_to_write_voxels(const std::array<std::uint32_t, 3>& nodes);

// Writes float32: .vti appended raw with zlib, .nrrd attached with gzip. `fd` must be able to seek and stays open. Same bytes for any number of threads.
// Throws Error{unwritable_output} naming `label`; Error{interrupted}.
void write_voxels(int fd, const std::string& label, const VoxelSource& source, VoxelFormat format, Progress& progress = no_progress());

}  // namespace burnish
