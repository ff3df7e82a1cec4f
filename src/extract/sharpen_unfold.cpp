// The lattice tears the tips of wedges into fingers. The line between both sheets follows them, and its closest points on the crease run to and fro.
#include <algorithm>
#include <array>
#include <unordered_map>
#include <utility>

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
      for (const std::uint32_t v : folded) relax(v);
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
    std::sort(halves.begin(), halves.end());
    for (std::size_t i = 0; i + 1 < halves.size(); ++i) {
      const Half &a = halves[i], &b = halves[i + 1];
      if (a.points != b.points || s_.sheet(a.facet) == s_.sheet(b.facet)) continue;
      for (const std::uint32_t v : a.points) at_[v].push_back(static_cast<std::uint32_t>(crest_.size()));
      crest_.push_back({a.points, {a.facet, b.facet}});
    }
    for (const auto& e : crest_)
      for (const std::uint32_t v : e.points) vertices_.push_back(v);
    std::sort(vertices_.begin(), vertices_.end());
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
    std::erase_if(vertices_, [&](std::uint32_t v) { return at_.at(v).size() != 2 || mesh_.kind[v] != SharpenedKind::crease || mesh_.stays(v); });
  }

  std::array<std::uint32_t, 2> neighbours(std::uint32_t v) const {
    std::array<std::uint32_t, 2> found{};
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& points = crest_[at_.at(v)[i]].points;
      found[i] = points[0] == v ? points[1] : points[0];
    }
    return found;
  }

  // Vertices whose chain turns back there, and the neighbours of such.
  std::vector<std::uint32_t> folds() const {
    std::vector<std::uint32_t> found;
    for (const std::uint32_t v : vertices_) {
      const auto [a, b] = neighbours(v);
      const Vec3& p = mesh_.target[v];
      if (dot(mesh_.target[a] - p, mesh_.target[b] - p) >= 0) found.insert(found.end(), {a, v, b});
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    std::erase_if(found, [&](std::uint32_t v) { return !std::binary_search(vertices_.begin(), vertices_.end(), v); });
    return found;
  }

  void relax(std::uint32_t v) {
    const auto [a, b] = neighbours(v);
    const auto& sides = crest_[at_.at(v)[0]].facets;
    const ReferenceSurface::Foot foot = s_.closest_between((mesh_.target[a] + mesh_.target[b]) * 0.5, kReach, sides[0], sides[1]);
    if (foot.found()) mesh_.target[v] = foot.point;
  }

  SharpenMesh& mesh_;
  const ReferenceSurface& s_;
  std::vector<CrestEdge> crest_;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> at_;  // vertex -> crest edges
  std::vector<std::uint32_t> vertices_;  // with two of them, ascending
};

}  // namespace

void unfold_creases(SharpenMesh& mesh, const ReferenceSurface& s) { Unfolder(mesh, s).run(); }

}  // namespace burnish::detail
