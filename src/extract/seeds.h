// What Delaunay refinement starts from, and what its result is compared with: the surface of marching tetrahedra.
#pragma once

#include <cstdint>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/levelset/level_set.h"
#include "burnish/surface/triangle_soup.h"
#include "field_sampler.h"

namespace burnish::detail {

// Of a soup all of whose points are used by facets.
struct Topology {
  std::size_t components = 0;
  std::int64_t euler = 0;  // points - edges + facets, for closed surfaces

  bool operator==(const Topology&) const = default;
};

// Numbers the components of the soup's points in the order of their first points.
std::vector<std::uint32_t> components_of(const TriangleSoup& soup, std::size_t& count);
Topology topology_of(const TriangleSoup& soup);

// Whether every edge is used twice, in opposite directions, and there is one fan of facets around each point.
bool is_closed_manifold(const TriangleSoup& soup);

// The surface by marching tetrahedra: every zero crossing of the lattice is one of its points.
struct ZeroSurface {
  TriangleSoup soup;
  std::vector<std::uint32_t> component;  // of each point
  Topology topology;
  double area = 0;  // cells squared
};
ZeroSurface zero_surface(const LevelSet& level_set, Progress& progress);

// Balls in which there may be no seeds: protected creases.
struct SeedFreeBall {
  Vec3 center;
  double radius;
};

// Points of the zero surface, no two nearer than the spacing (one per point of the surface), so that few other points would be as far from all of them;
// and at least kLeast per component, or all there are, as far from each other as they can be. On the interpolant's zero. [T-DELAUNAY-2]
inline constexpr std::size_t kLeastSeeds = 8;
std::vector<Vec3> spread_seeds(const ZeroSurface& surface, const std::vector<double>& spacing, const std::vector<SeedFreeBall>& free_of,
                               FieldSampler& field);

}  // namespace burnish::detail
