#include "flow_mesh_patches.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "burnish/core/error.h"
#include "burnish/surface/weld.h"

namespace burnish {
namespace {

constexpr std::string_view kNameless = "surface";

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_of_word(char c) { return is_letter(c) || is_digit(c) || c == '.' || c == '-' || c == '+'; }

std::string unique(const std::string& word, std::set<std::string>& taken) {
  std::string name = word;
  for (int i = 2; !taken.insert(name).second; ++i) name = fmt::format("{}_{}", word, i);
  return name;
}

}  // namespace

std::string foam_word(std::string_view text) {
  std::string word;
  for (const char c : text) {
    // Of a run of others, such as the bytes of one letter, one stays.
    if (is_of_word(c))
      word += c;
    else if (word.empty() || word.back() != '_')
      word += '_';
  }
  while (word.size() > 1 && word.back() == '_') word.pop_back();
  if (word.empty() || word == "_") return std::string(kNameless);
  return is_letter(word.front()) ? word : "_" + word;
}

SurfacePatches surface_patches(const TriangleSoup& soup, bool one) {
  if (one || soup.groups.empty()) return {{}, {std::string(kNameless)}, {""}};
  SurfacePatches patches;
  std::set<std::string> taken(std::begin(kDomainPatches), std::end(kDomainPatches));
  patches.of_facet.resize(soup.facets.size());
  for (const FacetGroup& group : soup.groups) {
    const auto first = patches.of_facet.begin() + group.first_facet;
    std::fill(first, first + group.facet_count, static_cast<std::uint32_t>(patches.names.size()));
    patches.names.push_back(unique(foam_word(group.name), taken));
    patches.groups.push_back(group.name);
  }
  return patches;
}

void set_patch_types(const std::vector<std::pair<std::string, std::string>>& types, std::vector<MeshPatch>& patches) {
  for (const auto& [name, type] : types) {
    const auto at = std::find_if(patches.begin(), patches.end(), [&](const MeshPatch& p) { return p.name == name; });
    if (at == patches.end()) {
      std::vector<std::string> names;
      for (const MeshPatch& p : patches) names.push_back(p.name);
      throw Error(ErrorCode::usage, fmt::format("the mesh has no patch {}: its patches are {}", name, fmt::join(names, ", ")), "name one of these");
    }
    at->type = type;
  }
}

TriangleSoup triangles_of(const PolyhedralMesh& mesh, const std::vector<std::string>& patches) {
  TriangleSoup soup{mesh.points, {}, {}};
  for (const MeshPatch& patch : mesh.patches) {
    if (std::find(patches.begin(), patches.end(), patch.name) == patches.end()) continue;
    for (std::size_t f = patch.first_face; f < std::size_t{patch.first_face} + patch.faces; ++f) {
      const auto points = mesh.face(f);
      for (std::size_t i = 2; i < points.size(); ++i) soup.facets.push_back({points[0], points[i - 1], points[i]});
    }
  }
  return weld(std::move(soup));
}

}  // namespace burnish
