#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <random>

#include "burnish/surface/boundary_caps.h"
#include "burnish/surface/orient.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/weld.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

// What the hierarchy's first-order expansions leave, at most (measured: 0.058 for a ball).
constexpr double kFast = 0.04;

Vec3 random_point(std::mt19937& random, double low, double high) {
  std::uniform_real_distribution<double> any(low, high);
  const double x = any(random), y = any(random), z = any(random);
  return {x, y, z};
}

// The sum of all facets' solid angles: the winding number without a hierarchy.
double exact_winding(const TriangleSoup& soup, const Vec3& p) {
  double w = 0;
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    w += solid_angle_fraction(p, soup.corner(f, 0), soup.corner(f, 1), soup.corner(f, 2));
  return w;
}

TEST(SolidAngle, OfAnOctantIsAnEighth) {
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  EXPECT_NEAR(solid_angle_fraction({0, 0, 0}, x, y, z), 1.0 / 8, 1e-15);
  EXPECT_NEAR(solid_angle_fraction({0, 0, 0}, y, x, z), -1.0 / 8, 1e-15);
  EXPECT_NEAR(solid_angle_fraction({0, 0, 0}, x * 7, y * 0.01, z * 1e6), 1.0 / 8, 1e-15);
}

TEST(SolidAngle, OfACubesFaceIsASixth) {
  EXPECT_NEAR(solid_angle_fraction({0, 0, 0}, {1, -1, -1}, {1, 1, -1}, {1, 1, 1}) +
                  solid_angle_fraction({0, 0, 0}, {1, -1, -1}, {1, 1, 1}, {1, -1, 1}),
              1.0 / 6, 1e-15);
}

TEST(SolidAngle, TendsToAHalfAtTheFacetAndVanishesInItsPlane) {
  const Vec3 a{0, 0, 0}, b{3, 0, 0}, c{0, 3, 0};
  EXPECT_NEAR(solid_angle_fraction({1, 1, -1e-9}, a, b, c), 0.5, 1e-8);
  EXPECT_NEAR(solid_angle_fraction({1, 1, +1e-9}, a, b, c), -0.5, 1e-8);
  EXPECT_EQ(solid_angle_fraction({1, 1, 0}, a, b, c), 0);
  EXPECT_EQ(solid_angle_fraction({5, 5, 0}, a, b, c), 0);
  EXPECT_EQ(solid_angle_fraction(a, a, b, c), 0);
}

TEST(WindingNumber, IsOneInsideAndZeroOutsideClosedShapes) {
  std::mt19937 random(1);
  double worst = 0, worst_exact = 0;
  const auto check = [&](const TriangleSoup& soup, const auto& signed_distance, double margin) {
    const TriangleIndex index(soup);
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p = random_point(random, -2, 2);
      const double d = signed_distance(p);
      if (std::abs(d) < margin) continue;
      const double expected = d > 0 ? 1 : 0;
      worst = std::max(worst, std::abs(index.winding_number(p) - expected));
      if (i % 10 == 0) worst_exact = std::max(worst_exact, std::abs(exact_winding(soup, p) - expected));
    }
  };
  check(icosphere(4), [](const Vec3& p) { return 1 - norm(p); }, 0.01);
  check(torus(90, 40), [](const Vec3& p) { return 0.4 - std::hypot(std::hypot(p.x, p.y) - 1, p.z); }, 0.01);
  check(moved(scaled(cube(), 2), {-1, -1, -1}),
        [](const Vec3& p) { return 1 - std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }, 1e-6);
  RecordProperty("worst", std::to_string(worst));
  EXPECT_LE(worst, kFast);
  EXPECT_LE(worst_exact, 1e-12);
}

