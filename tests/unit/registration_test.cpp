// Laying one surface onto another: the motion that was applied comes back.
#include "burnish/surface/registration.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "support/motions.h"
#include "support/parts.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

// No two ways to lay it onto itself.
TriangleSoup odd_part(int n) { return merged(bracket(n), moved(box({0.4, 0.2, 0.5}, n, n, n), {0.3, 0.1, 0.6})); }

double largest_error(const TriangleSoup& a, const RigidMotion& found, const RigidMotion& truth) {
  double error = 0;
  for (const Vec3& p : a.points) error = std::max(error, norm(found(p) - truth(p)));
  return error / bounding_box(a).diagonal();
}

TEST(Registration, FindsRandomMotionsOfIdenticalSurfaces) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  const TriangleSoup part = odd_part(4);
  for (int i = 0; i < 12; ++i) {
    const double angle = i == 0 ? std::numbers::pi : std::numbers::pi * unit(random);
    const RigidMotion truth = turn({unit(random), unit(random), unit(random)}, angle, Vec3{unit(random), unit(random), unit(random)} * 20);
    const Registration r = register_rigidly(part, by(truth, part));
    EXPECT_LT(largest_error(part, r.motion, truth), 1e-9) << i;
    EXPECT_TRUE(r.converged);
    EXPECT_EQ(r.free_motions, 0);
    EXPECT_GT(r.kept, 0.99);
  }
}

TEST(Registration, DoesNotNeedTheSameTriangles) {
  const RigidMotion truth = turn({1, 2, -1}, 2.5, {7, -9, 4});
  const auto part = [](int n) { return merged(box({3, 1, 0.5}, n, n, n), moved(box({0.4, 0.2, 0.5}, n, n, n), {0.3, 0.1, 0.5})); };
  EXPECT_LT(largest_error(part(2), register_rigidly(part(2), by(truth, part(5))).motion, truth), 1e-6);
}

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Matrix63 = Eigen::Matrix<double, 6, 3>;
Eigen::Vector3d eigen(const Vec3& v) { return {v.x, v.y, v.z}; }

// Of the motion (w, t) that least squares finds, over the area, when every point has noise of deviation 1 in each coordinate: with J = (x x n, n) and
// H = int J^T J, and g_v = int phi_v J^T n of the point v with its hat function phi_v, it is H^-1 (sum g_v g_v^T) H^-1. One centroid a facet.
Matrix6 covariance(const TriangleSoup& soup) {
  Matrix6 h = Matrix6::Zero(), g = Matrix6::Zero();
  std::vector<Matrix63> of_point(soup.points.size(), Matrix63::Zero());
  for (std::size_t f = 0; f < soup.facets.size(); ++f) {
    const double area = norm(facet_normal_2a(soup, f)) / 2;
    const Vec3 n = facet_normal_2a(soup, f) / (2 * area);
    Eigen::Matrix<double, 6, 1> row;
    row << eigen(cross((soup.corner(f, 0) + soup.corner(f, 1) + soup.corner(f, 2)) / 3, n)), eigen(n);
    h += area * row * row.transpose();
    for (const std::uint32_t p : soup.facets[f]) of_point[p] += area / 3 * row * eigen(n).transpose();
  }
  for (const Matrix63& m : of_point) g += m * m.transpose();
  return h.inverse() * g * h.inverse();
}

// Of where such a motion takes p.
double deviation_at(const Vec3& p, const Matrix6& covariance) {
  Eigen::Matrix<double, 3, 6> by;
  by << 0, p.z, -p.y, 1, 0, 0, -p.z, 0, p.x, 0, 1, 0, p.y, -p.x, 0, 0, 0, 1;
  return std::sqrt((by * covariance * by.transpose()).trace());
}

// No point is off by more than five of its standard deviations.
TEST(Registration, IsAsGoodAsTheNoiseAllows) {
  const TriangleSoup part = odd_part(4);
  const double sigma = 2e-3 * bounding_box(part).diagonal();
  const Matrix6 unit = covariance(part);
  const RigidMotion truth = turn({0, 1, 1}, 1.2, {3, 3, 3});
  for (const unsigned seed : {5u, 6u, 7u, 8u}) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> noise(0, sigma);
    const TriangleSoup noisy = mapped(part, [&](const Vec3& p) { return p + Vec3{noise(random), noise(random), noise(random)}; });
    const Registration r = register_rigidly(noisy, by(truth, part));
    EXPECT_TRUE(r.converged);
    double most = 0;
    for (const Vec3& p : part.points) most = std::max(most, norm(r.motion(p) - truth(p)) / (sigma * deviation_at(p, unit)));
    EXPECT_LT(most, 5) << seed;
  }
}

// The best of all positions is no fit.
TEST(Registration, OtherShapesDoNotConverge) {
  EXPECT_FALSE(register_rigidly(odd_part(4), box({2, 2, 2}, 2, 2, 2)).converged);
}

TEST(Registration, HolesAndFlippedFacetsDoNotMatter) {
  TriangleSoup dirty = odd_part(6);
  std::vector<std::size_t> gone;
  for (std::size_t f = 0; f < dirty.facets.size(); ++f) {
    if (f % 7 == 0) std::swap(dirty.facets[f][1], dirty.facets[f][2]);
    if (f % 13 == 0) gone.push_back(f);
  }
  const RigidMotion truth = turn({2, -1, 1}, 1.9, {-8, 4, 1});
  const TriangleSoup part = odd_part(6);
  const Registration r = register_rigidly(without_facets(dirty, gone), by(truth, part));
  EXPECT_LT(largest_error(part, r.motion, truth), 1e-9);
  EXPECT_TRUE(r.converged);
}

TEST(Registration, APieceMayBeMissing) {
  const TriangleSoup part = odd_part(6);
  std::vector<std::size_t> gone;
  for (std::size_t f = 0; f < part.facets.size(); ++f)
    if (part.corner(f, 0).x > 2.2) gone.push_back(f);
  const RigidMotion truth = turn({1, -1, 3}, 2.9, {10, 0, -4});
  const TriangleSoup scan = by(truth, without_facets(part, gone));
  EXPECT_LT(largest_error(part, register_rigidly(part, scan).motion, truth), 1e-6);
  EXPECT_LT(largest_error(part, register_rigidly(scan, part).motion.inverse(), truth), 1e-6);
}

TEST(Registration, DoesNotMirror) {
  const TriangleSoup part = odd_part(4);
  const Registration r = register_rigidly(mapped(part, [](const Vec3& p) { return Vec3{-p.x, p.y, p.z}; }), part);
  EXPECT_NEAR(dot(cross(r.motion.rows[0], r.motion.rows[1]), r.motion.rows[2]), 1, 1e-12);
  EXPECT_GT(r.rms_after, 1e-3);
}

TEST(Registration, SaysWhatIsNotUnique) {
  const TriangleSoup plane = height_field(4, [](int, int) { return 0.0; });
  EXPECT_EQ(register_rigidly(plane, moved(plane, {0.1, 0, 0.2})).free_motions, 3);
  const TriangleSoup point{{{1, 1, 1}}, {{0, 0, 0}}, {}};
  EXPECT_EQ(register_rigidly(point, plane).free_motions, 6);
  const Registration cubes = register_rigidly(cube(), moved(cube(), {4, 5, 6}));
  EXPECT_LT(cubes.rms_after, 1e-9);
}

}  // namespace
}  // namespace burnish
