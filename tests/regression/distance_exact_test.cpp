// Distances against CGAL's: exact rational arithmetic, and its AABB tree.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <random>

#include "burnish/levelset/distance.h"
#include "burnish/octree/grow.h"
#include "burnish/surface/exact_distance.h"
#include "burnish/surface/triangle_index.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;
using Exact = CGAL::Simple_cartesian<CGAL::Exact_rational>;
using Inexact = CGAL::Simple_cartesian<double>;

Exact::Point_3 exact(const Vec3& p) { return {p.x, p.y, p.z}; }

CGAL::Exact_rational exact_squared(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  // A triangle without area is no triangle to CGAL.
  const Exact::Triangle_3 triangle(exact(a), exact(b), exact(c));
  if (!triangle.is_degenerate()) return CGAL::squared_distance(exact(p), triangle);
  const auto segment = [&](const Vec3& u, const Vec3& v) -> CGAL::Exact_rational {
    if (u == v) return CGAL::squared_distance(exact(p), exact(u));
    return CGAL::squared_distance(exact(p), Exact::Segment_3(exact(u), exact(v)));
  };
  return std::min({segment(a, b), segment(b, c), segment(c, a)});
}

double exact_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  return std::sqrt(CGAL::to_double(exact_squared(p, a, b, c)));
}

double exact_distance(const Vec3& p, const TriangleSoup& soup, std::size_t f) {
  return exact_distance(p, soup.corner(f, 0), soup.corner(f, 1), soup.corner(f, 2));
}

// The exact distance to the closest facet; facets that balls around their centroids exclude are left out.
double exact_distance(const Vec3& p, const TriangleSoup& soup) {
  std::vector<double> low(soup.facets.size());
  double high = std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < soup.facets.size(); ++f) {
    const Vec3 center = (soup.corner(f, 0) + soup.corner(f, 1) + soup.corner(f, 2)) / 3.0;
    double radius = 0;
    for (int i = 0; i < 3; ++i) radius = std::max(radius, norm(soup.corner(f, i) - center));
    const double d = norm(p - center);
    low[f] = d - radius;
    high = std::min(high, d + radius);
    for (int i = 0; i < 3; ++i) high = std::min(high, norm(soup.corner(f, i) - p));
    high = std::min(high, d);
  }
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    if (low[f] <= std::min(high, least) * (1 + 1e-9) + 1e-9) least = std::min(least, exact_distance(p, soup, f));
  return least;
}

Vec3 random_point(std::mt19937& random, double low, double high) {
  std::uniform_real_distribution<double> any(low, high);
  const double x = any(random), y = any(random), z = any(random);
  return {x, y, z};
}

Vec3 random_direction(std::mt19937& random) {
  for (;;) {
    const Vec3 v = random_point(random, -1, 1);
    if (norm(v) > 0.1 && norm(v) < 1) return v / norm(v);
  }
}

// A triangle whose height over its longest side is `slender` times that, 1 to 20. Its third corner is anywhere along the
// longest side, and any corner comes first. `foot` lies inside it, up to
// rounding.
struct Needle {
  std::array<Vec3, 3> corners;
  Vec3 normal;
};

Needle random_needle(std::mt19937& random, const Vec3& foot, double slender) {
  std::uniform_real_distribution<double> part(0.02, 0.98), length(1, 20);
  const Vec3 u = random_direction(random), w = cross(u, random_direction(random)), v = w / norm(w);
  const double l = length(random), along = part(random);
  // The foot's barycentric coordinates decide where the first corner is.
  double s = part(random), t = part(random);
  if (s + t > 1) s = 1 - s, t = 1 - t;
  const Vec3 ab = u * l, ac = u * (l * along) + v * (l * slender);
  const Vec3 a = foot - ab * s - ac * t;
  Needle needle{{a, a + ab, a + ac}, cross(u, v)};
  std::rotate(needle.corners.begin(), needle.corners.begin() + static_cast<std::ptrdiff_t>(random() % 3), needle.corners.end());
  return needle;
}

