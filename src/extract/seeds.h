// What Delaunay refinement starts from: points of the surface of marching tetrahedra.
#pragma once

#include <cstdint>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/levelset/level_set.h"
#include "burnish/surface/triangle_soup.h"
#include "field_sampler.h"

namespace burnish::detail {

// The surface by marching tetrahedra: every zero crossing of the lattice is one of its points.
struct ZeroSurface {
  TriangleSoup soup;
  std::vector<std::uint32_t> component;  // of each point, numbered in the order of their first points
  std::size_t components = 0;
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
