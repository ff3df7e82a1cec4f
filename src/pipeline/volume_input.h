// An input that is a volume of numbers, and the surface on which they have a given value.
#pragma once

#include <cstdint>
#include <string>

#include "burnish/core/progress.h"
#include "burnish/io/voxel_volume.h"
#include "burnish/levelset/from_voxels.h"
#include "burnish/pipeline/options.h"
#include "burnish/pipeline/report.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

class VolumeInput {
 public:
  // Reads the volume and chooses the value. Tells report.input_format and .volume. Throws Error as `read_voxels` does, and Error{usage} where no value was given, or
  // one beyond those of the volume.
  VolumeInput(const std::string& path, const VolumeOptions& options, std::uint64_t memory, RepairReport& report, Progress& progress);

  // Side of the lattice's cells, in model units.
  double cell() const { return cell_of(samples()); }
  // A segmentation: its surface is a staircase.
  bool is_binary() const { return is_binary_; }
  LevelSetFromVoxels level_set(double band, double room, Progress& progress) const;
  // The surface in model units: closed, oriented, and of the volume's topology. Tells report.volume, and warns of a solid that had to be closed.
  TriangleSoup surface(RepairReport& report, Progress& progress) const;

 private:
  VoxelSamples samples() const { return {volume_.nodes, volume_.origin, volume_.spacing, volume_.values}; }
  double chosen_iso(const std::string& path, const VolumeOptions& options, const ValueRange& range) const;

  VoxelVolume volume_;
  std::uint64_t memory_ = 0;  // budget, beside the values
  double iso_ = 0;
  bool below_ = false, is_binary_ = false;
};

// Whether the input is a volume, by its name. Throws Error{usage} where the options say otherwise.
bool is_volume(const std::string& path, const VolumeOptions& options);

}  // namespace burnish
