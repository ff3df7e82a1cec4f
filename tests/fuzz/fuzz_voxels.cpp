// Any bytes at all, read as .vti and as .nrrd: they give a volume of as many values as its sizes say, or a burnish::Error. Anything else is a bug.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "burnish/core/error.h"
#include "burnish/io/voxel_volume.h"

namespace {

constexpr std::uint64_t kMemory = std::uint64_t{1} << 28;

void require(bool promise) {
  if (!promise) std::abort();
}

void check_promises(const burnish::VoxelVolume& volume) {
  require(volume.size() > 0 && volume.values.size() == volume.size());
  require(burnish::is_finite(volume.origin));
  for (int axis = 0; axis < 3; ++axis) require(volume.spacing[axis] > 0 && volume.spacing[axis] < 1e61);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::byte> bytes(reinterpret_cast<const std::byte*>(data), size);
  for (const char* label : {"fuzz.vti", "fuzz.nrrd"}) {
    try {
      check_promises(burnish::read_voxels(bytes, label, {}, kMemory));
    } catch (const burnish::Error& error) {
      require(error.code() == burnish::ErrorCode::unreadable_input || error.code() == burnish::ErrorCode::memory_limit);
    }
  }
  return 0;
}
