// Cutting the edges that creases cross, and the facets at them.
#include <algorithm>
#include <array>
#include <utility>

#include "sharpen_mesh.h"

namespace burnish::detail {
namespace {

constexpr double kNearEnd = 0.1;  // of an edge: no cut is nearer to its end

// Appends the point where a crossing cuts its edge, on M.
void add_cut(SharpenMesh& mesh, const Crossing& c) {
  const auto [u, v] = c.points;
  const double a = norm(mesh.target[u] - c.at), b = norm(mesh.target[v] - c.at);
  const double t = a + b > 0 ? std::clamp(a / (a + b), kNearEnd, 1 - kNearEnd) : 0.5;
  mesh.start.push_back(mesh.start[u] + (mesh.start[v] - mesh.start[u]) * t);
  mesh.target.push_back(c.at);
  mesh.sheet.push_back(mesh.sheet[u]);
  mesh.kind.push_back(SharpenedKind::crease);
  mesh.parents.push_back({u, v});
}

// [a, b, c] with cuts on its sides ab, bc, ca (kNoFacet: none). Of the two diagonals of what is left of a facet with two cuts the shorter one is taken.
class FacetCutter {
 public:
  FacetCutter(const SharpenMesh& mesh, std::vector<Facet>& out) : mesh_(mesh), out_(out) {}

  void cut(Facet f, std::array<std::uint32_t, 3> on_side) {
    const auto is_cut = [&](std::size_t i) { return on_side[i] != kNoFacet; };
    const int count = is_cut(0) + is_cut(1) + is_cut(2);
    if (count == 0) return out_.push_back(f);
    // One cut comes to the first side, two to the first and the last.
    while (count == 1 ? !is_cut(0) : count == 2 && is_cut(1)) {
      std::rotate(f.begin(), f.begin() + 1, f.end());
      std::rotate(on_side.begin(), on_side.begin() + 1, on_side.end());
    }
    const auto [a, b, c] = f;
    const auto [ab, bc, ca] = on_side;
    if (count == 1) return add({{a, ab, c}, {ab, b, c}});
    if (count == 2) {
      if (length(ab, c) <= length(b, ca)) return add({{a, ab, ca}, {ab, b, c}, {ab, c, ca}});
      return add({{a, ab, ca}, {ab, b, ca}, {b, c, ca}});
    }
    add({{a, ab, ca}, {ab, b, bc}, {bc, c, ca}, {ab, bc, ca}});
  }

 private:
  double length(std::uint32_t a, std::uint32_t b) const { return squared_norm(mesh_.target[a] - mesh_.target[b]); }
  void add(std::initializer_list<Facet> facets) { out_.insert(out_.end(), facets); }

  const SharpenMesh& mesh_;
  std::vector<Facet>& out_;
};

}  // namespace

void cut_edges(SharpenMesh& mesh, const std::vector<Crossing>& crossings) {
  if (crossings.empty()) return;
  const auto first_cut = static_cast<std::uint32_t>(mesh.start.size());
  std::vector<std::uint8_t> at_cut(first_cut, 0);
  for (const Crossing& c : crossings) {
    add_cut(mesh, c);
    at_cut[c.points[0]] = at_cut[c.points[1]] = 1;
  }
  const auto cut_on = [&](std::uint32_t u, std::uint32_t v) {
    const std::array<std::uint32_t, 2> edge{std::min(u, v), std::max(u, v)};
    const auto c = std::lower_bound(crossings.begin(), crossings.end(), edge, [](const Crossing& x, const auto& e) { return x.points < e; });
    return c != crossings.end() && c->points == edge ? first_cut + static_cast<std::uint32_t>(c - crossings.begin()) : kNoFacet;
  };
  std::vector<Facet> facets;
  facets.reserve(mesh.facets.size() + 2 * crossings.size());
  FacetCutter cutter(mesh, facets);
  for (const Facet& f : mesh.facets) {
    if (at_cut[f[0]] + at_cut[f[1]] + at_cut[f[2]] < 2) {
      facets.push_back(f);
    } else {
      cutter.cut(f, {cut_on(f[0], f[1]), cut_on(f[1], f[2]), cut_on(f[2], f[0])});
    }
  }
  mesh.facets = std::move(facets);
}

}  // namespace burnish::detail
