// The readers behind read_mesh, one per format. Each throws through its Source.
#pragma once

#include "burnish/io/mesh_io.h"
#include "source.h"

namespace burnish {

// Facets a soup may have when each brings three points: corners are numbered with 32 bits.
inline constexpr std::size_t kMaxFacets = 0xffffffffu / 3;

MeshFile read_stl_binary(const Source& source);
MeshFile read_stl_ascii(const Source& source);
MeshFile read_obj(const Source& source);
MeshFile read_ply(const Source& source);
MeshFile read_off(const Source& source);
MeshFile read_3mf(const Source& source);  // any ZIP archive: refuses those that are no 3MF

}  // namespace burnish
