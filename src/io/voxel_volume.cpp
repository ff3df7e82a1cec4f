#include "burnish/io/voxel_volume.h"

#include "mapped_file.h"
#include "suffix.h"
#include "voxel_array.h"

namespace burnish {
namespace {

bool is_nrrd(const std::string& suffix) { return suffix == ".nrrd" || suffix == ".nhdr"; }

VoxelVolume read(std::string_view bytes, const std::string& label, const std::optional<std::string>& folder, const std::string& array, std::uint64_t memory,
                 Progress& progress) {
  const Source source{bytes, label};
  const std::string suffix = suffix_of(label);
  if (suffix == ".vti") return detail::read_vti(source, array, memory, progress);
  if (is_nrrd(suffix)) return detail::read_nrrd(source, folder, memory, progress);
  source.fail("not the name of a volume", "give a .vti or a .nrrd");
}

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == path.npos ? std::string() : path.substr(0, slash + 1);
}

}  // namespace

std::string_view name(VoxelType type) {
  switch (type) {
    case VoxelType::uint8: return "uint8";
    case VoxelType::int8: return "int8";
    case VoxelType::uint16: return "uint16";
    case VoxelType::int16: return "int16";
    case VoxelType::uint32: return "uint32";
    case VoxelType::int32: return "int32";
    case VoxelType::uint64: return "uint64";
    case VoxelType::int64: return "int64";
    case VoxelType::float32: return "float32";
    case VoxelType::float64: break;
  }
  return "float64";
}

bool is_voxel_file(const std::string& path) {
  const std::string suffix = suffix_of(path);
  return suffix == ".vti" || is_nrrd(suffix);
}

VoxelVolume read_voxels(const std::string& path, const std::string& array, std::uint64_t memory, Progress& progress) {
  const MappedFile file(path);
  return read(file.bytes(), path, folder_of(path), array, memory, progress);
}

VoxelVolume read_voxels(std::span<const std::byte> bytes, const std::string& label, const std::string& array, std::uint64_t memory, Progress& progress) {
  return read({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, label, std::nullopt, array, memory, progress);
}

}  // namespace burnish
