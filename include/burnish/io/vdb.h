// OpenVDB files (.vdb): a narrow band of signed distances, as film and graphics tools take it: Blender, Houdini, OpenVDB's own programs.
//
// The file has one FloatGrid of class GRID_LEVEL_SET. Values belong to the voxels' index points; index (0, 0, 0) is at `origin`. By OpenVDB's
// convention they are **negative inside**: what `fill` computes is turned round. Voxels nearer to the surface than the half width are active, all
// others hold plus or minus that, the background; beyond the blocks they follow from signs at the band's rim. Pruned; compressed by zlib.
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

// Whether this build can write them: the CMake option BURNISH_WITH_OPENVDB, and libopenvdb-dev.
bool has_openvdb();
// Throws Error{usage} if not, naming the package and other formats.
void require_openvdb(const std::string& path);

inline constexpr std::size_t kVdbBlockVoxels = 512;  // 8 x 8 x 8

struct VdbSource {
  Vec3 origin;            // of index (0, 0, 0), in model units
  double voxel = 1;       // side
  double half_width = 3;  // voxels
  std::string name = "surface";
  // Lower corners of blocks in voxels, multiples of 8, each once. Together they hold every voxel within the half width of the surface.
  std::vector<std::array<std::int32_t, 3>> blocks;
  // The signed distances of a block's voxels, x fastest, in model units, positive inside. Called from several threads.
  std::function<void(std::size_t block, std::span<float> phi)> fill;
};

struct WrittenVdb {
  std::uint64_t active_voxels = 0;
  std::uint64_t blocks = 0;  // that are left in the file
};

// Bytes of memory that writing takes for each block: voxels, and the file, which is put together in memory (about 1 kB a block, held twice).
inline constexpr std::uint64_t kVdbBytesPerBlock = 4500;

// Writes to the open file descriptor `fd` and leaves it open. Same bytes on every run and
// for any number of threads; where OpenVDB draws a random identifier for the file, one computed from the bytes stands.
// Throws what require_openvdb throws; Error{unwritable_output} naming `label`; Error{interrupted}.
WrittenVdb write_vdb(int fd, const std::string& label, const VdbSource& source, Progress& progress = no_progress());

}  // namespace burnish
