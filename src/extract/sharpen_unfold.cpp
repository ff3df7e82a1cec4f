// The lattice tears the tips of wedges into fingers. The line between both sheets follows them, and its closest points on the crease run to and fro.
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "sharpen_mesh.h"

namespace burnish::detail {
namespace {

constexpr int kSweeps = 32;
constexpr double kReach = 3;  // cells

// An edge between two crease vertices with a different sheet on either side.
struct CrestEdge {
  std::array<std::uint32_t, 2> points{}, facets{};  // of M; of S, on both sides
};

class Unfolder {
 public:
  Unfolder(SharpenMesh& mesh, const ReferenceSurface& s) : mesh_(mesh), s_(s) { find_crest(); }

  // [T-SHARP-3]
  void run() {
    std::vector<std::uint32_t> folded = folds();
    for (int sweep = 0; sweep < kSweeps && !folded.empty(); ++sweep) {
      for (const std::uint32_t l : folded) relax(links_[l]);
      folded = folds();
    }
  }

 private:
  struct Half {
    std::array<std::uint32_t, 2> points{};
    std::uint32_t facet = 0;
    auto operator<=>(const Half&) const = default;
  };

  void find_crest() {
    std::vector<Half> halves;
    for (const Facet& f : mesh_.facets) {
      if (mesh_.on_crease(f[0]) + mesh_.on_crease(f[1]) + mesh_.on_crease(f[2]) != 2) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t u = f[i], v = f[(i + 1) % 3], w = f[(i + 2) % 3];
        if (!mesh_.on_crease(u) || !mesh_.on_crease(v) || mesh_.stays(w)) continue;
        halves.push_back({{std::min(u, v), std::max(u, v)}, mesh_.sheet[w]});
      }
    }
    parallel_sort(halves);
    for (std::size_t i = 0; i + 1 < halves.size(); ++i) {
      const Half &a = halves[i], &b = halves[i + 1];
      if (a.points != b.points || s_.sheet(a.facet) == s_.sheet(b.facet)) continue;
      crest_.push_back({a.points, {a.facet, b.facet}});
    }
    link();
  }

  // A vertex with two crest edges, that may move.
  struct Link {
    std::uint32_t vertex = 0;
    std::array<std::uint32_t, 2> neighbours{}, links{kNoFacet, kNoFacet};  // vertices; numbers of their links, if they have any
    std::uint32_t edge = 0;                                                // the first one
    bool settled = false;                                                  // it is where its neighbours want it
  };

  void link() {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> at;  // vertex, edge
    for (std::uint32_t e = 0; e < crest_.size(); ++e)
      for (const std::uint32_t v : crest_[e].points) at.push_back({v, e});
    parallel_sort(at);
    for (std::size_t begin = 0, end = 0; begin < at.size(); begin = end) {
      const std::uint32_t v = at[begin].first;
      while (end < at.size() && at[end].first == v) ++end;
      if (end - begin != 2 || mesh_.kind[v] != SharpenedKind::crease || mesh_.stays(v)) continue;
      const std::uint32_t e = at[begin].second;
      links_.push_back({v, {other_end(e, v), other_end(at[begin + 1].second, v)}, {kNoFacet, kNoFacet}, e, false});
    }
    for (Link& l : links_)
      for (std::size_t i = 0; i < 2; ++i) l.links[i] = link_of(l.neighbours[i]);
  }
  std::uint32_t other_end(std::uint32_t edge, std::uint32_t v) const { return crest_[edge].points[crest_[edge].points[0] == v ? 1 : 0]; }
  std::uint32_t link_of(std::uint32_t v) const {
    const auto l = std::lower_bound(links_.begin(), links_.end(), v, [](const Link& a, std::uint32_t w) { return a.vertex < w; });
    return l != links_.end() && l->vertex == v ? static_cast<std::uint32_t>(l - links_.begin()) : kNoFacet;
  }

  // Where the chain turns back, and the neighbours there. Ascending.
  std::vector<std::uint32_t> folds() const {
    std::vector<std::uint32_t> found;
    for (std::uint32_t i = 0; i < links_.size(); ++i) {
      const Link& l = links_[i];
      const Vec3& p = mesh_.target[l.vertex];
      if (dot(mesh_.target[l.neighbours[0]] - p, mesh_.target[l.neighbours[1]] - p) >= 0) found.insert(found.end(), {l.links[0], i, l.links[1]});
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    if (!found.empty() && found.back() == kNoFacet) found.pop_back();
    return found;
  }

  // Where it goes depends on its neighbours alone.
  void relax(Link& l) {
    if (l.settled) return;
    l.settled = true;
    const auto& sides = crest_[l.edge].facets;
    const Vec3 middle = (mesh_.target[l.neighbours[0]] + mesh_.target[l.neighbours[1]]) * 0.5;
    const ReferenceSurface::Foot foot = s_.closest_between(middle, kReach, sides[0], sides[1]);
    if (!foot.found() || foot.point == mesh_.target[l.vertex]) return;
    mesh_.target[l.vertex] = foot.point;
    for (const std::uint32_t n : l.links)
      if (n != kNoFacet) links_[n].settled = false;
  }

  SharpenMesh& mesh_;
  const ReferenceSurface& s_;
  std::vector<CrestEdge> crest_;
  std::vector<Link> links_;  // ascending vertices
};

}  // namespace

void unfold_creases(SharpenMesh& mesh, const ReferenceSurface& s) { Unfolder(mesh, s).run(); }

}  // namespace burnish::detail
