#include "burnish/surface/remesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/surface/compare.h"
#include "burnish/surface/creases.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/weld.h"
#include "support/facet_angles.h"
#include "support/parts.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

double share_of_angles_below(const TriangleSoup& soup, double degrees) {
  std::size_t count = 0;
  for (std::size_t f = 0; f < soup.facets.size(); ++f) count += least_angle(soup, f) < degrees;
  return static_cast<double>(count) / static_cast<double>(soup.facets.size());
}

void expect_points_on(const TriangleSoup& soup, const TriangleSoup& surface) {
  const TriangleIndex index(surface);
  for (const Vec3& p : soup.points) ASSERT_LT(index.closest(p).squared_distance, 1e-24);
}

TEST(Remesh, ASphereGetsFacetsOfOneSize) {
  const TriangleSoup given = icosphere(5);
  for (const double edge : {0.15, 0.03}) {  // coarser and finer than given
    const RemeshedSurface r = remesh(given, {.edge = edge});
    EXPECT_EQ(r.held_facets, 0u);
    EXPECT_TRUE(inspect(r.soup).defects.valid_solid());
    EXPECT_NEAR(mean_edge_length(r.soup), edge, 0.1 * edge);
    EXPECT_LT(share_of_angles_below(r.soup, 30), 0.01);
    expect_points_on(r.soup, given);
    // Chords of both surfaces: edges up to 4/3 of the length aimed at, and given ones up to 0.043.
    const double chord = 4.0 / 3 * edge + 0.043;
    EXPECT_LT(one_sided_distance(given, TriangleIndex(r.soup)).max, chord * chord / 8);
  }
}

TEST(Remesh, ACubeKeepsItsEdgesAndCorners) {
  const RemeshedSurface r = remesh(cube(), {.edge = 0.1});
  EXPECT_TRUE(inspect(r.soup).defects.valid_solid());
  EXPECT_NEAR(signed_volume(r.soup), 1, 1e-12);
  EXPECT_NEAR(area(r.soup), 6, 1e-12);
  const Creases creases = find_creases(r.soup);
  EXPECT_EQ(creases.chains.size(), 12u);
  EXPECT_EQ(creases.corners.size(), 8u);
  for (const std::uint32_t p : creases.corners)
    for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(r.soup.points[p][axis] == 0 || r.soup.points[p][axis] == 1);
  EXPECT_LT(share_of_angles_below(r.soup, 30), 0.02);
}

TEST(Remesh, PartsKeepTheirTopologyAndCorners) {
  const TriangleSoup given = weld(bracket(16));
  const RemeshedSurface r = remesh(given, {.edge = 0.08});
  const Defects before = inspect(given).defects, after = inspect(r.soup).defects;
  EXPECT_TRUE(after.valid_solid());
  EXPECT_EQ(static_cast<std::ptrdiff_t>(after.points) - static_cast<std::ptrdiff_t>(after.facets / 2),
            static_cast<std::ptrdiff_t>(before.points) - static_cast<std::ptrdiff_t>(before.facets / 2));
  expect_points_on(r.soup, given);
  const std::set<Vec3> points(r.soup.points.begin(), r.soup.points.end());
  for (const std::uint32_t p : find_creases(given).corners) EXPECT_TRUE(points.contains(given.points[p]));
}

TEST(Remesh, SheetsKeepTheirBorder) {
  const TriangleSoup given = height_field(30, [](int i, int j) { return 0.05 * std::sin(0.4 * i) * std::sin(0.3 * j); });
  const RemeshedSurface r = remesh(given, {.edge = 0.05});
  EXPECT_TRUE(inspect(r.soup).defects.valid_sheet());
  double flat_area = 0;
  for (std::size_t f = 0; f < r.soup.facets.size(); ++f) flat_area += 0.5 * facet_normal_2a(r.soup, f).z;
  EXPECT_NEAR(flat_area, 1, 1e-12);
}

