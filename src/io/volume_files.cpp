// Which format a path asks for; and an OpenFOAM case as a whole.
#include "burnish/io/volume_files.h"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "burnish/core/error.h"
#include "burnish/io/output_file.h"
#include "foam_case_files.h"
#include "foam_file.h"
#include "folder_swap.h"
#include "suffix.h"
#include "system_hint.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;

// What belongs to one mesh and to no other, in a polyMesh folder; plain or gzipped.
constexpr std::array<std::string_view, 22> kOfAMesh{
    "points", "faces", "owner", "neighbour", "boundary", "cells", "cellZones", "faceZones", "pointZones", "sets", "cellLevel", "pointLevel", "level0Edge", "surfaceIndex", "refinementHistory",
    "meshModifiers", "parallelData", "boundaryProcAddressing", "cellProcAddressing", "faceProcAddressing", "pointProcAddressing", "cellMap"};

bool belongs_to_a_mesh(std::string name) {
  if (name.ends_with(".gz")) name.resize(name.size() - 3);
  return std::find(kOfAMesh.begin(), kOfAMesh.end(), name) != kOfAMesh.end() || (name.starts_with(".") && name.ends_with(".tmp"));
}

[[noreturn]] void fail_exists(const std::string& path) {
  throw Error(ErrorCode::unwritable_output, path + ": exists: the case has a mesh already", "pass --overwrite to replace the mesh of this case, or name another folder");
}

void require_free(const std::string& poly_mesh, const std::vector<std::string>& later) {
  std::error_code ignored;
  for (fs::directory_iterator entry(poly_mesh, ignored), end; entry != end; entry.increment(ignored))
    if (belongs_to_a_mesh(entry->path().filename().string())) fail_exists(entry->path().string());
  if (!later.empty()) fail_exists(later.front());
}

// What is no part of a mesh, such as the blockMeshDict of earlier versions of OpenFOAM, is in the new folder as well.
void keep_others(const std::string& from, const std::string& to) {
  std::error_code error;
  for (fs::directory_iterator entry(from, error), end; !error && entry != end; entry.increment(error)) {
    if (belongs_to_a_mesh(entry->path().filename().string())) continue;
    fs::copy(entry->path(), fs::path(to) / entry->path().filename(), fs::copy_options::recursive | fs::copy_options::copy_symlinks, error);
    if (error) throw Error(ErrorCode::unwritable_output, fmt::format("{}: cannot be kept: {}", entry->path().string(), error.message()), "move it out of the case, or name another folder");
  }
}

// Meshes in time folders, which programs would read instead.
std::vector<std::string> later_meshes(const std::string& case_folder) {
  std::vector<std::string> folders;
  std::error_code ignored;
  for (const std::string& time : time_folders(case_folder))
    if (std::string folder = fmt::format("{}/{}/polyMesh", case_folder, time); fs::is_directory(folder, ignored)) folders.push_back(std::move(folder));
  return folders;
}

// Those of a case that files will be made in, as far as they are there.
void require_writable_folders(const std::string& case_folder) {
  std::error_code ignored;
  for (const char* name : {"", "/constant", "/0", "/system"}) {
    const std::string folder = case_folder + name;
    if (!fs::exists(folder, ignored)) continue;
    if (!fs::is_directory(folder, ignored)) throw Error(ErrorCode::unwritable_output, folder + ": is no folder", "a case has a folder of that name: move the file, or name another folder");
    if (::access(folder.c_str(), W_OK | X_OK) != 0) throw Error(ErrorCode::unwritable_output, folder + ": cannot be written into: " + std::strerror(errno), write_hint(errno));
  }
}

}  // namespace

VolumeFormat volume_format(const std::string& path) {
  std::error_code ignored;
  const std::string suffix = suffix_of(path);
  if (suffix.empty() || fs::is_directory(path, ignored)) return VolumeFormat::foam_case;
  if (suffix == ".vtu") return VolumeFormat::vtu;
  if (suffix == ".msh") return VolumeFormat::msh;
  if (suffix == ".su2") return VolumeFormat::su2;
  if (suffix == ".cgns") return VolumeFormat::cgns;
  throw Error(ErrorCode::usage, path + ": the suffix does not say which format to write", "use .vtu (VTK), .msh (gmsh), .su2 (SU2), .cgns (CGNS), or a folder (an OpenFOAM case)");
}

void write_foam_case(const std::string& case_folder, const VolumeMesh& mesh, const VolumeWriteOptions& options, Progress& progress) {
  const std::string poly_mesh = case_folder + "/constant/polyMesh";
  const std::vector<std::string> later = later_meshes(case_folder);
  if (!options.overwrite) require_free(poly_mesh, later);
  FolderSwap fresh(poly_mesh);
  write_poly_mesh(fresh.folder(), mesh.mesh, options.foam, progress);
  keep_others(fresh.destination(), fresh.folder());
  if (!FoamFile::exists(case_folder + "/system/controlDict")) write_case_files(case_folder, mesh.mesh);
  for (const std::string& folder : later) remove_folder(folder);
  fresh.commit();
}

void require_writable(const std::string& path, const VolumeWriteOptions& options) {
  if (volume_format(path) == VolumeFormat::cgns) require_cgns(path);
  if (volume_format(path) != VolumeFormat::foam_case) {
    const OutputFile probe(path, options.overwrite);
    return;
  }
  const std::string poly_mesh = path + "/constant/polyMesh";
  if (!options.overwrite) require_free(poly_mesh, later_meshes(path));
  require_writable_folders(path);
  const FolderSwap probe(poly_mesh);
}

void write_volume_mesh(const std::string& path, const VolumeMesh& mesh, const VolumeWriteOptions& options, Progress& progress) {
  switch (volume_format(path)) {
    case VolumeFormat::foam_case: return write_foam_case(path, mesh, options, progress);
    case VolumeFormat::vtu: return write_vtu(path, mesh, options, progress);
    case VolumeFormat::msh: return write_msh(path, mesh, options, progress);
    case VolumeFormat::su2: return write_su2(path, mesh, options, progress);
    case VolumeFormat::cgns: return write_cgns(path, mesh, options, progress);
  }
}

}  // namespace burnish
