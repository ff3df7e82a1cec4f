// What the names of files end in: for completion and the manuals. Readers and writers judge files themselves (io);
// tests/cli holds each of these against them.
#pragma once

#include <string_view>
#include <vector>

namespace burnish {

using Suffixes = std::vector<std::string_view>;

inline const Suffixes kSurfaceInputs = {".stl", ".stla", ".stlb", ".obj", ".ply", ".off", ".3mf"};
inline const Suffixes kSurfaceOrVolumeInputs = {".stl", ".stla", ".stlb", ".obj", ".ply", ".off", ".3mf", ".vti", ".nrrd", ".nhdr"};
inline const Suffixes kRegionInputs = {".txt", ".stl", ".stla", ".stlb", ".obj", ".ply", ".off", ".3mf"};
inline const Suffixes kSurfaceOutputs = {".stl", ".stla", ".ply", ".obj", ".off", ".3mf"};
inline const Suffixes kMarkedOutputs = {".vtp", ".ply"};
inline const Suffixes kFieldOutputs = {".vtu", ".htg", ".vti", ".nrrd", ".vdb"};
inline const Suffixes kMeshOutputs = {".vtu", ".msh", ".su2", ".cgns"};  // besides the folder of a case
inline const Suffixes kReports = {".json"};
inline const Suffixes kPages = {".html"};

}  // namespace burnish
