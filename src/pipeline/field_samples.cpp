#include "field_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "field_nodes.h"
#include "tricubic_sampler.h"

namespace burnish {
namespace {

constexpr double kSlack = 1 + 1e-6;    // of a bound that was rounded to float
constexpr double kCertain = 1 - 1e-6;  // of a ball without facets
constexpr double kFarShare = 0.99;     // of a bound beyond the reach: what is not nearer than that is not looked for
constexpr double kTiny = 1e-9;         // cells

Vec3 position(const LatticeNode& n) { return {static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)}; }

TriangleSoup with_role(const TriangleSoup& facets, const std::vector<FacetRole>& roles, FacetRole role) {
  TriangleSoup chosen{facets.points, {}, {}};
  for (std::size_t f = 0; f < roles.size(); ++f)
    if (roles[f] == role) chosen.facets.push_back(facets.facets[f]);
  return chosen;
}

}  // namespace

// The nodes of the cell that holds a point, or where one hangs the node below it.
struct FieldSamples::Corners {
  std::array<Vec3, 8> at;
  std::array<double, 8> phi;
  std::array<std::uint32_t, 8> facet;  // the nearest, or kNoFacet
  std::size_t count = 0;
};

FieldSamples::FieldSamples(const LevelSet& set, const TriangleSoup& facets, const std::vector<FacetRole>& roles, const Field<std::uint32_t>& nearest, double reach)
    : set_(set), tree_(set.octree()), facets_(&facets), nearest_(&nearest), reach_(reach) {
  const TriangleSoup boundary = with_role(facets, roles, FacetRole::boundary);
  boundary_ = std::make_shared<const TriangleIndex>(boundary);
  all_ = boundary.facets.size() == facets.facets.size() ? boundary_ : std::make_shared<const TriangleIndex>(facets);
}

bool FieldSamples::is_within(const Vec3& p) const {
  const double side = set_.frame.lattice_side();
  return p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x < side && p.y < side && p.z < side;
}

double FieldSamples::signed_distance(const Vec3& p, std::uint32_t& leaf, Vec3& foot) const {
  if (!is_within(p)) return -distance(p, {}, foot);
  const Corners corners = corners_of(p, leaf);
  const double d = distance(p, corners, foot);
  return is_inside(p, corners, d) ? d : -d;
}

FieldSamples::Corners FieldSamples::corners_of(const Vec3& p, std::uint32_t& leaf) const {
  const std::array<std::int32_t, 3> cell{static_cast<std::int32_t>(p.x), static_cast<std::int32_t>(p.y), static_cast<std::int32_t>(p.z)};
  leaf = node_at_or_below(tree_, {cell[0], cell[1], cell[2]}, leaf == Octree::kNone ? 0 : leaf).leaf;
  const int level = tree_.level(leaf);
  Corners corners;
  for (std::size_t c = 0; c < 8; ++c) {
    const auto along = [&](std::size_t a) { return ((cell[a] >> level) + static_cast<std::int32_t>(c >> a & 1)) << level; };
    const LatticeNode at{along(0), along(1), along(2)};
    const StoredNode stored = node_at_or_below(tree_, at, leaf);
    if (stored.leaf == Octree::kNone) continue;
    const int n = static_cast<int>(stored.node);
    corners.at[corners.count] = position(lattice_node(tree_, stored.leaf, n % kBlockSide, n / kBlockSide % kBlockSide, n / kBlockSide / kBlockSide));
    corners.phi[corners.count] = static_cast<double>(set_.phi.block(stored.leaf)[stored.node]);
    corners.facet[corners.count++] = nearest_->block(stored.leaf)[stored.node];
  }
  return corners;
}

// The corners' facets bound the search, and so does the foot of the point before.
double FieldSamples::distance(const Vec3& p, const Corners& corners, Vec3& foot) const {
  double d = norm(p - foot);
  for (std::size_t c = 0; c < corners.count; ++c)
    if (const std::uint32_t f = corners.facet[c]; f != kNoFacet)
      d = std::min(d, norm(p - closest_point_on_triangle(p, facets_->corner(f, 0), facets_->corner(f, 1), facets_->corner(f, 2))));
  const double within = kFarShare * d > reach_ ? kFarShare * d : d;
  const auto closest = boundary_->closest(p, within * within * kSlack + kTiny);
  if (closest.facet == kNoFacet) return d;
  foot = closest.point;
  return std::sqrt(closest.squared_distance);
}

// [T-EXPORT-1]
bool FieldSamples::is_inside(const Vec3& p, const Corners& corners, double d) const {
  for (std::size_t c = 0; c < corners.count; ++c)
    if (norm(p - corners.at[c]) < kCertain * std::max(std::abs(corners.phi[c]), d)) return corners.phi[c] >= 0;
  return all_->winding_number(p) > 0.5;
}

// Beyond the walls phi falls as the distance to the foot of the wall's nearest point.
double FieldSamples::beyond_walls(const Vec3& p) const {
  const double side = set_.frame.lattice_side() - 1;
  const Vec3 wall{std::clamp(p.x, 1.0, side - 1), std::clamp(p.y, 1.0, side - 1), std::clamp(p.z, 1.0, side - 1)};
  const auto phi = [&](const Vec3& q) { return sample(tree_, set_.phi, q.x, q.y, q.z); };
  const double at_wall = phi(wall);
  const Vec3 g{phi(wall + Vec3{1, 0, 0}) - phi(wall - Vec3{1, 0, 0}), phi(wall + Vec3{0, 1, 0}) - phi(wall - Vec3{0, 1, 0}), phi(wall + Vec3{0, 0, 1}) - phi(wall - Vec3{0, 0, 1})};
  const double size = norm(g);
  if (!(size > 0)) return at_wall - norm(p - wall);
  return -norm(p - (wall - g * (at_wall / size)));
}

double FieldSamples::interpolated(const Vec3& p, TricubicSampler& cubic) const {
  if (is_within(p)) return cubic(p);
  return beyond_walls(p);
}

void FieldSamples::at(std::span<const Vec3> points, double* phi) const {
  TricubicSampler cubic(set_);
  std::uint32_t leaf = Octree::kNone;
  constexpr double kFar = 1e30;
  Vec3 foot{kFar, kFar, kFar};
  for (const Vec3& p : points) {
    *phi++ = is_exact() ? signed_distance(p, leaf, foot) : interpolated(p, cubic);
  }
}

}  // namespace burnish
