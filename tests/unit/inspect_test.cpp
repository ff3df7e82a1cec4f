#include "burnish/surface/inspect.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/surface/edge_table.h"
#include "burnish/surface/weld.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;
using Pairs = std::vector<std::array<std::uint32_t, 2>>;

Defects defects_of(const TriangleSoup& soup) { return inspect(weld(soup)).defects; }

// Everything that can be counted, to compare at one glance.
struct Counts {
  std::size_t components, degenerate, duplicate, open, loops, edges, points, misoriented, pairs;
  friend bool operator==(const Counts&, const Counts&) = default;
  friend std::ostream& operator<<(std::ostream& out, const Counts& c) {
    return out << c.components << " components, " << c.degenerate << " degenerate, " << c.duplicate
               << " duplicate, " << c.open << " open in " << c.loops << " loops, non-manifold: " << c.edges
               << " edges, " << c.points << " points, " << c.misoriented << " misoriented, " << c.pairs
               << " pairs";
  }
};

Counts counts_of(const TriangleSoup& soup) {
  const Defects d = defects_of(soup);
  return {d.components, d.degenerate_facets, d.duplicate_facets, d.open_edges, d.open_loops,
          d.non_manifold_edges, d.non_manifold_points, d.misoriented_edges, d.self_intersecting_pairs};
}

TriangleSoup unit_tetrahedron() { return tetrahedron({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}); }

TEST(Inspect, CubeIsAValidSolid) {
  const Defects d = defects_of(unwelded(cube()));
  EXPECT_TRUE(d.valid_solid());
  EXPECT_EQ(d.facets, 12u);
  EXPECT_EQ(d.points, 8u);
  EXPECT_EQ(d.components, 1u);
  EXPECT_DOUBLE_EQ(d.volume, 1);
  EXPECT_DOUBLE_EQ(d.area, 6);
  EXPECT_NEAR(d.mean_edge, (24 + 12 * std::numbers::sqrt2) / 36, 1e-14);
  EXPECT_EQ(d.box.lower, (Vec3{0, 0, 0}));
  EXPECT_EQ(d.box.upper, (Vec3{1, 1, 1}));
}

TEST(Inspect, InsideOutIsClosedButNoSolid) {
  const Defects d = defects_of(flipped(cube()));
  EXPECT_TRUE(d.closed_manifold());
  EXPECT_FALSE(d.valid_solid());
  EXPECT_DOUBLE_EQ(d.volume, -1);
}

TEST(Inspect, EmptySoupIsNoSolid) { EXPECT_FALSE(defects_of({}).closed_manifold()); }

TEST(Inspect, SphereVolumeConvergesWithOrderTwo) {
  double previous = 0;
  for (int level = 1; level <= 5; ++level) {
    const Defects d = defects_of(unwelded(icosphere(level)));
    ASSERT_TRUE(d.valid_solid());
    const double error = std::abs(d.volume - 4.0 / 3.0 * std::numbers::pi);
    if (level > 1) { EXPECT_NEAR(std::log2(previous / error), 2, 0.1) << "level " << level; }
    previous = error;
  }
}

TEST(Inspect, TorusHasGenusOne) {
  const TriangleSoup soup = weld(torus(40, 17));
  const EdgeTable edges(soup);
  EXPECT_EQ(soup.points.size() + soup.facets.size(), edges.size());
  const Defects d = defects_of(soup);
  EXPECT_TRUE(d.valid_solid());
  EXPECT_NEAR(d.volume, 2 * std::numbers::pi * std::numbers::pi * 0.16, 0.1);
}

