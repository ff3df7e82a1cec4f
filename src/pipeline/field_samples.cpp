#include "field_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "field_nodes.h"

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

// Weights of the cubic polynomial through nodes -1, 0, 1, 2 at t. [T-EXPORT-2]
std::array<double, 4> cubic_weights(double t) {
  return {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2, (t + 1) * t * (t - 1) / 6};
}

}  // namespace

// The nodes of the cell that holds a point, or where one hangs the node below it.
struct FieldSamples::Corners {
  std::array<Vec3, 8> at;
  std::array<double, 8> phi;
  std::array<std::uint32_t, 8> facet;  // the nearest, or kNoFacet
  std::size_t count = 0;
};

// The interpolant in one leaf after the other: the leaf's nodes with their surroundings are kept.
class FieldSamples::Cubic {
 public:
  explicit Cubic(const LevelSet& set) : set_(set) {}

  double operator()(const Vec3& p) {
    const StoredNode node = node_at_or_below(set_.octree(), {static_cast<std::int32_t>(p.x), static_cast<std::int32_t>(p.y), static_cast<std::int32_t>(p.z)},
                                             leaf_ == Octree::kNone ? 0 : leaf_);
    if (node.leaf != leaf_) enter(node.leaf);
    std::array<int, 3> first{};
    std::array<std::array<double, 4>, 3> weights{};
    for (int a = 0; a < 3; ++a) {
      const double x = (p[a] - corner_[a]) / cell_;
      first[static_cast<std::size_t>(a)] = std::clamp(static_cast<int>(x), 0, kBlockSide - 1);
      weights[static_cast<std::size_t>(a)] = cubic_weights(x - first[static_cast<std::size_t>(a)]);
    }
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t j = 0; j < 4; ++j) {
        const float* row = values_.data() + place(first[0], first[1] + static_cast<int>(j), first[2] + static_cast<int>(k));
        double line = 0;
        for (std::size_t i = 0; i < 4; ++i) line += weights[0][i] * static_cast<double>(row[i]);
        sum += weights[1][j] * weights[2][k] * line;
      }
    return sum;
  }

 private:
  static constexpr int kWidth = 2, kSide = kBlockSide + 2 * kWidth;

  // Of the first node of a stencil, which is one below the cell's.
  static std::size_t place(int i, int j, int k) { return static_cast<std::size_t>(i + kWidth - 1 + kSide * (j + kWidth - 1 + kSide * (k + kWidth - 1))); }

  void enter(std::uint32_t leaf) {
    leaf_ = leaf;
    gather_smooth(set_.octree(), set_.phi, leaf, kWidth, HaloOrder::cubic, values_.data());
    corner_ = position(lattice_node(set_.octree(), leaf, 0, 0, 0));
    cell_ = 1 << set_.octree().level(leaf);
  }

  const LevelSet& set_;
  std::uint32_t leaf_ = Octree::kNone;
  Vec3 corner_;
  double cell_ = 1;
  std::array<float, std::size_t{kSide} * kSide * kSide> values_{};
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

double FieldSamples::interpolated(const Vec3& p, Cubic& cubic) const {
  if (is_within(p)) return cubic(p);
  return beyond_walls(p);
}

void FieldSamples::at(std::span<const Vec3> points, double* phi) const {
  Cubic cubic(set_);
  std::uint32_t leaf = Octree::kNone;
  constexpr double kFar = 1e30;
  Vec3 foot{kFar, kFar, kFar};
  for (const Vec3& p : points) {
    *phi++ = is_exact() ? signed_distance(p, leaf, foot) : interpolated(p, cubic);
  }
}

}  // namespace burnish
