#include "flow_mesh_patches.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <span>

#include "burnish/core/error.h"
#include "burnish/surface/weld.h"
#include "../io/patch_names.h"

namespace burnish {
namespace {

constexpr std::string_view kNameless = "surface";

}  // namespace

SurfacePatches surface_patches(const TriangleSoup& soup, bool one, MeshSide side) {
  if (one || soup.groups.empty()) return {{}, {std::string(kNameless)}, {""}};
  SurfacePatches patches;
  patches.of_facet.resize(soup.facets.size());
  // The domain's names come first, so that no other gets one of them.
  std::vector<MeshPatch> named;
  if (side == MeshSide::outside)
    for (const std::string_view name : kDomainPatches) named.push_back({std::string(name), "patch"});
  const auto sides = static_cast<std::ptrdiff_t>(named.size());
  for (const FacetGroup& group : soup.groups) {
    const auto first = patches.of_facet.begin() + group.first_facet;
    std::fill(first, first + group.facet_count, static_cast<std::uint32_t>(patches.groups.size()));
    named.push_back({group.name.empty() ? std::string(kNameless) : group.name, "wall"});
    patches.groups.push_back(group.name);
  }
  patches.names = patch_names(named);
  patches.names.erase(patches.names.begin(), patches.names.begin() + sides);
  return patches;
}

void require_one_type_each(const std::vector<std::pair<std::string, std::string>>& types) {
  std::map<std::string, std::string> type_of;
  for (const auto& [name, type] : types)
    if (const auto at = type_of.try_emplace(name, type).first; at->second != type)
      throw Error(ErrorCode::usage, fmt::format("the patch {} is to be of two types, {} and {}", name, at->second, type), "give it one of the two");
}

void set_patch_types(const std::vector<std::pair<std::string, std::string>>& types, std::vector<MeshPatch>& patches) {
  for (const auto& [name, type] : types) {
    const auto at = std::find_if(patches.begin(), patches.end(), [&wanted = name](const MeshPatch& p) { return p.name == wanted; });
    if (at == patches.end()) {
      std::vector<std::string> names;
      names.reserve(patches.size());
      for (const MeshPatch& p : patches) names.push_back(p.name);
      throw Error(ErrorCode::usage, fmt::format("the mesh has no patch {}: its patches are {}", name, fmt::join(names, ", ")), "name one of these");
    }
    at->type = type;
  }
}

TriangleSoup wall_triangles(const PolyhedralMesh& mesh, std::size_t patches) {
  TriangleSoup soup{mesh.points, {}, {}};
  for (const MeshPatch& patch : std::span(mesh.patches).first(patches)) {
    for (std::size_t f = patch.first_face; f < std::size_t{patch.first_face} + patch.faces; ++f) {
      const auto points = mesh.face(f);
      for (std::size_t i = 2; i < points.size(); ++i) soup.facets.push_back({points[0], points[i - 1], points[i]});
    }
  }
  return weld(std::move(soup));
}

}  // namespace burnish