TEST(Inspect, CountsEachDefectExactly) {
  const TriangleSoup sphere = icosphere(2);
  EXPECT_EQ(counts_of(sphere), (Counts{1, 0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(counts_of(without_facets(sphere, {17})), (Counts{1, 0, 0, 3, 1, 0, 0, 0, 0}));
  EXPECT_EQ(counts_of(with_flipped_facet(sphere, 17)), (Counts{1, 0, 0, 0, 0, 0, 0, 3, 0}));
  EXPECT_EQ(counts_of(with_copied_facet(sphere, 17)), (Counts{1, 0, 1, 0, 0, 3, 0, 0, 1}));
}

TEST(Inspect, HolesThatTouchInAPointAreOneLoop) {
  const TriangleSoup ico = icosphere(0);
  EXPECT_EQ(counts_of(without_facets(ico, {0, 2})), (Counts{1, 0, 0, 6, 1, 0, 1, 0, 0}));
  EXPECT_EQ(counts_of(without_facets(ico, {0, 12})), (Counts{1, 0, 0, 6, 2, 0, 0, 0, 0}));
}

TEST(Inspect, BowTiePoint) {
  const TriangleSoup mirrored = flipped(scaled(unit_tetrahedron(), -1));
  EXPECT_EQ(counts_of(merged(unit_tetrahedron(), mirrored)), (Counts{2, 0, 0, 0, 0, 0, 1, 0, 0}));
}

TEST(Inspect, ThreeFacetsOnAnEdge) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
  soup.facets = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
  EXPECT_EQ(counts_of(soup), (Counts{1, 0, 0, 6, 1, 1, 0, 0, 0}));
}

TEST(Inspect, TwoSolidsOnOneEdge) {
  const TriangleSoup other = moved(cube(), {1, 1, 0});
  EXPECT_EQ(counts_of(merged(cube(), other)), (Counts{1, 0, 0, 0, 0, 1, 0, 0, 0}));
}

TEST(Inspect, DegenerateFacets) {
  TriangleSoup soup = cube();
  soup.facets.push_back({0, 0, 1});
  EXPECT_EQ(counts_of(soup), (Counts{1, 1, 0, 0, 0, 0, 0, 0, 0}));
  // A collinear facet in a seam closes the edges, but the facets beside it touch along more than they share.
  TriangleSoup seam = cube();
  seam.points.push_back({0.5, 0, 0});
  seam.facets[4] = {8, 1, 5};
  seam.facets.push_back({0, 8, 5});
  seam.facets.push_back({0, 1, 8});
  EXPECT_EQ(counts_of(seam), (Counts{1, 1, 0, 0, 0, 0, 0, 0, 2}));
}

TEST(SelfIntersections, NestedAndApartIsNone) {
  const TriangleSoup outer = icosphere(3);
  EXPECT_EQ(counts_of(merged(outer, scaled(outer, 0.9))).pairs, 0u);
  EXPECT_EQ(counts_of(merged(outer, moved(outer, {3, 0, 0}))).pairs, 0u);
  EXPECT_EQ(counts_of(merged(outer, moved(outer, {3, 0, 0}))).components, 2u);
}

TEST(SelfIntersections, CrossingTetrahedra) {
  // A spike through one facet: its three sides cross it, its base and tip do not.
  const TriangleSoup flat = tetrahedron({-9, -9, 0}, {9, -9, 0}, {0, 9, 0}, {0, 0, 5});
  const TriangleSoup spike = tetrahedron({-1, -1, -2}, {0, 1, -2}, {1, -1, -2}, {0, 0, 1});
  const Pairs pairs = self_intersecting_pairs(weld(merged(flat, spike)));
  EXPECT_EQ(pairs, (Pairs{{0, 5}, {0, 6}, {0, 7}}));
}

TEST(SelfIntersections, CoplanarOverlap) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}, {5, 1, 0}, {1, 5, 0}};
  soup.facets = {{0, 1, 2}, {3, 4, 5}};
  EXPECT_EQ(self_intersecting_pairs(soup).size(), 1u);
  EXPECT_EQ(self_intersecting_pairs(moved(soup, {0.1, 0.2, 0.7})).size(), 1u);
}

TEST(SelfIntersections, FoldedOntoANeighbour) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.25, 0.5, 0}, {0, -1, 0}};
  soup.facets = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
  EXPECT_EQ(self_intersecting_pairs(soup), (Pairs{{0, 1}}));
  soup.points[3].z = 1e-300;  // folded almost flat is not intersecting
  EXPECT_TRUE(self_intersecting_pairs(soup).empty());
}

TEST(SelfIntersections, TouchingInASharedPointIsNone) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {1, 1, 0}, {2, 1, 0}};
  soup.facets = {{0, 1, 2}, {0, 3, 4}};
  EXPECT_TRUE(self_intersecting_pairs(soup).empty());
  soup.facets[1] = {0, 5, 6};  // point shared, wedges overlap in the plane
  EXPECT_EQ(self_intersecting_pairs(soup).size(), 1u);
}

