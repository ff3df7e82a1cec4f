// What the steps of sharpening pass on: an extracted surface on its way to the reference surface.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/core/union_find.h"
#include "burnish/extract/reference_surface.h"
#include "burnish/extract/sharpen.h"

namespace burnish::detail {

struct SharpenMesh {
  std::vector<Facet> facets;
  // Per vertex.
  std::vector<Vec3> start;           // on M
  std::vector<Vec3> target;          // on S; `start` for what stays
  std::vector<std::uint32_t> sheet;  // facet of S at the target, of either side on a crease; kNoFacet: the vertex stays
  std::vector<SharpenedKind> kind;
  std::vector<std::array<std::uint32_t, 2>> parents;

  bool stays(std::uint32_t v) const { return sheet[v] == kNoFacet; }
  bool on_crease(std::uint32_t v) const { return kind[v] != SharpenedKind::smooth; }
  bool has_fixed_corner(const Facet& f) const { return stays(f[0]) || stays(f[1]) || stays(f[2]); }
};

inline bool is_gone(const Facet& f) { return f[0] == f[1]; }

// The facets around each vertex, ascending; those that are gone are around none.
class FacetsAround {
 public:
  FacetsAround(const std::vector<Facet>& facets, std::size_t vertices) : first_(vertices + 1, 0), at_(3 * facets.size()) {
    for (const Facet& f : facets)
      if (!is_gone(f))
        for (const std::uint32_t v : f) ++first_[v];
    exclusive_scan_in_place(first_);
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t f = 0; f < facets.size(); ++f)
      if (!is_gone(facets[f]))
        for (const std::uint32_t v : facets[f]) at_[next[v]++] = f;
  }
  std::span<const std::uint32_t> operator[](std::uint32_t v) const { return {at_.data() + first_[v], first_[v + 1] - first_[v]}; }

 private:
  std::vector<std::uint32_t> first_, at_;
};

// The sine of the smallest angle: twice the area over the product of the two longer sides. [T-SHARP-4]
inline double least_sine(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double x = squared_norm(b - a), y = squared_norm(c - b), z = squared_norm(a - c);
  const double longer = x * y * z / std::min({x, y, z});
  return longer > 0 ? norm(cross(b - a, c - a)) / std::sqrt(longer) : 0;
}

// The direction that a facet should face: S's where its vertices are, but for those on creases; zero if all are.
Vec3 facing_of(const SharpenMesh& mesh, const ReferenceSurface& s, const Facet& f);

// Step 2: crossed edges, corners and crease vertices; then cuts what is still crossed. Returns the number of cuts.
struct Crossing {
  std::array<std::uint32_t, 2> points{};  // lower index first
  Vec3 at;                                // on the crease
};
std::vector<Crossing> embed_creases(SharpenMesh& mesh, const ReferenceSurface& s, const SharpenOptions& options, Progress& progress);
void cut_edges(SharpenMesh& mesh, const std::vector<Crossing>& crossings);

// Chains of crease vertices that run to and fro along a crease, as ragged tips of wedges make them, run one way only.
void unfold_creases(SharpenMesh& mesh, const ReferenceSurface& s);

// Step 3: changes facets, points, `target` and `sheet`; facets that are gone become {0, 0, 0}. Facets that one flip or collapse has changed are united in `edits`.
void improve_shape(SharpenMesh& mesh, std::vector<Vec3>& points, UnionFind& edits, const ReferenceSurface& s, Progress& progress);

// Step 4: takes points that are at their targets back where facets are turned over. True if there are none.
bool take_back(const SharpenMesh& mesh, std::vector<Vec3>& points, const ReferenceSurface& s, Progress& progress);

}  // namespace burnish::detail