TriangleSoup needles(std::mt19937& random, std::size_t count, double slender) {
  TriangleSoup soup;
  for (std::uint32_t f = 0; f < count; ++f) {
    const Needle needle = random_needle(random, random_point(random, 41, 87), slender);
    soup.points.insert(soup.points.end(), needle.corners.begin(), needle.corners.end());
    soup.facets.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  return soup;
}

TriangleSoup random_triangles(std::mt19937& random, std::size_t count) {
  TriangleSoup soup;
  for (std::uint32_t f = 0; f < count; ++f) {
    const Vec3 a = random_point(random, 41, 87);
    const double size = std::exp(std::uniform_real_distribution<double>(-5, 3)(random));
    for (int i = 0; i < 3; ++i) soup.points.push_back(a + random_point(random, -size, size));
    soup.facets.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  return soup;
}

// What the numerics promise, in cells.
double allowed(double distance, const TriangleSoup& soup) {
  return 1e-9 * distance + 1e-12 * bounding_box(soup).diagonal();
}

// Compares `queries` random nodes of random leaves near the surface; the soup lies in a domain of 128 cells.
void check_block_distances(const TriangleSoup& soup, double band, int queries, std::mt19937& random) {
  const SurfaceOctree grid = grow_uniform_band(soup, 4, band);
  std::vector<std::uint32_t> near;
  for (std::uint32_t leaf = 0; leaf < grid.octree.size(); ++leaf)
    if (grid.near_surface(leaf)) near.push_back(leaf);
  const ExactDistance exact_distances(soup);
  std::array<double, kBlockNodes> squared;
  std::array<std::uint32_t, kBlockNodes> nearest;
  double worst = 0;
  int within = 0;
  for (int tries = 0; within < queries && tries < 20 * queries; ++tries) {
    const std::uint32_t leaf = near[random() % near.size()];
    exact_squared_distances(soup, grid, leaf, band, {}, squared.data(), nearest.data());
    for (int i = 0; i < 8; ++i) {
      const int n = static_cast<int>(random() % kBlockNodes);
      const LatticeNode node = lattice_node(grid.octree, leaf, n % 8, n / 8 % 8, n / 64);
      const Vec3 p{double(node.x), double(node.y), double(node.z)};
      const double expected = std::sqrt(exact_distances.squared_distance(p));
      const std::uint32_t facet = nearest[static_cast<std::size_t>(n)];
      const double found = std::sqrt(squared[static_cast<std::size_t>(n)]);
      if (expected >= band) {
        EXPECT_LE(found, band);
        EXPECT_GE(found, band - allowed(band, soup));
        if (expected > band + allowed(band, soup)) {
          EXPECT_EQ(facet, kNoFacet);
        }
        continue;
      }
      ++within;
      worst = std::max(worst, std::abs(found - expected) / allowed(expected, soup));
      ASSERT_NE(facet, kNoFacet);
      EXPECT_LE(exact_distance(p, soup, facet), expected + allowed(expected, soup)) << "facet " << facet << " is not the closest";
    }
  }
  EXPECT_GE(within, queries) << "only " << within << " nodes within the band";
  EXPECT_LE(worst, 1) << "in units of 1e-9 d + 1e-12 diagonal";
  testing::Test::RecordProperty("worst", std::to_string(worst));
}

// The class against every facet in rationals, no bound and no index in between.
void check_against_all_facets(const TriangleSoup& soup, const std::vector<Vec3>& points) {
  const ExactDistance distances(soup);
  for (const Vec3& p : points) {
    std::optional<CGAL::Exact_rational> least;
    std::uint32_t first = kNoFacet;
    for (std::uint32_t f = 0; f < soup.facets.size(); ++f) {
      const CGAL::Exact_rational squared = exact_squared(p, soup.corner(f, 0), soup.corner(f, 1), soup.corner(f, 2));
      if (least && squared >= *least) continue;
      least = squared;
      first = f;
    }
    const ExactDistance::Closest found = distances.closest(p);
    ASSERT_EQ(found.facet, first) << "the lowest number among the closest";
    // No double is closer to the rational one.
    const auto error = [&](double d) -> CGAL::Exact_rational { return CGAL::abs(CGAL::Exact_rational(d) - *least); };
    ASSERT_LE(error(found.squared_distance), error(std::nextafter(found.squared_distance, 1e300)));
    ASSERT_LE(error(found.squared_distance), error(std::nextafter(found.squared_distance, -1.0)));
    ASSERT_NEAR(norm(found.point - p), std::sqrt(found.squared_distance), allowed(norm(found.point - p), soup) + 1e-15 * norm(p) + 1e-150);
  }
}

TEST(DistanceExact, CertifiedAgainstAllFacets) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    std::vector<Vec3> points;
    for (int i = 0; i < 20; ++i) points.push_back(random_point(random, 20, 108));
    check_against_all_facets(random_triangles(random, 60), points);
    for (const double slender : {1e-3, 1e-8, 1e-12, 0.0}) check_against_all_facets(needles(random, 40, slender), points);
    TriangleSoup flat = needles(random, 20, 0);
    for (std::uint32_t f = 0; f < 20; f += 2) flat.points[3 * f + 1] = flat.points[3 * f];
    for (std::uint32_t f = 0; f < 20; f += 5) flat.points[3 * f + 2] = flat.points[3 * f + 1] = flat.points[3 * f];
    check_against_all_facets(flat, points);
  }
}