TEST(WindingNumber, CountsOverlapsAndSigns) {
  const TriangleSoup ball = icosphere(3);
  const TriangleSoup right = moved(ball, {1, 0, 0});
  const TriangleIndex both(merged(ball, right)), minus(merged(ball, flipped(scaled(ball, 0.5)))), inverted(flipped(ball));
  EXPECT_NEAR(both.winding_number({0.5, 0.1, 0.05}), 2, kFast);
  EXPECT_NEAR(both.winding_number({-0.5, 0.1, 0}), 1, kFast);
  EXPECT_NEAR(both.winding_number({1.5, 0.1, 0}), 1, kFast);
  EXPECT_NEAR(both.winding_number({0.5, 1.1, 0}), 0, kFast);
  EXPECT_NEAR(minus.winding_number({0.1, 0.1, 0.1}), 0, kFast);
  EXPECT_NEAR(minus.winding_number({0.5, 0.5, 0.2}), 1, kFast);
  EXPECT_NEAR(inverted.winding_number({0.1, 0.2, 0.3}), -1, kFast);
}

// At the centre every sphere facet spans its own solid angle; on the axis of a spherical cap that is a formula.
TEST(WindingNumber, OfAHemisphereIsItsSolidAngle) {
  const TriangleSoup ball = icosphere(5);
  std::vector<std::size_t> lower;
  for (std::size_t f = 0; f < ball.facets.size(); ++f)
    if (ball.corner(f, 0).z + ball.corner(f, 1).z + ball.corner(f, 2).z < 0) lower.push_back(f);
  const TriangleSoup upper = without_facets(ball, lower);
  const TriangleIndex index(upper);
  const double missing = static_cast<double>(lower.size()) / static_cast<double>(ball.facets.size());
  EXPECT_NEAR(exact_winding(upper, {0, 0, 0}), 1 - missing, 0.01);
  EXPECT_NEAR(index.winding_number({0, 0, 0}), 1 - missing, kFast);
  for (const double z : {-2.0, -0.5, 0.3, 0.7, 1.5}) {
    // The disc closes the hemisphere: its solid angle, seen from the axis, is what is missing.
    const double disc = (z == 0 ? 1 : 1 - std::abs(z) / std::hypot(1, z)) / 2 * (z > 0 ? 1 : -1);
    const double closed = z > 0 && z < 1 ? 1 : 0;
    EXPECT_NEAR(exact_winding(upper, {0, 0, z}), closed - disc, 0.012) << "z = " << z;
    EXPECT_NEAR(index.winding_number({0, 0, z}), exact_winding(upper, {0, 0, z}), kFast) << "z = " << z;
  }
}

TEST(WindingNumber, OfNothingIsZero) { EXPECT_EQ(TriangleIndex(TriangleSoup{}).winding_number({0, 0, 0}), 0); }

TEST(Orient, TurnsFlippedFacetsBack) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const TriangleSoup clean = icosphere(3);
    std::vector<std::size_t> order(clean.facets.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::shuffle(order.begin(), order.end(), random);
    const std::size_t count = 1 + random() % 500;  // of 1280
    TriangleSoup soup = clean;
    for (std::size_t i = 0; i < count; ++i) soup = with_flipped_facet(std::move(soup), order[i]);
    const OrientedSoup oriented = orient(soup);
    EXPECT_EQ(oriented.facets_flipped, count);
    EXPECT_EQ(oriented.patches, 1u);
    EXPECT_EQ(oriented.patches_flipped, 0u);
    EXPECT_EQ(oriented.soup.facets, clean.facets);
  }
}

TEST(Orient, MoreFlippedThanNotIsAWholePatch) {
  TriangleSoup soup = icosphere(2);
  for (std::size_t f = 0; f < 200; ++f) soup = with_flipped_facet(std::move(soup), f);  // of 320
  const OrientedSoup oriented = orient(soup);
  EXPECT_EQ(oriented.soup.facets, icosphere(2).facets);
  EXPECT_EQ(oriented.facets_flipped, 200u);
  EXPECT_EQ(oriented.patches_flipped, 1u);
}

