#include "deviation_envelope.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "burnish/surface/edge_table.h"

namespace burnish {

constexpr std::uint32_t kNone = CollapsibleMesh::kNone;

DeviationEnvelope::DeviationEnvelope(const TriangleSoup& given, const TriangleIndex& index, double deviation)
    : index_(index), deviation_(deviation), first_(given.facets.size(), kNone) {
  std::vector<char> placed(given.points.size(), 0);
  for (std::uint32_t f = 0; f < given.facets.size(); ++f)
    for (const std::uint32_t p : given.facets[f])
      if (!std::exchange(placed[p], 1)) track(given.points[p], f);
  track_bent_edges(given);
}

void DeviationEnvelope::track(const Vec3& p, std::uint32_t facet) {
  next_.push_back(first_[facet]);
  first_[facet] = static_cast<std::uint32_t>(points_.size());
  points_.push_back(p);
}

// Points alone do not see an edge that is turned into the other diagonal of its two facets.
void DeviationEnvelope::track_bent_edges(const TriangleSoup& given) {
  const EdgeTable table(given);
  const auto unit = [&](std::uint32_t f) {
    const Vec3 n = facet_normal_2a(given, f);
    return n / std::max(norm(n), std::numeric_limits<double>::min());
  };
  for (std::size_t e = 0; e < table.size(); ++e) {
    const auto uses = table.uses(e);
    const Vec3 &a = given.points[table.edge(e)[0]], &b = given.points[table.edge(e)[1]];
    const double bend = uses.size() == 2 ? norm(unit(uses[0].facet) - unit(uses[1].facet)) : 2;
    if (0.25 * bend * norm(b - a) > (1 - kShare) * deviation_) track((a + b) * 0.5, uses[0].facet);
  }
}

// The facets around v: those that `other` shares go, the rest moves its corner at v to `to`.
void DeviationEnvelope::gather(const CollapsibleMesh& mesh, std::uint32_t v, std::uint32_t other, const Vec3& to) {
  mesh.around(v, [&](std::uint32_t h) {
    const std::uint32_t p = mesh.target(h), q = mesh.origin(CollapsibleMesh::previous(h));
    old_facets_.push_back(h / 3);
    if (p == other || q == other) return;
    const Vec3 &b = mesh.point(p), &c = mesh.point(q), center = (to + b + c) / 3;
    const double radius = std::sqrt(std::max({squared_norm(to - center), squared_norm(b - center), squared_norm(c - center)}));
    facets_.push_back({h / 3, {to, b, c}, center, radius});
  });
}

bool DeviationEnvelope::near_given(const Vec3& p) const { return index_.closest(p, squared_).facet != kNoFacet; }

bool DeviationEnvelope::hold_points() {
  homes_.clear();
  for (const std::uint32_t f : old_facets_)
    for (std::uint32_t p = first_[f]; p != kNone; p = next_[p]) {
      const Vec3& at = points_[p];
      double least = std::numeric_limits<double>::infinity();
      std::uint32_t home = kNone;
      for (const NewFacet& facet : facets_) {
        const double beyond = std::sqrt(squared_norm(at - facet.center)) - facet.radius;
        if (beyond > 0 && beyond * beyond >= least) continue;
        const double d = squared_norm(closest_point_on_triangle(at, facet.corners[0], facet.corners[1], facet.corners[2]) - at);
        if (d < least) least = d, home = facet.facet;
      }
      if (!(least <= squared_)) return false;
      homes_.push_back({p, home});
    }
  return true;
}

bool DeviationEnvelope::admits(const CollapsibleMesh& mesh, std::uint32_t h, const Vec3& to, double share) {
  squared_ = deviation_ * share * (deviation_ * share);
  facets_.clear();
  old_facets_.clear();
  const std::uint32_t a = mesh.origin(h), b = mesh.target(h);
  gather(mesh, a, b, to);
  gather(mesh, b, a, to);
  // The facets at the edge were met twice.
  std::size_t kept = 0;
  for (std::size_t i = 0; i < old_facets_.size(); ++i) {
    bool twice = false;
    for (std::size_t j = 0; j < kept; ++j) twice = twice || old_facets_[j] == old_facets_[i];
    if (!twice) old_facets_[kept++] = old_facets_[i];
  }
  old_facets_.resize(kept);
  if (!near_given(to) || !hold_points()) return false;
  // Each edge begins one facet and ends another.
  for (const NewFacet& f : facets_)
    if (!near_given((to + f.corners[1]) * 0.5) || !near_given(f.center)) return false;
  return true;
}

void DeviationEnvelope::accept() {
  for (const std::uint32_t f : old_facets_) first_[f] = kNone;
  for (const auto& [p, f] : homes_) {
    next_[p] = first_[f];
    first_[f] = p;
  }
}

}  // namespace burnish
