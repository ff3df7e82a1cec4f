// Patches of a volume mesh: which facets they are made of, and what they are called.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "burnish/surface/triangle_soup.h"
#include "burnish/volume/flow_mesh.h"
#include "burnish/volume/polyhedral_mesh.h"

namespace burnish {

struct SurfacePatches {
  std::vector<std::uint32_t> of_facet;  // empty: all are of the first
  std::vector<std::string> names;       // words of OpenFOAM, all different
  std::vector<std::string> groups;      // the names that they are made from
};

// One for each group of the soup, or one for all if it has none, or `one`. Of a mesh of the outside, none is named like a side of the domain.
SurfacePatches surface_patches(const TriangleSoup& soup, bool one, MeshSide side);

// Throws Error{usage} if a patch is given two different types.
void require_one_type_each(const std::vector<std::pair<std::string, std::string>>& types);

// Gives patches their types. Throws Error{usage} for a patch that does not exist, naming those that do.
void set_patch_types(const std::vector<std::pair<std::string, std::string>>& types, std::vector<MeshPatch>& patches);

// The faces of the first `patches` patches, as triangles, welded.
TriangleSoup wall_triangles(const PolyhedralMesh& mesh, std::size_t patches);

}  // namespace burnish