TEST(SelfIntersections, TouchingWithoutASharedPointCounts) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {1, 0, 0}, {1, -1, 1}, {1, -1, -1}};
  soup.facets = {{0, 1, 2}, {3, 4, 5}};
  EXPECT_EQ(self_intersecting_pairs(soup).size(), 1u);
}

// Exact for small integers: no CGAL, no boxes, no filters.
namespace brute {

double orient(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return dot(cross(b - a, c - a), d - a);
}

struct Vec2 {
  double x, y;
};

double orient(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool on_segment(const Vec2& a, const Vec2& b, const Vec2& p) {
  return orient(a, b, p) == 0 && std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) &&
         std::min(a.y, b.y) <= p.y && p.y <= std::max(a.y, b.y);
}

bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  if (on_segment(a, b, c) || on_segment(a, b, d) || on_segment(c, d, a) || on_segment(c, d, b)) return true;
  return orient(a, b, c) * orient(a, b, d) < 0 && orient(c, d, a) * orient(c, d, b) < 0;
}

using Triangle = std::array<Vec3, 3>;

bool meets_in_plane(const Vec3& p, const Vec3& q, const Triangle& t) {
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  const int drop = n.x != 0 ? 0 : n.y != 0 ? 1 : 2;
  const auto flat = [&](const Vec3& v) { return Vec2{v[(drop + 1) % 3], v[(drop + 2) % 3]}; };
  const Vec2 a = flat(p), b = flat(q), c[3] = {flat(t[0]), flat(t[1]), flat(t[2])};
  for (int i = 0; i < 3; ++i)
    if (segments_meet(a, b, c[i], c[(i + 1) % 3])) return true;
  const double s = orient(c[0], c[1], a), u = orient(c[1], c[2], a), v = orient(c[2], c[0], a);
  return (s > 0 && u > 0 && v > 0) || (s < 0 && u < 0 && v < 0);
}

