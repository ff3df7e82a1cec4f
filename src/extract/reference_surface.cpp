#include "burnish/extract/reference_surface.h"

#include <algorithm>
#include <queue>
#include <unordered_set>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/core/union_find.h"
#include "burnish/surface/edge_table.h"
#include "burnish/surface/facet_normals.h"

namespace burnish {
namespace {

constexpr double kTurnsItsBack = -0.3;  // cosine
constexpr std::size_t kFloodLimit = 4096;

ReferenceSurface::Foot foot_of(const TriangleIndex::Closest& c) {
  return c.facet == kNoFacet ? ReferenceSurface::Foot{} : ReferenceSurface::Foot{c.point, c.squared_distance, c.facet};
}

Vec3 centroid(const TriangleSoup& soup, std::uint32_t f) { return (soup.corner(f, 0) + soup.corner(f, 1) + soup.corner(f, 2)) / 3; }

double squared_distance_to_edge(const Vec3& p, const Vec3& a, const Vec3& b) {
  return squared_norm(closest_point_on_triangle(p, a, b, b) - p);
}

}  // namespace

ReferenceSurface::ReferenceSurface(TriangleSoup surface, Creases creases)
    : soup_(std::move(surface)),
      creases_(std::move(creases)),
      normals_(facet_normals(soup_).unit),
      index_(soup_),
      crease_edges_(folded(soup_, creases_)),
      crease_index_(crease_edges_) {
  if (has_creases()) link_facets();
}

void ReferenceSurface::link_facets() {
  const EdgeTable table(soup_);
  across_.assign(soup_.facets.size(), {kNoFacet, kNoFacet, kNoFacet});
  UnionFind sheets(soup_.facets.size());
  auto crease = creases_.edges.begin();
  for (std::size_t e = 0; e < table.size(); ++e) {
    while (crease != creases_.edges.end() && crease->points < table.edge(e)) ++crease;
    const bool sharp = crease != creases_.edges.end() && crease->points == table.edge(e);
    const auto u = table.uses(e);
    if (sharp || u.size() != 2 || table.is_misoriented(e)) continue;
    across_[u[0].facet][u[0].side] = u[1].facet;
    across_[u[1].facet][u[1].side] = u[0].facet;
    sheets.unite(u[0].facet, u[1].facet);
  }
  sheet_.resize(soup_.facets.size());
  for (std::uint32_t f = 0; f < sheet_.size(); ++f) sheet_[f] = sheets.find(f);
  list_sheets_at_corners();
}

void ReferenceSurface::list_sheets_at_corners() {
  sheets_at_corner_.resize(creases_.corners.size());
  for (const CreaseEdge& e : creases_.edges)
    for (const std::uint32_t p : e.points) {
      const auto corner = std::lower_bound(creases_.corners.begin(), creases_.corners.end(), p);
      if (corner == creases_.corners.end() || *corner != p) continue;
      for (const std::uint32_t f : e.facets) sheets_at_corner_[static_cast<std::size_t>(corner - creases_.corners.begin())].push_back(sheet_[f]);
    }
  for (auto& sheets : sheets_at_corner_) {
    std::sort(sheets.begin(), sheets.end());
    sheets.erase(std::unique(sheets.begin(), sheets.end()), sheets.end());
  }
}

bool ReferenceSurface::sheet_meets_corner(std::uint32_t facet, std::size_t corner) const {
  return std::binary_search(sheets_at_corner_[corner].begin(), sheets_at_corner_[corner].end(), sheet_[facet]);
}

template <class Accept>
ReferenceSurface::Foot ReferenceSurface::closest_accepted(const Vec3& p, double within, Accept&& accept) const {
  std::vector<std::uint32_t> near;
  index_.facets_near(p, within * within, near);
  Foot best;
  best.squared_distance = within * within;
  for (const std::uint32_t f : near) {
    if (!accept(f)) continue;
    const Vec3 q = closest_point_on_triangle(p, soup_.corner(f, 0), soup_.corner(f, 1), soup_.corner(f, 2));
    if (squared_norm(q - p) < best.squared_distance) best = {q, squared_norm(q - p), f};
  }
  return best;
}

ReferenceSurface::Foot ReferenceSurface::closest(const Vec3& p, double within, const Vec3& facing, std::uint32_t hint) const {
  double limit = within * within;
  Foot best;
  if (hint != kNoFacet) {
    const Vec3 q = closest_point_on_triangle(p, soup_.corner(hint, 0), soup_.corner(hint, 1), soup_.corner(hint, 2));
    if (squared_norm(q - p) <= limit) best = {q, squared_norm(q - p), hint}, limit = best.squared_distance;
  }
  const Foot found = foot_of(index_.closest(p, limit));
  if (found.found() && !(found.squared_distance >= best.squared_distance)) best = found;
  if (!best.found() || dot(normals_[best.facet], facing) >= kTurnsItsBack) return best;
  return closest_accepted(p, within, [&](std::uint32_t f) { return dot(normals_[f], facing) >= kTurnsItsBack; });
}

ReferenceSurface::Foot ReferenceSurface::closest_on_sheet(const Vec3& p, double within, const Vec3& facing, std::uint32_t f) const {
  return closest_accepted(p, within, [&](std::uint32_t g) { return sheet(g) == sheet(f) && dot(normals_[g], facing) >= kTurnsItsBack; });
}

ReferenceSurface::Foot ReferenceSurface::closest_on_creases(const Vec3& p, double within) const {
  return foot_of(crease_index_.closest(p, within * within));
}

// 2: the crease lies between both sheets; 1: it bounds the first of them; 0: neither.
int ReferenceSurface::fit_of_crease(std::uint32_t edge, std::uint32_t f, std::uint32_t g) const {
  const auto [m, n] = std::minmax(sheet_[f], sheet_[g]);
  const auto [a, b] = std::minmax(sheet_[creases_.edges[edge].facets[0]], sheet_[creases_.edges[edge].facets[1]]);
  if (a == m && b == n) return 2;
  return a == m || b == m ? 1 : 0;
}

ReferenceSurface::Foot ReferenceSurface::closest_between(const Vec3& p, double within, std::uint32_t f, std::uint32_t g) const {
  const Foot nearest = closest_on_creases(p, within);
  if (!nearest.found() || fit_of_crease(nearest.facet, f, g) == 2) return nearest;
  std::vector<std::uint32_t> near;
  crease_index_.facets_near(p, within * within, near);
  Foot best;
  int fit = -1;
  for (const std::uint32_t e : near) {
    const int fit_here = fit_of_crease(e, f, g);
    if (fit_here < fit) continue;
    const Vec3 q = closest_point_on_triangle(p, crease_edges_.corner(e, 0), crease_edges_.corner(e, 1), crease_edges_.corner(e, 2));
    const double d = squared_norm(q - p);
    if (d > within * within || (fit_here == fit && d >= best.squared_distance)) continue;
    best = {q, d, e};
    fit = fit_here;
  }
  return best;
}

bool ReferenceSurface::connected(std::uint32_t f, std::uint32_t g, const Vec3& centre, double radius) const {
  if (f == g || sheet_.empty()) return true;
  if (sheet_[f] != sheet_[g]) return false;
  const Vec3 goal = centroid(soup_, g);
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
  std::unordered_set<std::uint32_t> seen{f};
  front.push({0, f});
  while (!front.empty()) {
    const std::uint32_t here = front.top().second;
    front.pop();
    for (int side = 0; side < 3; ++side) {
      const std::uint32_t next = across_[here][static_cast<std::size_t>(side)];
      if (next == kNoFacet || seen.contains(next)) continue;
      if (squared_distance_to_edge(centre, soup_.corner(here, side), soup_.corner(here, (side + 1) % 3)) > radius * radius) continue;
      if (next == g || seen.size() >= kFloodLimit) return true;
      seen.insert(next);
      front.push({squared_norm(centroid(soup_, next) - goal), next});
    }
  }
  return false;
}

}  // namespace burnish
