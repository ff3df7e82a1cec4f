#include "burnish/extract/reference_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/core/union_find.h"
#include "burnish/surface/edge_table.h"
#include "burnish/surface/facet_normals.h"

namespace burnish {
namespace {

constexpr double kTurnsItsBack = -0.3;  // cosine
constexpr std::size_t kFloodLimit = 4096;
constexpr double kHintMargin = 1 + 1e-6, kLeastLimit = 1e-12;  // of squared distances

// Open addressing; half of it at most is full.
class FacetSet {
 public:
  bool contains(std::uint32_t f) const { return slots_[slot_of(f)] == f; }
  void insert(std::uint32_t f) {
    std::uint32_t& slot = slots_[slot_of(f)];
    if (slot == f) return;
    slot = f;
    if (++size_ * 2 > slots_.size()) grow();
  }

 private:
  std::size_t slot_of(std::uint32_t f) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = (f * 0x9e3779b1u) >> 7 & mask;
    while (slots_[i] != kNoFacet && slots_[i] != f) i = (i + 1) & mask;
    return i;
  }
  void grow() {
    std::vector<std::uint32_t> old(2 * slots_.size(), kNoFacet);
    old.swap(slots_);
    for (const std::uint32_t f : old)
      if (f != kNoFacet) slots_[slot_of(f)] = f;
  }

  std::vector<std::uint32_t> slots_ = std::vector<std::uint32_t>(32, kNoFacet);
  std::size_t size_ = 0;
};

ReferenceSurface::Foot foot_of(const TriangleIndex::Closest& c) {
  return c.facet == kNoFacet ? ReferenceSurface::Foot{} : ReferenceSurface::Foot{c.point, c.squared_distance, c.facet};
}

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
  list_sheets_at_creases();
}

void ReferenceSurface::list_sheets_at_creases() {
  for (const CreaseEdge& e : creases_.edges) sheets_at_crease_.push_back(sheets_of(e.facets[0], e.facets[1]));
  meeting_sheets_ = sheets_at_crease_;
  std::sort(meeting_sheets_.begin(), meeting_sheets_.end());
  meeting_sheets_.erase(std::unique(meeting_sheets_.begin(), meeting_sheets_.end()), meeting_sheets_.end());
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
  return foot_of(index_.closest_of(p, within * within, [&](std::uint32_t f) { return dot(normals_[f], facing) >= kTurnsItsBack; }));
}

ReferenceSurface::Foot ReferenceSurface::closest_on_sheet(const Vec3& p, double within, const Vec3& facing, std::uint32_t f) const {
  const auto faces_it = [&](std::uint32_t g) { return sheet(g) == sheet(f) && dot(normals_[g], facing) >= kTurnsItsBack; };
  return foot_of(index_.closest_of(p, within * within, faces_it));
}

double ReferenceSurface::squared_distance_to_crease(const Vec3& p, std::uint32_t edge) const {
  return squared_distance_to_edge(p, crease_edges_.corner(edge, 0), crease_edges_.corner(edge, 1));
}

// A hint bounds the distance, with a margin that is far above rounding, so that it changes nothing but the time.
ReferenceSurface::Foot ReferenceSurface::closest_on_creases(const Vec3& p, double within, std::uint32_t hint) const {
  double limit = within * within;
  if (hint != kNoFacet) limit = std::min(limit, squared_distance_to_crease(p, hint) * kHintMargin + kLeastLimit);
  return foot_of(crease_index_.closest(p, limit));
}

bool ReferenceSurface::is_near_creases(const Vec3& p, double within, std::uint32_t& hint) const {
  if (hint != kNoFacet && squared_distance_to_crease(p, hint) <= within * within) return true;
  const Foot foot = closest_on_creases(p, within);
  if (foot.found()) hint = foot.facet;
  return foot.found();
}

ReferenceSurface::Foot ReferenceSurface::closest_between(const Vec3& p, double within, std::uint32_t f, std::uint32_t g, std::uint32_t hint) const {
  const Foot nearest = closest_on_creases(p, within, hint);
  const Edge sheets = sheets_of(f, g);
  if (!nearest.found() || sheets_at_crease_[nearest.facet] == sheets) return nearest;
  // Of equally distant edges, the first in the index's order; those at the distance itself count.
  const double limit = std::nextafter(within * within, std::numeric_limits<double>::infinity());
  if (std::binary_search(meeting_sheets_.begin(), meeting_sheets_.end(), sheets)) {
    const Foot between = foot_of(crease_index_.closest_of(p, limit, [&](std::uint32_t e) { return sheets_at_crease_[e] == sheets; }));
    if (between.found()) return between;
  }
  const auto bounds_first = [&](std::uint32_t e) { return sheets_at_crease_[e][0] == sheets[0] || sheets_at_crease_[e][1] == sheets[0]; };
  const Foot bounding = foot_of(crease_index_.closest_of(p, limit, bounds_first));
  return bounding.found() ? bounding : foot_of(crease_index_.closest_of(p, limit, [](std::uint32_t) { return true; }));
}

// What is reached does not depend on the order, only when.
bool ReferenceSurface::connected(std::uint32_t f, std::uint32_t g, const Vec3& centre, double radius) const {
  if (f == g || sheet_.empty()) return true;
  if (sheet_[f] != sheet_[g]) return false;
  FacetSet seen;
  seen.insert(f);
  std::vector<std::uint32_t> front{f};
  for (std::size_t i = 0; i < front.size(); ++i) {
    const std::uint32_t here = front[i];
    for (int side = 0; side < 3; ++side) {
      const std::uint32_t next = across_[here][static_cast<std::size_t>(side)];
      if (next == kNoFacet || seen.contains(next)) continue;
      if (squared_distance_to_edge(centre, soup_.corner(here, side), soup_.corner(here, (side + 1) % 3)) > radius * radius) continue;
      if (next == g || front.size() >= kFloodLimit) return true;
      seen.insert(next);
      front.push_back(next);
    }
  }
  return false;
}

}  // namespace burnish
