#include <array>
#include <cmath>

#include "burnish/core/parallel.h"
#include "burnish/levelset/curvature.h"
#include "burnish/surface/quadric_fit.h"
#include "point_groups.h"
#include "tricubic.h"

namespace burnish {
namespace {

using namespace detail;

constexpr int kWidth = 4;
constexpr int kSide = kBlockSide + 2 * kWidth;
constexpr int kSteps = 12;
constexpr double kReach = 2, kEnough = 1e-6;  // cells
constexpr int kAcross = 5;                    // points of the grid in the tangent plane along each axis,
constexpr double kSpacing = 0.625;            // this many cells apart: its corners are 1.8 cells away
constexpr int kDegree = 4;

// The stencil of the tricubic interpolant fits.
bool is_inside(const Vec3& p) {
  const auto fits = [](double x) { return x >= 1 && x < kSide - 2; };
  return fits(p.x) && fits(p.y) && fits(p.z);
}

SecondOrder interpolant(const double* phi, const Vec3& p) {
  const int i = static_cast<int>(p.x), j = static_cast<int>(p.y), k = static_cast<int>(p.z);
  return tricubic(phi + (i - 1) + kSide * ((j - 1) + kSide * (k - 1)), kSide, p - Vec3{double(i), double(j), double(k)});
}

// [T-REDIST-1]
bool find_foot(const double* phi, const Vec3& x, Vec3& y, Vec3& normal) {
  y = x;
  for (int step = 0; step < kSteps; ++step) {
    if (!is_inside(y) || squared_norm(y - x) > kReach * kReach) return false;
    const SecondOrder at = interpolant(phi, y);
    const Vec3& g = at.gradient;
    const double g2 = squared_norm(g);
    if (!(g2 > 0.25)) return false;
    normal = g * (-1 / std::sqrt(g2));
    const Vec3 along = x - y, move = g * (-at.value / g2) + along - normal * dot(along, normal);
    y += move;
    if (squared_norm(move) < kEnough * kEnough) return true;
  }
  return is_inside(y);
}

// The surface on the line through p along the normal.
bool find_height(const double* phi, const Vec3& normal, Vec3& p) {
  for (int step = 0; step < kSteps; ++step) {
    if (!is_inside(p)) return false;
    const SecondOrder at = interpolant(phi, p);
    const double slope = dot(at.gradient, normal);
    if (!(slope < -0.2)) return false;
    p -= normal * (at.value / slope);
    if (std::abs(at.value) < kEnough) return true;
  }
  return false;
}

// [T-QUADRIC-3]
OsculatingParaboloid fit_around(const double* phi, const Vec3& x) {
  Vec3 foot, n;
  if (!find_foot(phi, x, foot, n)) return {};
  const Vec3 axis = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 across = cross(axis, n), u = across / norm(across), v = cross(n, u);
  std::array<Vec3, std::size_t{kAcross} * kAcross> points;
  for (int i = 0; i < kAcross * kAcross; ++i) {
    const int row = i / kAcross - kAcross / 2, column = i % kAcross - kAcross / 2;
    const double a = kSpacing * column, b = kSpacing * row;
    Vec3& p = points[static_cast<std::size_t>(i)];
    p = foot + u * a + v * b;
    if (!find_height(phi, n, p)) return {};
  }
  return osculating_paraboloid(foot, n, points, kDegree);
}

}  // namespace

template <class T>
std::vector<FrontCurvature> quadric_curvature(const BasicLevelSet<T>& level_set, std::span<const Vec3> points, Progress& progress) {
  const Octree& tree = level_set.octree();
  const PointGroups groups(storing_leaves(tree, level_set.phi, points), tree.size());
  std::vector<FrontCurvature> found(points.size());
  parallel_ranges(groups.leaves.size(), 4, [&](std::size_t begin, std::size_t end) {
    progress.check();
    std::array<T, std::size_t{kSide} * kSide * kSide> values;
    std::array<double, values.size()> phi;
    for (std::size_t g = begin; g < end; ++g) {
      const std::uint32_t leaf = groups.leaves[g];
      const double cell = 1 << tree.level(leaf);
      gather_smooth(tree, level_set.phi, leaf, kWidth, HaloOrder::quintic, values.data());
      for (std::size_t n = 0; n < phi.size(); ++n) phi[n] = static_cast<double>(values[n]) / cell;
      for (std::size_t n = groups.first[g]; n < groups.first[g + 1]; ++n) {
        const OsculatingParaboloid fit = fit_around(phi.data(), to_array(tree, leaf, kWidth, points[groups.order[n]]));
        if (!fit.valid) continue;
        found[groups.order[n]] = {to_lattice(tree, leaf, kWidth, fit.foot), fit.normal, fit.k1 / cell, fit.k2 / cell, fit.direction1, fit.direction2,
                                  2, true};
      }
    }
  });
  return found;
}

template std::vector<FrontCurvature> quadric_curvature(const BasicLevelSet<float>&, std::span<const Vec3>, Progress&);
template std::vector<FrontCurvature> quadric_curvature(const BasicLevelSet<double>&, std::span<const Vec3>, Progress&);

}  // namespace burnish
