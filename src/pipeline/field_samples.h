// FieldSamples: the signed distance at any point, not only at the octree's nodes.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "burnish/core/vec.h"
#include "burnish/levelset/from_triangles.h"
#include "burnish/surface/triangle_index.h"

namespace burnish {

class TricubicSampler;

// Where phi is the distance to facets, so are samples: exact but for rounding up to `reach`, beyond it up to 1 % too large. Signs are those of the
// nodes: a node whose ball without facets holds the point, or that the point's ball holds, says which; the rest is said by winding numbers. [T-EXPORT-1]
//
// Otherwise (smoothed, redistanced) samples are the tricubic interpolant of the nodes, off by O(h^4) where phi is smooth. [T-EXPORT-2] Outside the
// domain they are distances to where the gradient at its wall leads to, which is never too small for a surface within it.
//
// All in lattice units; from any number of threads. What the constructor is given must outlive the object.
class FieldSamples {
 public:
  // `facets`: what the level set was built from; `roles` of them. `nearest`: the nearest of them to each node, in phi's layout.
  FieldSamples(const LevelSet& set, const TriangleSoup& facets, const std::vector<FacetRole>& roles, const Field<std::uint32_t>& nearest, double reach);
  explicit FieldSamples(const LevelSet& set) : set_(set), tree_(set.octree()) {}

  bool is_exact() const { return boundary_ != nullptr; }
  // phi at the points. Faster for points that follow each other.
  void at(std::span<const Vec3> points, double* phi) const;

 private:
  struct Corners;

  bool is_within(const Vec3& p) const;
  double signed_distance(const Vec3& p, std::uint32_t& leaf, Vec3& foot) const;
  Corners corners_of(const Vec3& p, std::uint32_t& leaf) const;
  double distance(const Vec3& p, const Corners& corners, Vec3& foot) const;
  bool is_inside(const Vec3& p, const Corners& corners, double d) const;
  double interpolated(const Vec3& p, TricubicSampler& cubic) const;
  double beyond_walls(const Vec3& p) const;

  const LevelSet& set_;
  const Octree& tree_;
  const TriangleSoup* facets_ = nullptr;
  const Field<std::uint32_t>* nearest_ = nullptr;
  double reach_ = 0;
  std::shared_ptr<const TriangleIndex> boundary_;  // facets that bound the solid
  std::shared_ptr<const TriangleIndex> all_;       // of all facets, which winding numbers count
};

}  // namespace burnish
