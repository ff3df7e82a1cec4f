#include "topology.h"

#include <algorithm>
#include <cmath>

namespace judge {
namespace {

// One facet's use of an edge; corners are numbered 3 facet + place.
struct Use {
  std::uint32_t low, high;  // points
  std::uint32_t low_corner, high_corner;
  bool forward;  // from low to high
};

class Sets {
 public:
  explicit Sets(std::size_t size) {
    parent_.reserve(size);
    for (std::uint32_t i = 0; i < size; ++i) parent_.push_back(i);
  }

  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::uint32_t a, std::uint32_t b) { parent_[find(a)] = find(b); }

  template <class Counts>
  std::size_t count(Counts counts) {
    std::size_t sets = 0;
    for (std::uint32_t i = 0; i < parent_.size(); ++i) sets += parent_[i] == i && counts(i);
    return sets;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

bool repeats_point(const Facet& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; }

std::vector<Use> sorted_uses(const Mesh& mesh) {
  std::vector<Use> uses;
  uses.reserve(3 * mesh.facets.size());
  for (std::uint32_t f = 0; f < mesh.facets.size(); ++f) {
    if (repeats_point(mesh.facets[f])) continue;
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint32_t j = (i + 1) % 3, a = mesh.facets[f][i], b = mesh.facets[f][j];
      if (a < b)
        uses.push_back({a, b, 3 * f + i, 3 * f + j, true});
      else
        uses.push_back({b, a, 3 * f + j, 3 * f + i, false});
    }
  }
  std::sort(uses.begin(), uses.end(),
            [](const Use& a, const Use& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; });
  return uses;
}

}  // namespace

Topology count_topology(const Mesh& mesh) {
  Topology result;
  Sets components(mesh.facets.size()), fans(3 * mesh.facets.size()), loops(mesh.points.size());
  std::vector<char> on_loop(mesh.points.size(), 0), used(mesh.points.size(), 0);
  const std::vector<Use> uses = sorted_uses(mesh);
  for (std::size_t first = 0, last = 0; first < uses.size(); first = last) {
    const Use& edge = uses[first];
    while (last < uses.size() && uses[last].low == edge.low && uses[last].high == edge.high) {
      components.unite(edge.low_corner / 3, uses[last].low_corner / 3);
      fans.unite(edge.low_corner, uses[last].low_corner);
      fans.unite(edge.high_corner, uses[last].high_corner);
      ++last;
    }
    used[edge.low] = used[edge.high] = 1;
    result.non_manifold_edges += last - first > 2;
    result.misoriented_edges += last - first == 2 && edge.forward == uses[first + 1].forward;
    if (last - first != 1) continue;
    ++result.open_edges;
    loops.unite(edge.low, edge.high);
    on_loop[edge.low] = on_loop[edge.high] = 1;
  }
  for (const Facet& facet : mesh.facets) result.repeating_facets += repeats_point(facet);
  result.components = components.count([&](std::uint32_t f) { return !repeats_point(mesh.facets[f]); });
  result.open_loops = loops.count([&](std::uint32_t p) { return on_loop[p] != 0; });
  // Several fans at a point are counted as that many points less one.
  result.non_manifold_points = fans.count([&](std::uint32_t c) {
    return !repeats_point(mesh.facets[c / 3]);
  }) - static_cast<std::size_t>(std::count(used.begin(), used.end(), 1));
  return result;
}

double signed_volume(const Mesh& mesh) {
  if (mesh.points.empty()) return 0;
  // Seen from a point of the mesh: far from the origin, products of coordinates would cancel.
  const Point& o = mesh.points[mesh.points.size() / 2];
  double sum = 0;
  for (const Facet& f : mesh.facets) {
    double v[3][3];
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) v[i][k] = mesh.points[f[i]][k] - o[k];
    sum += v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) +
           v[0][1] * (v[1][2] * v[2][0] - v[1][0] * v[2][2]) +
           v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
  }
  return sum / 6;
}

double diagonal(const Mesh& mesh) {
  if (mesh.points.empty()) return 0;
  Point low = mesh.points[0], high = low;
  for (const Point& p : mesh.points)
    for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
  return std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
}

}  // namespace judge
