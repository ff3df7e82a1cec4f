// Patches of a volume mesh: which facets they are made of, and what they are called.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "burnish/surface/triangle_soup.h"
#include "burnish/volume/polyhedral_mesh.h"

namespace burnish {

// Patches of the domain's sides: no patch of the model is named so.
inline constexpr std::string_view kDomainPatches[] = {"xMin", "xMax", "yMin", "yMax", "zMin", "zMax"};

struct SurfacePatches {
  std::vector<std::uint32_t> of_facet;  // empty: all are of the first
  std::vector<std::string> names;       // words of OpenFOAM, all different
  std::vector<std::string> groups;      // the names that they are made from
};

// One for each group of the soup, or one for all if it has none, or `one`.
SurfacePatches surface_patches(const TriangleSoup& soup, bool one);

// Gives patches their types. Throws Error{usage} for a patch that does not exist, naming those that do.
void set_patch_types(const std::vector<std::pair<std::string, std::string>>& types, std::vector<MeshPatch>& patches);

// The faces of the patches of these names, as triangles, welded.
TriangleSoup triangles_of(const PolyhedralMesh& mesh, const std::vector<std::string>& patches);

}  // namespace burnish