TEST(DistanceExact, CertifiedAmongTiesAndOnTheSurface) {
  std::mt19937 random(4);
  std::vector<Vec3> points{{0.5, 0.5, 0.5}, {0, 0, 0}, {-1, -1, -1}, {0.5, 0.5, 1}, {0.25, 0.25, 0.5}, {0.3, 0.6, 0}};
  check_against_all_facets(cube(), points);
  // All facets at nearly the same distance; then far from the origin; then where squares of squares underflow, and squares.
  const TriangleSoup ball = icosphere(1);
  points.assign(ball.points.begin(), ball.points.begin() + 12);
  points.push_back({});
  for (int i = 0; i < 12; ++i) points.push_back(random_direction(random) * 1e-9);
  check_against_all_facets(ball, points);
  for (Vec3& p : points) p += Vec3{1e6, -1e6, 3e6};
  check_against_all_facets(moved(ball, {1e6, -1e6, 3e6}), points);
  for (Vec3& p : points) p *= 1e-70;
  check_against_all_facets(scaled(moved(ball, {1e6, -1e6, 3e6}), 1e-70), points);
  for (Vec3& p : points) p *= 1e-92;
  check_against_all_facets(scaled(moved(ball, {1e6, -1e6, 3e6}), 1e-162), points);
}

TEST(DistanceExact, CertifiedForNoFacets) {
  const TriangleSoup none;
  const ExactDistance distances(none);
  EXPECT_EQ(distances.closest({1, 2, 3}).facet, kNoFacet);
  EXPECT_EQ(distances.squared_distance({1, 2, 3}), std::numeric_limits<double>::infinity());
}

TEST(DistanceExact, IcospheresOfAllScales) {
  std::mt19937 random(1);
  for (const auto& [level, radius] : {std::pair{0, 50.0}, {1, 20.0}, {2, 50.0}, {3, 3.0}, {4, 12.0}}) {
    SCOPED_TRACE(testing::Message() << "level " << level << ", radius " << radius);
    check_block_distances(moved(scaled(icosphere(level), radius), {64.3, 63.6, 64.2}), 3, 60, random);
  }
}

TEST(DistanceExact, Torus) {
  std::mt19937 random(2);
  check_block_distances(moved(scaled(torus(24, 12), 30), {64.1, 63.7, 64.4}), 4, 100, random);
  check_block_distances(moved(scaled(torus(80, 30), 8), {64.1, 63.7, 64.4}), 2, 60, random);
}

