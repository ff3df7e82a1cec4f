#include "burnish/levelset/from_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "burnish/core/parallel.h"
#include "burnish/levelset/crossings.h"
#include "burnish/levelset/distance.h"
#include "burnish/levelset/far_field.h"
#include "burnish/levelset/sign.h"
#include "burnish/surface/triangle_index.h"

namespace burnish {
namespace {

// Whether the node at or below p along each axis is inside.
bool is_inside_at(const SurfaceOctree& grid, const Field<std::uint8_t>& inside, const Vec3& p) {
  const std::array<std::int32_t, 3> at{static_cast<std::int32_t>(p.x), static_cast<std::int32_t>(p.y), static_cast<std::int32_t>(p.z)};
  const auto block = [&](std::size_t a) { return static_cast<std::uint32_t>(at[a]) / kBlockSide; };
  const std::size_t leaf = grid.octree.find({block(0), block(1), block(2)});
  return inside.block(leaf)[node_index(at[0] % kBlockSide, at[1] % kBlockSide, at[2] % kBlockSide)] != 0;
}

// Whether the nodes of the cell that holds point p, and of `around` layers of cells about it, are all on one side.
bool is_uniform_around(const SurfaceOctree& grid, const Field<std::uint8_t>& inside, const Vec3& p, int around) {
  const auto is_inside = [&](int i, int j, int k) {
    return is_inside_at(grid, inside, {std::floor(p.x) + i, std::floor(p.y) + j, std::floor(p.z) + k});
  };
  const bool first = is_inside(0, 0, 0);
  for (int k = -around; k <= 1 + around; ++k)
    for (int j = -around; j <= 1 + around; ++j)
      for (int i = -around; i <= 1 + around; ++i)
        if (is_inside(i, j, k) != first) return false;
  return true;
}

// What each facet is to the solid. No part of its surface are those that cross lattice edges but separate nothing, in a cell that the boundary
// does not cut. Where there are such facets, smaller ones that cross no edge at all are judged by the cells around.
// [T-SIGN-4]
void assign_roles(const TriangleSoup& lattice_soup, const SurfaceOctree& grid, const Field<std::uint8_t>& inside,
                  const std::vector<FacetSides>& sides, LevelSetFromTriangles& result) {
  result.roles.assign(sides.size(), FacetRole::boundary);
  const auto centroid = [&](std::size_t f) {
    return (lattice_soup.corner(f, 0) + lattice_soup.corner(f, 1) + lattice_soup.corner(f, 2)) / 3.0;
  };
  const auto leave_out = [&](std::size_t f, bool is_inside) {
    result.roles[f] = is_inside ? FacetRole::interior : FacetRole::unresolved;
    if (is_inside) {
      ++result.interior_facets;
    } else {
      ++result.unresolved_facets;
      result.unresolved_area += 0.5 * norm(facet_normal_2a(lattice_soup, f));
    }
  };
  for (std::size_t f = 0; f < sides.size(); ++f)
    if (!sides[f].separates && sides[f].crosses() && is_uniform_around(grid, inside, centroid(f), 0))
      leave_out(f, sides[f].within_inside);
  if (result.interior_facets == 0) return;
  for (std::size_t f = 0; f < sides.size(); ++f)
    if (!sides[f].crosses() && is_uniform_around(grid, inside, centroid(f), 1) && is_inside_at(grid, inside, centroid(f)))
      leave_out(f, true);
}

// Distances anew for the leaves that some facet has left.
void recompute_without(const TriangleSoup& lattice_soup, const SurfaceOctree& grid, double band,
                       const std::vector<char>& active, DistanceField& field) {
  parallel_for(
      grid.octree.size(),
      [&](std::size_t leaf) {
        const auto facets = grid.facets_of(leaf);
        if (std::all_of(facets.begin(), facets.end(), [&](std::uint32_t f) { return active[f] != 0; })) return;
        std::array<double, kBlockNodes> squared;
        exact_squared_distances(lattice_soup, grid, leaf, band, active, squared.data(), field.nearest.block(leaf));
        std::transform(squared.begin(), squared.end(), field.distance.block(leaf),
                       [](double d2) { return static_cast<float>(std::sqrt(d2)); });
      },
      16);
}

}  // namespace

TriangleSoup to_lattice(const TriangleSoup& soup, const GridFrame& frame) {
  TriangleSoup lattice{soup.points, soup.facets, {}};
  parallel_for(lattice.points.size(), [&](std::size_t i) { lattice.points[i] = frame.to_lattice(lattice.points[i]); });
  return lattice;
}

LevelSetFromTriangles level_set_from_triangles(const TriangleSoup& soup, const GridFrame& frame, const LevelSetOptions& options,
                                               Progress& progress) {
  const double band = options.band;
  LevelSetFromTriangles result;
  const TriangleSoup lattice_soup = to_lattice(soup, frame);
  LevelSet& set = result.level_set;
  set.frame = frame;
  set.band = band;
  set.grid = grow_uniform_band(lattice_soup, frame.depth, band, static_cast<int>(std::ceil(options.room / kBlockSide)), progress);
  DistanceField field = exact_distances(lattice_soup, set.grid, band, {}, progress);
  const TriangleIndex triangles(lattice_soup);
  const Field<std::uint8_t> crossed = crossed_edges(lattice_soup, set.grid, progress);
  const InsideField classified = classify_nodes(set.grid, field.distance, crossed, triangles, progress);
  result.regions = classified.regions;
  result.ambiguous_regions = classified.ambiguous_regions;
  result.winding_evaluations = classified.evaluations;

  const auto sides = facet_sides(lattice_soup, set.grid, classified.inside, progress);
  assign_roles(lattice_soup, set.grid, classified.inside, sides, result);
  if (result.interior_facets + result.unresolved_facets > 0) {
    std::vector<char> active(result.roles.size());
    std::transform(result.roles.begin(), result.roles.end(), active.begin(), [](FacetRole role) { return role == FacetRole::boundary; });
    recompute_without(lattice_soup, set.grid, band, active, field);
  }
  // [T-FAR-1]
  if (options.far_field) spread_far_field(lattice_soup, set.grid, field, progress);
  set.phi = std::move(field.distance);
  if (options.keep_nearest) result.nearest = std::move(field.nearest);
  parallel_for(set.phi.values.size(), [&](std::size_t i) {
    if (!classified.inside.values[i]) set.phi.values[i] = -set.phi.values[i];
  });
  return result;
}

LevelSet level_set_of_shell(const TriangleSoup& soup, const GridFrame& frame, double half_thickness, const LevelSetOptions& options,
                            Progress& progress) {
  LevelSet set;
  const TriangleSoup lattice_soup = to_lattice(soup, frame);
  set.frame = frame;
  set.band = options.band;
  const double reach = half_thickness + options.band;
  set.grid = grow_uniform_band(lattice_soup, frame.depth, reach, static_cast<int>(std::ceil(options.room / kBlockSide)), progress);
  set.phi = exact_distances(lattice_soup, set.grid, reach, {}, progress).distance;
  parallel_for(set.phi.values.size(), [&](std::size_t i) {
    const double phi = half_thickness - static_cast<double>(set.phi.values[i]);
    set.phi.values[i] = static_cast<float>(std::clamp(phi, -options.band, options.band));
  });
  return set;
}

}  // namespace burnish
