#include "volume_input.h"

#include <fmt/format.h>

#include <utility>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/extract/marching_tetrahedra.h"
#include "resolve_options.h"

namespace burnish {
namespace {

// Of a path that is_voxel_file knows.
std::string format_of(const std::string& path) { return path.ends_with('i') || path.ends_with('I') ? "vti" : "nrrd"; }

}  // namespace

bool is_volume(const std::string& path, const VolumeOptions& options) {
  if (is_voxel_file(path)) return true;
  if (options.any())
    throw Error(ErrorCode::usage, fmt::format("{}: expected a volume, whose name ends in .vti, .nrrd or .nhdr", path), "leave out --from-field, --iso, --below and --array for a surface");
  return false;
}

VolumeInput::VolumeInput(const std::string& path, const VolumeOptions& options, std::uint64_t memory, RepairReport& report, Progress& progress)
    : volume_(read_voxels(path, options.array, memory, progress)), memory_(memory - volume_.values.size() * sizeof(float)), below_(options.below) {
  report.input_format = format_of(path);
  ValueRange range;
  try {
    range = value_range(samples());
  } catch (const Error& error) {
    throw Error(error.code(), path + ": " + error.what(), error.hint());
  }
  iso_ = chosen_iso(path, options, range);
  is_binary_ = has_two_values(samples(), range);
  report.volume = VolumeSummary{volume_.name, std::string(name(volume_.type)), volume_.nodes, volume_.spacing, range.least, range.most, iso_, options.iso_auto, below_, 0};
}

double VolumeInput::chosen_iso(const std::string& path, const VolumeOptions& options, const ValueRange& range) const {
  const std::string values = fmt::format("values are from {:.6g} to {:.6g}", range.least, range.most);
  if (!(range.least < range.most)) throw Error(ErrorCode::guarantee_unmet, fmt::format("{}: all values are {:.6g}: there is no surface", path, range.least), "choose another --array");
  if (options.iso_auto) return otsu_threshold(samples(), range);
  if (!options.iso)
    throw Error(ErrorCode::usage, fmt::format("{}: {}: expected --iso V, the value on the surface", path, values),
                fmt::format("--iso auto takes Otsu's threshold, {:.6g} here", otsu_threshold(samples(), range)));
  const double iso = *options.iso;
  if (below_ ? iso > range.least && iso <= range.most : iso >= range.least && iso < range.most) return iso;
  throw Error(ErrorCode::usage, fmt::format("{}: --iso {:.6g}: {}, so nothing, or everything, would be inside", path, iso, values), "give a value between");
}

LevelSetFromVoxels VolumeInput::level_set(double band, double room, Progress& progress) const {
  return level_set_from_voxels(samples(), iso_, !below_, {.band = band, .room = room, .memory_bytes = memory_}, progress);
}

TriangleSoup VolumeInput::surface(RepairReport& report, Progress& progress) const {
  const LevelSetFromVoxels found = level_set(kUnsmoothedBand, 0, progress);
  report.volume->border_voxels = found.border_voxels;
  if (found.border_voxels > 0)
    report.warnings.push_back(fmt::format("the solid runs off the volume at {} of its border voxels, and was closed there", found.border_voxels));
  TriangleSoup soup = extract_surface(found.level_set, {}, progress).soup;
  parallel_for(soup.points.size(), [&](std::size_t p) { soup.points[p] = found.level_set.frame.to_model(soup.points[p]); });
  return soup;
}

}  // namespace burnish
