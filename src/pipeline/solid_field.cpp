#include "solid_field.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "burnish/levelset/curvature.h"
#include "burnish/levelset/from_triangles.h"
#include "resolve_options.h"
#include "tricubic_sampler.h"

namespace burnish {
namespace {

constexpr double kDomainMargin = 3;  // cells between the band and the walls

double band_for(double cell, double reach) { return std::max(curvature_band(CurvatureOrder::fourth), std::ceil(reach / cell)) + 1; }

bool is_within(const GridFrame& frame, const Vec3& q) {
  const double side = frame.lattice_side() - 1;
  return q.x >= 0 && q.y >= 0 && q.z >= 0 && q.x <= side && q.y <= side && q.z <= side;
}

// Points go leaf by leaf: their values are gathered once for all of them.
void distances(const LevelSet& set, std::span<const Vec3> points, double* phi) {
  const Octree& tree = set.octree();
  std::vector<std::pair<std::uint32_t, std::uint32_t>> by_leaf;  // leaf, point
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Vec3 q = set.frame.to_lattice(points[i]);
    phi[i] = -set.band * set.frame.cell;
    if (!is_within(set.frame, q)) continue;
    const auto block = [](double x) { return static_cast<std::uint32_t>(x) / static_cast<std::uint32_t>(kBlockSide); };
    by_leaf.emplace_back(tree.find({block(q.x), block(q.y), block(q.z)}), i);
  }
  std::sort(by_leaf.begin(), by_leaf.end());
  TricubicSampler cubic(set);
  for (const auto& [leaf, i] : by_leaf) {
    const Vec3 q = set.frame.to_lattice(points[i]);
    // Farther away the field is uniform, or signs will do.
    const bool near = tree.level(leaf) == 0 && set.grid.near_surface(leaf);
    phi[i] = set.frame.cell * (near ? cubic(q) : sample(tree, set.phi, q.x, q.y, q.z));
  }
}

void fronts(const LevelSet& set, std::span<const Vec3> points, SolidField::Front* result) {
  std::vector<Vec3> at(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) at[i] = set.frame.to_lattice(points[i]);
  const std::vector<FrontCurvature> found = front_curvature(set, at, CurvatureOrder::fourth);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const FrontCurvature& f = found[i];
    result[i] = {set.frame.to_model(f.foot), f.normal, f.direction1, f.direction2, f.k1 / set.frame.cell, f.k2 / set.frame.cell, f.converged};
  }
}

}  // namespace

SolidLevelSet solid_level_set(const TriangleSoup& surface, double cell, double reach, Progress& progress) {
  const double band = band_for(cell, reach);
  const GridFrame frame = make_frame(bounding_box(surface), cell, band + kDomainMargin);
  SolidLevelSet result;
  result.set = std::make_shared<const LevelSet>(std::move(level_set_from_triangles(surface, frame, {.band = band, .far_field = false}, progress).level_set));
  result.field.band = band * cell;
  result.field.distance = [set = result.set](std::span<const Vec3> points, double* phi) { distances(*set, points, phi); };
  result.field.front = [set = result.set](std::span<const Vec3> points, SolidField::Front* found) { fronts(*set, points, found); };
  return result;
}

std::uint64_t solid_level_set_bytes(const TriangleSoup& surface, double cell, double reach) { return planned_bytes(surface, cell, band_for(cell, reach)); }

}  // namespace burnish
