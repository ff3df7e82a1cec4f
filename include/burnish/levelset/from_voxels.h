// A level set from numbers on a uniform grid: the surface on which they have a given value.
//
// The lattice is the volume's own grid: its nodes are voxels, and the cell is their spacing, the smallest of the three where these differ by more than
// rounding: along the others values are interpolated linearly between voxels. Blocks are stored only near the surface, so a volume of 512^3 whose surface
// has half a million cells takes 0.1 to 0.4 GB beside its values.
//
// Guarantees. With equal spacings each lattice node has the side of its voxel: topology is that of the voxels' signs, by the rule of
// extract/marching_tetrahedra.h. A voxel that is just at the value is outside. Beyond the volume everything is outside: a solid that runs off
// the border is closed half a spacing beyond its last voxels.
//
// Accuracy. Distances beside the surface are those to the zero of the values' interpolant, of high order where they are smooth: 1e-6 cells for a ball of 20
// cells given by its distances; what is extracted from it is of second order (6e-3 cells rms). Where each voxel holds the share of it that is inside, which is
// linear beside the surface and constant beyond, the same ball is off by 0.03 cells rms, and by 0.18 where voxels are 0 or 1: steps of a cell, which
// smoothing takes away (docs/from-volumes.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "burnish/core/progress.h"
#include "burnish/levelset/level_set.h"

namespace burnish {

// Values at nodes, x fastest; not owned.
struct VoxelSamples {
  std::array<std::uint32_t, 3> nodes{};
  Vec3 origin;              // of node (0, 0, 0)
  Vec3 spacing{1, 1, 1};    // positive
  std::span<const float> values;
};

struct ValueRange {
  double least = 0, most = 0;
};

// Whether there are no values but two: a segmentation, whose surface is a staircase.
bool has_two_values(const VoxelSamples& samples, const ValueRange& range);

// Throws Error{unreadable_input} with the place of the first value that is not finite, and for no values at all.
ValueRange value_range(const VoxelSamples& samples);

// Otsu's threshold: of all values that part the volume's in two classes the one that leaves the least variance within these; the middle where several do
// (IEEE Trans. SMC 9, 1979, 62-66). From a histogram of 4096 equal classes between the least and the most value. [T-VOXEL-3]
double otsu_threshold(const VoxelSamples& samples, const ValueRange& range);

struct LevelSetFromVoxels {
  LevelSet level_set;
  std::size_t border_voxels = 0;  // inside, and at the volume's border: where the solid was closed
};

struct VoxelLevelSetOptions {
  double band = 3;  // cells of distance on both sides of the surface
  double room = 0;  // cells beyond the band that store values too, for a surface that will move
  std::uint64_t memory_bytes = UINT64_MAX;  // budget of the level set, beside the values
};

// The signed distance to the surface on which the values are `iso`, positive where they are above it, or below it if `inside_above` is false.
// Throws Error{guarantee_unmet} if no surface lies between the voxels, Error{memory_limit} for a lattice beyond 2^20 blocks a side or a level set beyond the budget,
// Error{interrupted}.
// Values have to be finite (value_range checks that). Same bits for any number of threads.
LevelSetFromVoxels level_set_from_voxels(const VoxelSamples& samples, double iso, bool inside_above, const VoxelLevelSetOptions& options = {},
                                         Progress& progress = no_progress());

// The side of the cells that such a level set has.
double cell_of(const VoxelSamples& samples);

}  // namespace burnish