// Edges of six times the thickness on a plate bent by half a turn: chords of one side would cross the other.
TEST(Remesh, ThinShellsDoNotIntersect) {
  const auto bend = [](const Vec3& p) {
    const double angle = 3 * p.x, radius = 0.3 + p.z;
    return Vec3{radius * std::sin(angle), p.y, -radius * std::cos(angle)};
  };
  const TriangleSoup given = mapped(box({1, 0.6, 0.02}, 80, 48, 2), bend);
  for (const double edge : {0.02, 0.05, 0.12}) {
    const RemeshedSurface r = remesh(given, {.edge = edge});
    const Defects d = inspect(r.soup).defects;
    EXPECT_TRUE(d.closed_manifold()) << edge;
    EXPECT_EQ(d.self_intersecting_pairs, 0u) << edge;
    EXPECT_NEAR(std::abs(signed_volume(r.soup)), std::abs(signed_volume(given)), 0.25 * std::abs(signed_volume(given))) << edge;
  }
}

// Edges of 50 times what parts a ball from its cavity: both stay. The balls beside them do not.
TEST(Remesh, ShellsThatCannotBeRemeshedHoldNoOthers) {
  const TriangleSoup hollow = merged(icosphere(4), flipped(scaled(icosphere(4), 0.99))), ball = icosphere(4);
  const TriangleSoup given = merged(moved(ball, {2.2, 0, 0}), merged(hollow, moved(ball, {-2.2, 0, 0})));
  ASSERT_TRUE(inspect(given).defects.valid_solid());
  const RemeshedSurface r = remesh(given, {.edge = 0.5});
  EXPECT_TRUE(inspect(r.soup).defects.valid_solid());
  EXPECT_GT(r.held_facets, 0u);
  EXPECT_LE(r.held_facets, hollow.facets.size());
  EXPECT_EQ(r.why_not, "");
  expect_points_on(r.soup, given);
  const TriangleSoup alone = remesh(ball, {.edge = 0.5}).soup;
  for (const double side : {-1.0, 1.0}) {
    const auto beyond = std::count_if(r.soup.facets.begin(), r.soup.facets.end(), [&](const Facet& f) { return r.soup.points[f[0]].x * side > 1.1; });
    EXPECT_NEAR(static_cast<double>(beyond), static_cast<double>(alone.facets.size()), 0.2 * static_cast<double>(alone.facets.size()));
  }
}

// A rod of 1 x 1 that is rolled out to 0.02 in its middle and wavy there.
TEST(Remesh, WhatIsFarFromWhatIsWrongIsRemeshed) {
  const TriangleSoup given = mapped(box({12, 1, 1}, 240, 20, 20), [](const Vec3& p) {
    const double x = p.x - 6, thin = std::exp(-x * x / 0.5);
    return Vec3{x, p.y, (p.z - 0.5) * (1 - 0.98 * thin) + 0.4 * std::sin(9 * x) * thin};
  });
  const RemeshedSurface r = remesh(given, {.edge = 0.5});
  const Defects d = inspect(r.soup).defects;
  EXPECT_TRUE(d.closed_manifold());
  EXPECT_EQ(d.self_intersecting_pairs, 0u);
  EXPECT_EQ(r.why_not, "");
  EXPECT_GT(r.held_facets, 0u);
  EXPECT_LT(r.held_facets, given.facets.size() / 2);
  // Beyond 4 from the middle on each side only facets of the length aimed at: 18 of area in all, 0.43 edge^2 each, and as many again at most.
  const auto far = std::count_if(r.soup.facets.begin(), r.soup.facets.end(), [&](const Facet& f) { return std::abs(r.soup.points[f[0]].x) > 4; });
  EXPECT_LT(far, 2 * 18 / (0.43 * 0.25));
}

TEST(Remesh, SameBitsEveryTime) {
  const TriangleSoup given = torus(60, 30);
  const auto on_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return remesh(given, {.edge = 0.07}).soup;
  };
  const TriangleSoup one = on_threads(1), four = on_threads(4);
  EXPECT_EQ(one.points, four.points);
  EXPECT_EQ(one.facets, four.facets);
}

TEST(Remesh, WrongOptionsAndSurfacesAreRefused) {
  for (const double edge : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(remesh(cube(), {.edge = edge}), Error);
  EXPECT_THROW(remesh(with_flipped_facet(cube(), 3), {.edge = 0.5}), Error);
}

TEST(Remesh, CanBeStopped) {
  class Stopped : public Progress {
    bool cancelled() const override { return true; }
  } stopped;
  EXPECT_THROW(remesh(icosphere(5), {.edge = 0.02}, stopped), Error);
}

}  // namespace
}  // namespace burnish