TEST(Orient, ComponentsInsideOutAreTurnedAndOthersAreNot) {
  const TriangleSoup good = icosphere(2), bad = flipped(moved(torus(30, 12), {4, 0.3, 0.2}));
  const OrientedSoup oriented = orient(merged(good, bad));
  EXPECT_EQ(oriented.patches, 2u);
  EXPECT_EQ(oriented.patches_flipped, 1u);
  EXPECT_EQ(oriented.facets_flipped, bad.facets.size());
  EXPECT_NEAR(signed_volume(oriented.soup), signed_volume(good) - signed_volume(bad), 1e-12);
  const OrientedSoup clean = orient(merged(good, flipped(bad)));
  EXPECT_EQ(clean.facets_flipped, 0u);
}

TEST(Orient, CavitiesStayAsTheyAre) {
  const TriangleSoup shell = icosphere(3), hollow = merged(shell, flipped(scaled(icosphere(2), 0.5)));
  EXPECT_EQ(orient(hollow).soup.facets, hollow.facets);
  const TriangleSoup nested = merged(shell, scaled(icosphere(2), 0.5));
  EXPECT_EQ(orient(nested).soup.facets, nested.facets);
}

// A cube's six faces as patches of their own, each orientation at random.
TEST(Orient, LoosePatchesFaceOutwards) {
  for (unsigned mask = 0; mask < 64; mask += 7) {
    SCOPED_TRACE(testing::Message() << "flipped faces " << mask);
    TriangleSoup soup = cube();
    for (std::size_t face = 0; face < 6; ++face)
      if (mask >> face & 1) soup = with_flipped_facet(with_flipped_facet(std::move(soup), 2 * face), 2 * face + 1);
    // Unshared between faces, shared within one.
    TriangleSoup loose;
    for (std::size_t face = 0; face < 6; ++face)
      loose = merged(std::move(loose), weld(TriangleSoup{soup.points, {soup.facets[2 * face], soup.facets[2 * face + 1]}, {}}));
    const OrientedSoup oriented = orient(loose);
    EXPECT_EQ(oriented.patches, 6u);
    EXPECT_EQ(oriented.patches_flipped, static_cast<std::size_t>(std::popcount(mask)));
    EXPECT_NEAR(signed_volume(oriented.soup), 1, 1e-12);
  }
}

// How often every edge is run from its lower to its upper point, less the opposite: the chain's boundary.
std::map<std::pair<std::uint32_t, std::uint32_t>, int> boundary(const TriangleSoup& soup) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> net;
  for (const Facet& f : soup.facets)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = f[i], b = f[(i + 1) % 3];
      net[std::minmax(a, b)] += a < b ? 1 : a > b ? -1 : 0;
    }
  std::erase_if(net, [](const auto& entry) { return entry.second == 0; });
  return net;
}

TEST(BoundaryCaps, DirectedEdgesSumToZeroWhateverIsMissing) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    std::mt19937 random(seed);
    const double share = std::uniform_real_distribution<double>(0, 0.6)(random);
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", share of facets missing " << share);
    const TriangleSoup ball = icosphere(3);
    std::vector<std::size_t> missing;
    for (std::size_t f = 0; f < ball.facets.size(); ++f)
      if (std::uniform_real_distribution<double>(0, 1)(random) < share) missing.push_back(f);
    TriangleSoup open = without_facets(ball, missing);
    if (seed % 2 == 0)  // and a few flipped ones
      for (int i = 0; i < 20; ++i) open = with_flipped_facet(std::move(open), random() % open.facets.size());
    const CappedSoup capped = cap_boundary(open);
    EXPECT_TRUE(boundary(capped.soup).empty());
    ASSERT_EQ(capped.first_cap_facet, open.facets.size());
    EXPECT_TRUE(std::equal(open.facets.begin(), open.facets.end(), capped.soup.facets.begin()));
    // The winding number of a closed chain is an integer anywhere off it.
    for (int i = 0; i < 5; ++i) {
      const double w = exact_winding(capped.soup, random_point(random, -1.1, 1.1));
      EXPECT_NEAR(w, std::round(w), 1e-9);
    }
  }
}

