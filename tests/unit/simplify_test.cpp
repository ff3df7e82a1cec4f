#include "burnish/surface/simplify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/surface/creases.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/weld.h"
#include "support/parts.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

constexpr double kPi = std::numbers::pi;

// Radius 1 about z, from z = 0 to z = height; n facets' edges around, m along.
TriangleSoup cylinder(double height, std::uint32_t n, std::uint32_t m) {
  TriangleSoup s;
  for (std::uint32_t j = 0; j <= m; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const double angle = 2 * kPi * i / n;
      s.points.push_back({std::cos(angle), std::sin(angle), height * j / m});
    }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return j * n + i % n; };
  const auto bottom = static_cast<std::uint32_t>(s.points.size()), top = bottom + 1;
  s.points.push_back({0, 0, 0});
  s.points.push_back({0, 0, height});
  for (std::uint32_t i = 0; i < n; ++i) {
    s.facets.push_back({bottom, at(i + 1, 0), at(i, 0)});
    s.facets.push_back({top, at(i, m), at(i + 1, m)});
    for (std::uint32_t j = 0; j < m; ++j) {
      s.facets.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      s.facets.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return s;
}

// A closed chain of points around, from z = 0 to z = height in m layers, and a point in the middle of each end.
TriangleSoup prism(const std::vector<Vec3>& around, double height, std::uint32_t m) {
  TriangleSoup s = cylinder(height, static_cast<std::uint32_t>(around.size()), m);
  for (std::size_t p = 0; p + 2 < s.points.size(); ++p) s.points[p] = Vec3{around[p % around.size()].x, around[p % around.size()].y, s.points[p].z};
  return s;
}

// n teeth, 8 long and 0.2 high with flanks of 63 degrees: 4 corners each at both ends, and 8 n facets at least.
TriangleSoup gear(int n) {
  const double radius = 16 * n / (2 * kPi), flank = 0.1 / radius;
  std::vector<Vec3> around;
  for (int i = 0; i < n; ++i)
    for (const auto& [at, r] : {std::pair{0.0, radius}, {flank, radius + 0.2}, {kPi / n, radius + 0.2}, {kPi / n + flank, radius}}) {
      const double angle = 2 * kPi * i / n + at;
      around.push_back({r * std::cos(angle), r * std::sin(angle), 0});
    }
  return prism(around, 30, 6);
}

double largest(const SimplifiedSurface& r) { return std::max(r.deviation.input_to_output.max, r.deviation.output_to_input.max); }

double rms_to_unit_sphere(const TriangleSoup& soup) {
  double sum = 0, weight = 0;
  for (std::size_t f = 0; f < soup.facets.size(); ++f) {
    const double area = norm(facet_normal_2a(soup, f));
    for (int i = 0; i < 3; ++i) {  // the rule of degree 2, exact enough for what is nearly quadratic
      const Vec3 p = soup.corner(f, i) * (2.0 / 3) + (soup.corner(f, (i + 1) % 3) + soup.corner(f, (i + 2) % 3)) * (1.0 / 6);
      const double d = norm(p) - 1;
      sum += area * d * d;
      weight += area;
    }
  }
  return std::sqrt(sum / weight);
}

TEST(Simplify, ACubesFacesGoToTwoFacetsEach) {
  const TriangleSoup cube = box({1, 1, 1}, 9, 9, 9);
  const SimplifiedSurface r = simplify(cube, {.deviation = 1e-9});
  EXPECT_EQ(r.soup.facets.size(), 12u);
  ASSERT_EQ(r.soup.points.size(), 8u);
  for (const Vec3& p : r.soup.points)
    for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(p[axis] == 0 || p[axis] == 1);
  EXPECT_EQ(signed_volume(r.soup), 1);
  EXPECT_TRUE(inspect(r.soup).defects.valid_solid());
  EXPECT_EQ(r.collapsed, (cube.facets.size() - 12) / 2);
}

TEST(Simplify, CylindersKeepTheirRims) {
  const TriangleSoup given = cylinder(2, 96, 24);
  const double sagitta = 1 - std::cos(kPi / 96);
  const SimplifiedSurface r = simplify(given, {.deviation = 0.01});
  EXPECT_LT(r.soup.facets.size(), given.facets.size() / 20);
  EXPECT_TRUE(inspect(r.soup).defects.valid_solid());
  const Creases creases = find_creases(r.soup);
  ASSERT_EQ(creases.chains.size(), 2u);
  for (const auto& chain : creases.chains) {
    EXPECT_EQ(chain.front(), chain.back());
    for (const std::uint32_t p : chain) {
      const Vec3& at = r.soup.points[p];
      EXPECT_LT(std::min(std::abs(at.z), std::abs(at.z - 2)), 1e-3);
      EXPECT_NEAR(std::hypot(at.x, at.y), 1, 0.01 + sagitta);
    }
  }
}

// Quadrics leave an error that is proportional to the area of a facet.
TEST(Simplify, SpheresAreOffByOrderTwo) {
  const TriangleSoup given = icosphere(6);
  const SimplifiedSurface fine = simplify(given, {.facets = 8192}), coarse = simplify(given, {.facets = 2048});
  EXPECT_EQ(fine.soup.facets.size(), 8192u);
  EXPECT_EQ(coarse.soup.facets.size(), 2048u);
  const double ratio = rms_to_unit_sphere(coarse.soup) / rms_to_unit_sphere(fine.soup);
  EXPECT_GT(ratio, 3.3);
  EXPECT_LT(ratio, 4.8);
  // Equilateral facets of the same area on the sphere, best placed: sagitta of the edge / sqrt(20) or so.
  EXPECT_LT(rms_to_unit_sphere(fine.soup), 0.5 * 4 * kPi / 8192);
  EXPECT_NEAR(signed_volume(fine.soup), 4 * kPi / 3, 0.001 * 4 * kPi / 3);
  for (const SimplifiedSurface* r : {&fine, &coarse}) EXPECT_TRUE(inspect(r->soup).defects.valid_solid());
}

TEST(Simplify, CountsAreReached) {
  const TriangleSoup given = torus(60, 40);
  for (const std::size_t count : {4799u, 4000u, 1001u, 500u, 100u}) {
    const SimplifiedSurface r = simplify(given, {.facets = count});
    EXPECT_TRUE(r.reached) << r.why_not;
    EXPECT_LE(std::abs(static_cast<double>(r.soup.facets.size()) - static_cast<double>(count)), 1) << count;
    const Defects d = inspect(r.soup).defects;
    EXPECT_TRUE(d.valid_solid());
    EXPECT_EQ(d.points, d.facets / 2);  // genus 1
  }
}

TEST(Simplify, ACountBelowWhatTopologyAllowsIsNotReached) {
  const SimplifiedSurface r = simplify(torus(20, 10), {.facets = 4});
  EXPECT_FALSE(r.reached);
  EXPECT_NE(r.why_not, "");
  EXPECT_TRUE(inspect(r.soup).defects.valid_solid());
}

// Each point a spike or a pit: creases all over, for which a tenth of the facets has no room.
TEST(Simplify, CreasesWithoutRoomGiveWay) {
  std::size_t i = 0;
  const TriangleSoup given = mapped(icosphere(4), [&](const Vec3& p) { return p * (i++ % 3 == 0 ? 1.06 : 1.0); });
  ASSERT_GT(find_creases(given).corners.size(), 500u);
  const SimplifiedSurface r = simplify(given, {.facets = 512});
  EXPECT_TRUE(r.reached) << r.why_not;
  EXPECT_GT(r.crease_angle, 40);
  EXPECT_TRUE(inspect(r.soup).defects.valid_solid());
  EXPECT_NEAR(signed_volume(r.soup), signed_volume(given), 0.05 * signed_volume(given));
}

TEST(Simplify, CreasesThatFitTheCountStay) {
  const TriangleSoup given = gear(50);
  ASSERT_EQ(find_creases(given).corners.size(), 400u);
  const SimplifiedSurface r = simplify(given, {.facets = 820});
  EXPECT_TRUE(r.reached) << r.why_not;
  EXPECT_EQ(r.crease_angle, 40);
  EXPECT_NEAR(static_cast<double>(r.soup.facets.size()), 820, 1);
  EXPECT_LT(largest(r), 1e-9);
}

TEST(Simplify, ACountBesideADeviationIsNoWorseThanTheDeviation) {
  const TriangleSoup given = gear(50);
  const SimplifiedSurface alone = simplify(given, {.deviation = 0.001}), both = simplify(given, {.facets = 200, .deviation = 0.001});
  EXPECT_LE(both.soup.facets.size(), alone.soup.facets.size());
  EXPECT_FALSE(both.reached);
  EXPECT_NE(both.why_not, "");
  EXPECT_LE(largest(both), 0.001);
  EXPECT_GT(both.verified_samples, 0u);
}

// 64 corners take 124 facets; within 2.0, ten times the height of the teeth, fewer do.
TEST(Simplify, CreasesGiveWayWithinTheDeviation) {
  const SimplifiedSurface r = simplify(gear(8), {.facets = 40, .deviation = 2.0});
  EXPECT_TRUE(r.reached) << r.why_not;
  EXPECT_GT(r.crease_angle, 40);
  EXPECT_LE(largest(r), 2.0);
}

TEST(Simplify, MoreFacetsThanThereAreChangeNothing) {
  const SimplifiedSurface r = simplify(icosphere(2), {.facets = 1000});
  EXPECT_EQ(r.collapsed, 0u);
  EXPECT_TRUE(r.reached);
  EXPECT_EQ(r.soup.points, icosphere(2).points);
}

TEST(Simplify, SheetsKeepTheirBorder) {
  const TriangleSoup given = height_field(40, [](int i, int j) { return 0.05 * std::sin(0.3 * i) * std::sin(0.25 * j); });
  const SimplifiedSurface r = simplify(given, {.facets = 400, .deviation = 0.01});
  EXPECT_TRUE(r.reached) << r.why_not;
  EXPECT_TRUE(inspect(r.soup).defects.valid_sheet());
  double flat_area = 0;
  for (std::size_t f = 0; f < r.soup.facets.size(); ++f) flat_area += 0.5 * facet_normal_2a(r.soup, f).z;
  EXPECT_NEAR(flat_area, 1, 1e-3);
  for (const double x : {0.0, 1.0})
    for (const double y : {0.0, 1.0})
      EXPECT_TRUE(std::any_of(r.soup.points.begin(), r.soup.points.end(), [&](const Vec3& p) { return p.x == x && p.y == y; }));
}

// Two sheets 0.02 apart, bent: fewer facets than the bend needs would pass through each other.
TEST(Simplify, ThinShellsDoNotIntersect) {
  const auto bend = [](const Vec3& p) {
    const double angle = 3 * p.x, radius = 0.3 + p.z;
    return Vec3{radius * std::sin(angle), p.y, -radius * std::cos(angle)};
  };
  const TriangleSoup given = mapped(box({1, 0.6, 0.02}, 80, 48, 2), bend);
  ASSERT_TRUE(inspect(given).defects.valid_solid() || inspect(flipped(given)).defects.valid_solid());
  for (const std::size_t count : {2000u, 200u, 60u}) {
    const SimplifiedSurface r = simplify(given, {.facets = count});
    const Defects d = inspect(r.soup).defects;
    EXPECT_TRUE(d.closed_manifold());
    EXPECT_EQ(d.self_intersecting_pairs, 0u) << count;
    EXPECT_GT(std::abs(signed_volume(r.soup)), 0.5 * std::abs(signed_volume(given))) << count;
  }
}

TEST(Simplify, CornersAndCreasesOfPartsStay) {
  const TriangleSoup given = weld(bracket(8));
  const SimplifiedSurface r = simplify(given, {.deviation = 0.004});
  EXPECT_TRUE(inspect(r.soup).defects.valid_solid());
  EXPECT_LT(r.soup.facets.size(), given.facets.size() / 3);
  const std::set<Vec3> points(r.soup.points.begin(), r.soup.points.end());
  const Creases before = find_creases(given);
  ASSERT_FALSE(before.corners.empty());
  for (const std::uint32_t p : before.corners) EXPECT_TRUE(points.contains(given.points[p]));
  EXPECT_EQ(find_creases(r.soup).corners.size(), before.corners.size());
  EXPECT_NEAR(signed_volume(r.soup), signed_volume(given), 0.01 * signed_volume(given));
}

TEST(Simplify, SameBitsForAnyThreadsAndPowersOfTwo) {
  const TriangleSoup given = torus(80, 50);
  const SimplifyOptions options{.facets = 900, .deviation = 0.02};
  const auto on_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return simplify(given, options).soup;
  };
  const TriangleSoup one = on_threads(1), four = on_threads(4);
  EXPECT_EQ(one.points, four.points);
  EXPECT_EQ(one.facets, four.facets);
  const TriangleSoup large = simplify(scaled(given, 1024), {.facets = 900, .deviation = 0.02 * 1024}).soup;
  EXPECT_EQ(scaled(one, 1024).points, large.points);
  EXPECT_EQ(one.facets, large.facets);
}

TEST(Simplify, FarFromTheOriginNothingIsLost) {
  const SimplifiedSurface r = simplify(moved(box({1, 1, 1}, 6, 6, 6), {1 << 12, 0, -(1 << 12)}), {.deviation = 1e-6});
  EXPECT_EQ(r.soup.facets.size(), 12u);
}

TEST(Simplify, WhatIsNoManifoldIsRefused) {
  EXPECT_THROW(simplify(with_flipped_facet(cube(), 3), {.facets = 4}), Error);
  EXPECT_THROW(simplify(with_copied_facet(cube(), 3), {.facets = 4}), Error);
  EXPECT_THROW(simplify(cube(), {.deviation = -1.0}), Error);
  EXPECT_THROW(simplify(cube(), {.deviation = std::numeric_limits<double>::quiet_NaN()}), Error);
}

TEST(Simplify, CanBeStopped) {
  class Stopped : public Progress {
    bool cancelled() const override { return true; }
  } stopped;
  try {
    simplify(icosphere(5), {.facets = 100}, stopped);
    FAIL() << "went on";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::interrupted);
  }
}

}  // namespace
}  // namespace burnish