TEST(DistanceExact, FacetsInPlanesAndThroughNodes) {
  std::mt19937 random(3);
  check_block_distances(moved(scaled(cube(), 40), {40, 44, 48}), 3, 100, random);
  check_block_distances(moved(scaled(cube(), 1), {64, 64, 64}), 3, 60, random);
}

TEST(DistanceExact, RandomSoups) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    check_block_distances(random_triangles(random, 80), 3, 60, random);
  }
}

TEST(DistanceExact, Slivers) {
  unsigned seed = 0;
  for (const double slender : {1e-2, 1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-13}) {
    SCOPED_TRACE(testing::Message() << "height over length " << slender << ", seed " << ++seed);
    std::mt19937 random(seed);
    check_block_distances(needles(random, 30, slender), 3, 40, random);
  }
}

// Random nodes hardly ever project into a needle; here every needle is built over a node.
TEST(DistanceExact, NodesOverSlivers) {
  std::array<double, kBlockNodes> squared;
  std::array<std::uint32_t, kBlockNodes> nearest;
  for (const double slender : {1e-1, 1e-3, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-14}) {
    std::mt19937 random(9);
    double worst = 0, worst_point = 0;
    for (int i = 0; i < 100; ++i) {
      const std::array<int, 3> at{50 + static_cast<int>(random() % 28), 50 + static_cast<int>(random() % 28), 50 + static_cast<int>(random() % 28)};
      const Vec3 p{double(at[0]), double(at[1]), double(at[2])};
      const double height = std::exp(std::uniform_real_distribution<double>(-12, 1)(random));
      const Vec3 up = random_direction(random);
      // The needle's normal is only known once it stands: move it so that the node is over its inside.
      Needle needle = random_needle(random, p + up, slender);
      for (Vec3& c : needle.corners) c += needle.normal * height - up;
      const TriangleSoup soup{{needle.corners.begin(), needle.corners.end()}, {{0, 1, 2}}, {}};
      const SurfaceOctree grid = grow_uniform_band(soup, 4, 3);
      const auto block = [&](std::size_t a) { return static_cast<std::uint32_t>(at[a] / 8); };
      const std::uint32_t leaf = grid.octree.find({block(0), block(1), block(2)});
      exact_squared_distances(soup, grid, leaf, 3, {}, squared.data(), nearest.data());
      const double expected = exact_distance(p, soup);
      const double tolerance = allowed(expected, soup);
      const double found = std::sqrt(squared[node_index(at[0] % 8, at[1] % 8, at[2] % 8)]);
      const Vec3 q = closest_point_on_triangle(p, needle.corners[0], needle.corners[1], needle.corners[2]);
      worst = std::max(worst, std::abs(found - expected) / tolerance);
      worst_point = std::max(worst_point, std::abs(norm(q - p) - expected) / tolerance);
      // The point leaves the triangle by what rounding tilts a sliver's normal.
      EXPECT_LE(exact_distance(q, soup), tolerance + expected * 1e-15 / slender) << "height over length " << slender;
    }
    RecordProperty("worst_" + std::to_string(std::lround(-std::log10(slender))), std::to_string(worst));
    EXPECT_LE(worst, 1) << "node distances, height over length " << slender;
    EXPECT_LE(worst_point, 1) << "closest points, height over length " << slender;
  }
}

TEST(DistanceExact, TrianglesWithoutArea) {
  std::mt19937 random(5);
  TriangleSoup soup = needles(random, 20, 0);
  for (std::uint32_t f = 0; f < 20; f += 2) soup.points[3 * f + 1] = soup.points[3 * f];
  for (std::uint32_t f = 0; f < 20; f += 5) soup.points[3 * f + 2] = soup.points[3 * f + 1] = soup.points[3 * f];
  check_block_distances(soup, 3, 60, random);
}

