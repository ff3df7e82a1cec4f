// Arrays of numbers in files of voxels: from bytes of any type, order and encoding to floats.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "burnish/core/progress.h"
#include "burnish/io/voxel_volume.h"
#include "source.h"

namespace burnish::detail {

inline constexpr std::string_view kVoxelHint = "export the volume again; .vti and .nrrd with raw or zlib data are read";

inline constexpr double kLargestLength = 1e60;  // of a spacing, or to an origin
inline constexpr double kLeastLength = 1e-60;   // of a spacing

struct NumberLayout {
  VoxelType type = VoxelType::float32;
  bool big_endian = false;
};

std::size_t size_of(VoxelType type);

// The most bytes that deflate makes of one, rounded up: sizes that promise more are wrong.
inline constexpr std::uint64_t kMostInflation = 1040;

// Product of the sizes. Throws Error{unreadable_input} if one is zero or `bytes`, of which `per_number` hold a number at least, are too few for it, and
// Error{memory_limit} beyond `memory` bytes of floats.
std::size_t checked_count(const Source& source, const std::array<std::uint32_t, 3>& nodes, double bytes, double per_number, std::uint64_t memory);

// `to.size()` numbers from at least as many times their size of bytes.
void unpack(NumberLayout layout, const char* bytes, std::span<float> to);

// From raw bytes, which may be more than are needed. All these throw Error{unreadable_input} for too few.
void read_raw(const Source& source, std::string_view bytes, NumberLayout layout, std::span<float> to);
// From a gzip or zlib stream, of several members perhaps, of which the first `skip` bytes are left out.
void read_deflated(const Source& source, std::string_view stream, NumberLayout layout, std::uint64_t skip, std::span<float> to, Progress& progress);
// From words separated by blanks or commas.
void read_words(const Source& source, std::string_view text, std::span<float> to, Progress& progress);

// The first `most` bytes of a base64 text, fewer if it ends. Blanks are skipped; padding may stand inside, where texts have been joined.
std::string decode_base64(std::string_view text, std::size_t most);

// Throws Error{unreadable_input} if coordinates do not tell the nodes apart: spacings beyond the limits above, or too small beside the origin.
void require_places(const Source& source, const VoxelVolume& volume);

// Turns the values round along an axis.
void reverse_axis(VoxelVolume& volume, std::size_t axis);

VoxelVolume read_vti(const Source& source, const std::string& array, std::uint64_t memory, Progress& progress);
// `folder`: where detached data are looked for; unset: nowhere.
VoxelVolume read_nrrd(const Source& source, const std::optional<std::string>& folder, std::uint64_t memory, Progress& progress);

}  // namespace burnish::detail