bool segment_meets(const Vec3& p, const Vec3& q, const Triangle& t) {
  const double op = orient(t[0], t[1], t[2], p), oq = orient(t[0], t[1], t[2], q);
  if (op == 0 && oq == 0) return meets_in_plane(p, q, t);
  if (op * oq > 0) return false;
  const double a = orient(p, q, t[0], t[1]), b = orient(p, q, t[1], t[2]), c = orient(p, q, t[2], t[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

// Corners of f that g does not have, then those it has.
std::size_t shared_last(Facet& f, const Facet& g) {
  const auto middle = std::stable_partition(
      f.begin(), f.end(), [&](std::uint32_t p) { return std::find(g.begin(), g.end(), p) == g.end(); });
  return static_cast<std::size_t>(f.end() - middle);
}

bool facets_meet(const TriangleSoup& soup, Facet f, Facet g) {
  const Facet original = f;
  const std::size_t shared = shared_last(f, g);
  shared_last(g, original);
  const auto triangle = [&](const Facet& h) {
    return Triangle{soup.points[h[0]], soup.points[h[1]], soup.points[h[2]]};
  };
  const Triangle a = triangle(f), b = triangle(g);
  if (shared == 3) return true;
  if (shared == 2) {
    if (orient(a[1], a[2], a[0], b[0]) != 0) return false;
    return dot(cross(a[1] - a[2], a[0] - a[2]), cross(a[1] - a[2], b[0] - a[2])) > 0;
  }
  if (shared == 1) return segment_meets(a[0], a[1], b) || segment_meets(b[0], b[1], a);
  for (std::size_t i = 0; i < 3; ++i)
    if (segment_meets(a[i], a[(i + 1) % 3], b) || segment_meets(b[i], b[(i + 1) % 3], a)) return true;
  return false;
}

Pairs all_pairs(const TriangleSoup& soup) {
  Pairs pairs;
  const auto has_area = [&](std::uint32_t f) { return facet_normal_2a(soup, f) != Vec3{}; };
  for (std::uint32_t f = 0; f < soup.facets.size(); ++f)
    for (std::uint32_t g = f + 1; g < soup.facets.size(); ++g)
      if (has_area(f) && has_area(g) && facets_meet(soup, soup.facets[f], soup.facets[g]))
        pairs.push_back({f, g});
  return pairs;
}

}  // namespace brute

// Small facets at integer points, so that coplanar, touching and shared cases are common.
TriangleSoup random_soup(unsigned seed) {
  std::mt19937 random(seed);
  const auto side = static_cast<std::uint32_t>(3 + random() % 12);
  const auto count = static_cast<std::uint32_t>(20 + random() % 150);
  const auto near = [&](double at) { return at + double(random() % 4); };
  TriangleSoup soup;
  for (std::uint32_t f = 0; f < count; ++f) {
    const Vec3 at{double(random() % side), double(random() % side), double(random() % side)};
    for (int i = 0; i < 3; ++i) soup.points.push_back({near(at.x), near(at.y), near(at.z)});
    soup.facets.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  return weld(std::move(soup));
}

TEST(SelfIntersections, AgreeWithBruteForceOnRandomSoups) {
  std::size_t total = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const TriangleSoup soup = random_soup(seed);
    const Pairs expected = brute::all_pairs(soup);
    ASSERT_EQ(self_intersecting_pairs(soup), expected);
    // The same far away and tiny, where every difference is still exact.
    const TriangleSoup far = moved(scaled(soup, 0x1p-20), {0x1p20, -0x1p20, 3});
    ASSERT_EQ(self_intersecting_pairs(far), expected);
    total += expected.size();
  }
  EXPECT_GT(total, 10000u);
}

TEST(SelfIntersections, SameForAnyNumberOfThreadsAndScale) {
  TriangleSoup soup = merged(icosphere(5), moved(icosphere(5), {0.7, 0.1, 0.2}));
  soup = weld(merged(soup, scaled(torus(100, 40), 0.8)));
  const ThreadLimit limit(1);
  const Pairs serial = self_intersecting_pairs(soup);
  EXPECT_GT(serial.size(), 500u);
  {
    const ThreadLimit two(2);
    EXPECT_EQ(self_intersecting_pairs(soup), serial);
  }
  EXPECT_EQ(self_intersecting_pairs(scaled(soup, 0x1p30)), serial);
  EXPECT_EQ(self_intersecting_pairs(scaled(soup, 0x1p-300)), serial);
}

TEST(SelfIntersections, OneFarPointDoesNotSlowDownTheSearch) {
  TriangleSoup soup = scaled(icosphere(6), 1e-6);
  soup.points.insert(soup.points.end(), {{1e12, 0, 0}, {1e12, 1, 0}, {1e12, 0, 1}});
  const auto n = static_cast<std::uint32_t>(soup.points.size());
  soup.facets.push_back({n - 3, n - 2, n - 1});
  EXPECT_TRUE(self_intersecting_pairs(soup).empty());
}

TEST(SelfIntersections, StopAtTheLimitWithTheSamePairs) {
  // Long facets that all cross near the origin.
  TriangleSoup soup;
  std::mt19937 random(7);
  const auto at = [&] { return static_cast<double>(random() % 1000000) / 1e6; };
  for (std::uint32_t f = 0; f < 1000; ++f) {
    soup.points.push_back({-9 - at(), at(), at()});
    soup.points.push_back({9 + at(), 5 + at(), at()});
    soup.points.push_back({9, -5 - at(), -at()});
    soup.facets.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  const Pairs all = self_intersecting_pairs(soup);
  EXPECT_GT(all.size(), 300'000u);
  EXPECT_EQ(self_intersecting_pairs(soup, no_progress(), all.size()), all);
  const Pairs some = self_intersecting_pairs(soup, no_progress(), 10'000);
  EXPECT_EQ(some.size(), 10'000u);
  const ThreadLimit limit(1);
  EXPECT_EQ(self_intersecting_pairs(soup, no_progress(), 10'000), some);
  const Inspection result = inspect(soup, {.max_collected_pairs = 1000});
  EXPECT_EQ(result.defects.self_intersecting_pairs, all.size());
  EXPECT_EQ(result.self_intersections, Pairs(all.begin(), all.begin() + 1000));
}

class Cancelled : public Progress {
  bool cancelled() const override { return true; }
};

TEST(Inspect, CanBeCancelled) {
  Cancelled progress;
  EXPECT_THROW(inspect(weld(cube()), {}, progress), Error);
}

}  // namespace
}  // namespace burnish