TEST(BoundaryCaps, ClosedSurfacesGetNone) {
  const CappedSoup capped = cap_boundary(merged(icosphere(2), torus(20, 10)));
  EXPECT_EQ(capped.caps.size(), 0u);
  EXPECT_EQ(capped.cap_area, 0);
  EXPECT_EQ(capped.first_cap_facet, capped.soup.facets.size());
}

TEST(BoundaryCaps, OfPlanarLoopsHaveTheLoopsArea) {
  // A cube without its top: the cap is the top.
  const CappedSoup box = cap_boundary(without_facets(cube(), {2, 3}));
  EXPECT_EQ(box.caps.size(), 1u);
  EXPECT_NEAR(box.cap_area, 1, 1e-14);
  EXPECT_NEAR(signed_volume(box.soup), 1, 1e-14);
  // An L: not convex, so that a fan from its centroid would be larger. Walls of height 1 around it, and its floor.
  const std::vector<std::array<double, 2>> corners{{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};
  TriangleSoup tub;
  for (const double z : {0.0, 1.0})
    for (const auto& [x, y] : corners) tub.points.push_back({x, y, z});
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t j = (i + 1) % 6;
    tub.facets.push_back({i, j, j + 6});
    tub.facets.push_back({i, j + 6, i + 6});
  }
  tub.facets.insert(tub.facets.end(), {{0, 3, 1}, {1, 3, 2}, {0, 5, 3}, {3, 5, 4}});
  ASSERT_EQ(boundary(tub).size(), 6u);
  const CappedSoup capped = cap_boundary(tub);
  EXPECT_EQ(capped.caps.size(), 1u);
  EXPECT_NEAR(capped.cap_area, 5, 1e-13);
  EXPECT_NEAR(signed_volume(capped.soup), 5, 1e-13);
}

// More than 256 edges: a membrane of rings, in the plane of a flat loop.
TEST(BoundaryCaps, LongPlanarLoopsToo) {
  constexpr std::uint32_t n = 400;
  TriangleSoup cone;
  cone.points.push_back({0.2, 0.1, -1});
  for (std::uint32_t i = 0; i < n; ++i) {
    const double t = 2 * std::numbers::pi * i / n;
    cone.points.push_back({std::cos(t), 0.7 * std::sin(t), 0});
    cone.facets.push_back({0, 1 + (i + 1) % n, 1 + i});
  }
  const CappedSoup capped = cap_boundary(cone);
  const double disc = 0.7 * 0.5 * n * std::sin(2 * std::numbers::pi / n);
  EXPECT_TRUE(boundary(capped.soup).empty());
  EXPECT_NEAR(capped.cap_area, disc, 1e-9);
  EXPECT_NEAR(signed_volume(capped.soup), disc / 3, 1e-9);
}

TEST(BoundaryCaps, RestoreTheVolumeOfABallWithHoles) {
  const TriangleSoup ball = icosphere(4);
  std::vector<std::size_t> missing;
  for (std::size_t f = 0; f < ball.facets.size(); ++f)
    for (const Vec3& hole : {Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0.6, 0.6, 0.53}})
      if (norm(ball.corner(f, 0) - hole) < 0.2) missing.push_back(f);
  const CappedSoup capped = cap_boundary(without_facets(ball, missing));
  EXPECT_EQ(capped.caps.size(), 3u);
  EXPECT_TRUE(boundary(capped.soup).empty());
  // A cap of base radius a has the volume pi a^4 / 4 of this unit ball: three of 0.2 make 0.1 %.
  EXPECT_NEAR(signed_volume(capped.soup), signed_volume(ball), 2e-3 * signed_volume(ball));
  EXPECT_LT(signed_volume(capped.soup), signed_volume(ball));
}

}  // namespace
}  // namespace burnish