TEST(DistanceExact, ClosestPointOnTriangle) {
  std::mt19937 random(6);
  double worst = 0;
  const auto check = [&](const TriangleSoup& soup, std::size_t f) {
    const Vec3 &a = soup.corner(f, 0), &b = soup.corner(f, 1), &c = soup.corner(f, 2);
    const Vec3 p = (a + b + c) / 3.0 + random_point(random, -10, 10);
    const Vec3 q = closest_point_on_triangle(p, a, b, c);
    const double expected = exact_distance(p, a, b, c);
    const double tolerance = allowed(expected, soup);
    worst = std::max(worst, std::abs(norm(p - q) - expected) / tolerance);
    // The point itself is on the triangle.
    EXPECT_LE(exact_distance(q, a, b, c), tolerance);
  };
  for (const double slender : {0.5, 1e-2, 1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-12, 1e-14, 0.0}) {
    SCOPED_TRACE(testing::Message() << "height over length " << slender);
    const TriangleSoup soup = needles(random, 60, slender);
    worst = 0;
    for (std::size_t f = 0; f < soup.facets.size(); ++f) check(soup, f);
    EXPECT_LE(worst, 1);
  }
}

TEST(DistanceExact, TriangleIndexAgainstBruteForce) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const TriangleSoup soup = random_triangles(random, 400);
    const TriangleIndex index(soup);
    for (int i = 0; i < 300; ++i) {
      const Vec3 p = random_point(random, 20, 108);
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t f = 0; f < soup.facets.size(); ++f)
        least = std::min(least, squared_norm(p - closest_point_on_triangle(p, soup.corner(f, 0), soup.corner(f, 1), soup.corner(f, 2))));
      const TriangleIndex::Closest found = index.closest(p);
      ASSERT_EQ(found.squared_distance, least);
      ASSERT_EQ(squared_norm(p - found.point), least);
      const Vec3 on_facet = closest_point_on_triangle(p, soup.corner(found.facet, 0), soup.corner(found.facet, 1), soup.corner(found.facet, 2));
      ASSERT_EQ(on_facet, found.point);
      // A bound below the distance finds nothing, one above finds the same.
      ASSERT_EQ(index.closest(p, least * 0.999).facet, 0xffffffffu);
      ASSERT_EQ(index.closest(p, least * 1.001).squared_distance, least);
    }
  }
}

TEST(DistanceExact, TriangleIndexAgainstTheTreeOfCgal) {
  using Primitive = CGAL::AABB_triangle_primitive<Inexact, std::vector<Inexact::Triangle_3>::const_iterator>;
  using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Inexact, Primitive>>;
  std::mt19937 random(8);
  for (const TriangleSoup& soup : {icosphere(4), torus(60, 30)}) {
    std::vector<Inexact::Triangle_3> triangles;
    const auto point = [](const Vec3& p) { return Inexact::Point_3(p.x, p.y, p.z); };
    for (std::size_t f = 0; f < soup.facets.size(); ++f)
      triangles.emplace_back(point(soup.corner(f, 0)), point(soup.corner(f, 1)), point(soup.corner(f, 2)));
    const Tree tree(triangles.begin(), triangles.end());
    const TriangleIndex index(soup);
    for (int i = 0; i < 400; ++i) {
      const Vec3 p = random_point(random, -1.5, 1.5);
      const TriangleIndex::Closest found = index.closest(p);
      const auto [q, triangle] = tree.closest_point_and_primitive(point(p));
      const double expected = std::sqrt(CGAL::squared_distance(point(p), q));
      ASSERT_NEAR(std::sqrt(found.squared_distance), expected, 1e-12);
      // Where one facet is the closest by far both name it.
      if (found.facet != triangle - triangles.cbegin()) {
        const auto other = static_cast<std::size_t>(triangle - triangles.cbegin());
        ASSERT_NEAR(exact_distance(p, soup, found.facet), exact_distance(p, soup, other), 1e-12);
      }
    }
  }
}

}  // namespace
}  // namespace burnish
