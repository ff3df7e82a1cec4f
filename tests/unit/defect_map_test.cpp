#include "burnish/surface/defect_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "burnish/core/parallel.h"
#include "burnish/surface/weld.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;
using Kind = DefectKind;

Inspection inspected(const TriangleSoup& welded) { return inspect(welded, {.elements = true}); }

DefectMap map_of(const TriangleSoup& soup) {
  const TriangleSoup welded = weld(soup);
  return locate_defects(welded, inspected(welded));
}

void expect_near(const Vec3& found, const Vec3& expected, double tolerance = 1e-12) {
  EXPECT_LE(norm(found - expected), tolerance) << found.x << ' ' << found.y << ' ' << found.z;
}

// The unit sphere without the facets whose points all lie beyond `height` along one of the axes.
TriangleSoup holed_sphere(const std::vector<std::pair<Vec3, double>>& holes) {
  const TriangleSoup sphere = icosphere(5);
  std::vector<std::size_t> cut;
  for (std::size_t f = 0; f < sphere.facets.size(); ++f)
    for (const auto& [axis, height] : holes) {
      bool beyond = true;
      for (int i = 0; i < 3; ++i) beyond &= dot(sphere.corner(f, i), axis) > height;
      if (beyond) cut.push_back(f);
    }
  return without_facets(sphere, cut);
}

TEST(DefectMap, NothingToLocate) {
  const DefectMap map = map_of(cube());
  EXPECT_TRUE(map.defects.empty());
  EXPECT_TRUE(map.intersecting_facets.empty());
  EXPECT_TRUE(locate_defects({}, inspected({})).defects.empty());
}

TEST(DefectMap, AFacetMissingInACube) {
  const DefectMap map = map_of(without_facets(cube(), {0}));  // (0,0,0) (0,1,0) (1,1,0)
  ASSERT_EQ(map.defects.size(), 1u);
  const LocatedDefect& hole = map.defects[0];
  const double diagonal = std::numbers::sqrt2;
  EXPECT_EQ(hole.kind, Kind::open_loop);
  EXPECT_EQ(hole.count, 3u);
  EXPECT_DOUBLE_EQ(hole.length, 2 + diagonal);
  EXPECT_NEAR(hole.area, 0.5, 1e-15);
  expect_near(hole.position, Vec3{0.5 + 0.5 * diagonal, 1.5 + 0.5 * diagonal, 0} / (2 + diagonal));
  EXPECT_EQ(hole.box.lower, (Vec3{0, 0, 0}));
  EXPECT_EQ(hole.box.upper, (Vec3{1, 1, 0}));
}

TEST(DefectMap, TwoHolesOfASphereTheLargerFirst) {
  // The rims are the staircases of facets along circles: longer than these, by less than half.
  const Vec3 small = {0, 0, 1}, large = Vec3{1, 1, 0} / std::numbers::sqrt2;
  const DefectMap map = map_of(holed_sphere({{small, 0.95}, {large, 0.8}}));
  ASSERT_EQ(map.defects.size(), 2u);
  const std::array<std::pair<Vec3, double>, 2> holes = {{{large, 0.8}, {small, 0.95}}};
  for (std::size_t h = 0; h < 2; ++h) {
    const auto& [axis, height] = holes[h];
    const LocatedDefect& hole = map.defects[h];
    const double radius = std::sqrt(1 - height * height);
    expect_near(hole.position, axis * height, 0.03);
    EXPECT_GT(hole.length, 2 * std::numbers::pi * radius * 0.85);
    EXPECT_LT(hole.length, 2 * std::numbers::pi * radius * 1.5);
    EXPECT_NEAR(hole.area, std::numbers::pi * radius * radius, 0.2 * std::numbers::pi * radius * radius);
  }
}

TEST(DefectMap, FarFromTheOriginPositionsKeepTheirDigits) {
  const Vec3 far = {0x1p40, -0x1p40, 0x1p40};
  const DefectMap near_map = map_of(without_facets(cube(), {3})),
                  far_map = map_of(moved(without_facets(cube(), {3}), far));
  expect_near(far_map.defects[0].position - far, near_map.defects[0].position, 1e-3);
}

TEST(DefectMap, AFlippedFacetIsOneChainOfMisorientedEdges) {
  const DefectMap map = map_of(with_flipped_facet(cube(), 2));  // (0,0,1) (1,0,1) (1,1,1)
  ASSERT_EQ(map.defects.size(), 1u);
  EXPECT_EQ(map.defects[0].kind, Kind::misoriented_edge);
  EXPECT_EQ(map.defects[0].count, 3u);
  EXPECT_EQ(map.defects[0].box.lower, (Vec3{0, 0, 1}));
  EXPECT_EQ(map.defects[0].box.upper, (Vec3{1, 1, 1}));
  EXPECT_EQ(map.defects[0].area, 0);
}

TEST(DefectMap, ThreeSheetsOnOneEdge) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {0, 0, 4}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
  soup.facets = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
  const auto map = map_of(soup);
  ASSERT_EQ(map.of(Kind::non_manifold_edge).size(), 1u);
  const LocatedDefect& edge = map.of(Kind::non_manifold_edge)[0];
  EXPECT_EQ(edge.position, (Vec3{0, 0, 2}));
  EXPECT_EQ(edge.length, 4);
  EXPECT_EQ(edge.count, 1u);
  EXPECT_EQ(map.of(Kind::open_loop).size(), 1u);
}

TEST(DefectMap, APinchedPoint) {
  const TriangleSoup lower = tetrahedron({0, 0, 0}, {1, 0, -1}, {0, 1, -1}, {-1, -1, -1});
  const TriangleSoup upper = tetrahedron({0, 0, 0}, {0, 1, 1}, {1, 0, 1}, {-1, -1, 1});
  const DefectMap map = map_of(moved(merged(lower, upper), {5, 6, 7}));
  ASSERT_EQ(map.defects.size(), 1u);
  EXPECT_EQ(map.defects[0].kind, Kind::non_manifold_point);
  EXPECT_EQ(map.defects[0].position, (Vec3{5, 6, 7}));
  EXPECT_EQ(map.defects[0].count, 6u);
  EXPECT_EQ(map.defects[0].facet, 0u);
}

TEST(DefectMap, DegenerateAndDuplicateFacets) {
  TriangleSoup soup = with_copied_facet(with_copied_facet(cube(), 4), 0);  // 12 and 13
  soup.facets.push_back({0, 0, 7});                                        // 14
  const DefectMap map = map_of(soup);
  const auto degenerate = map.of(Kind::degenerate_facet), duplicate = map.of(Kind::duplicate_facet);
  ASSERT_EQ(degenerate.size(), 1u);
  EXPECT_EQ(degenerate[0].facet, 14u);
  EXPECT_DOUBLE_EQ(degenerate[0].length, std::sqrt(3.0));
  expect_near(degenerate[0].position, Vec3{1, 1, 1} / 3);
  ASSERT_EQ(duplicate.size(), 2u);
  EXPECT_EQ(duplicate[0].facet, 12u);  // of equal size: in the order of facets
  EXPECT_EQ(duplicate[1].facet, 13u);
  EXPECT_EQ(duplicate[1].area, 0.5);
  expect_near(duplicate[1].position, {1.0 / 3, 2.0 / 3, 0});
  EXPECT_EQ(map.of(Kind::self_intersection).size(), 1u);  // facets 0 and 4 share a point
}

TEST(DefectMap, OverlappingCubesAreOneCluster) {
  // Two that cross at corners, and a smaller one that pokes out of a larger one's side.
  const TriangleSoup corners = merged(cube(), moved(cube(), {0.5, 0.5, 0.5}));
  const TriangleSoup poking = merged(moved(scaled(cube(), 2), {10, 0, 0}), moved(cube(), {11.5, 0.5, 0.5}));
  const TriangleSoup welded = weld(merged(corners, poking));
  const Inspection inspection = inspected(welded);
  const DefectMap map = locate_defects(welded, inspection);
  ASSERT_EQ(map.defects.size(), 2u);
  EXPECT_EQ(map.defects[0].count + map.defects[1].count, inspection.defects.self_intersecting_pairs);
  EXPECT_GT(map.defects[0].count, map.defects[1].count);
  const std::array<Box3, 2> meeting = {Box3{{0.5, 0.5, 0.5}, {1, 1, 1}},
                                       Box3{{12, 0.5, 0.5}, {12, 1.5, 1.5}}};
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_EQ(map.defects[c].kind, Kind::self_intersection);
    EXPECT_EQ(map.defects[c].box.lower, meeting[c].lower);
    EXPECT_EQ(map.defects[c].box.upper, meeting[c].upper);
    expect_near(map.defects[c].position, meeting[c].center());
  }
  EXPECT_EQ(map.defects[0].area, 6);
}

TEST(DefectMap, ElementsKnowTheirDefects) {
  TriangleSoup soup = holed_sphere({{{0, 0, 1}, 0.9}, {{1, 0, 0}, 0.95}});
  soup = weld(merged(soup, moved(cube(), {0, -1.2, 0})));
  const Inspection inspection = inspected(soup);
  const DefectMap map = locate_defects(soup, inspection);
  const auto& of_edge = map.defect_of_element[static_cast<std::size_t>(Kind::open_loop)];
  ASSERT_EQ(of_edge.size(), inspection.elements.open_edges.size());
  std::vector<std::size_t> edges(map.defects.size(), 0);
  for (std::size_t e = 0; e < of_edge.size(); ++e) {
    ++edges[of_edge[e]];
    const Vec3& p = soup.points[inspection.elements.open_edges[e].points[0]];
    const Box3& box = map.defects[of_edge[e]].box;
    EXPECT_TRUE(min(p, box.lower) == box.lower && max(p, box.upper) == box.upper);
  }
  ASSERT_EQ(map.of(Kind::open_loop).size(), 2u);
  for (std::size_t d = 0; d < 2; ++d) EXPECT_EQ(edges[d], map.defects[d].count);
  const auto& of_facet = map.defect_of_element[static_cast<std::size_t>(Kind::self_intersection)];
  ASSERT_EQ(of_facet.size(), map.intersecting_facets.size());
  for (const std::uint32_t d : of_facet) EXPECT_EQ(map.defects[d].kind, Kind::self_intersection);
}

TEST(DefectMap, SameOnAnyNumberOfThreadsAndForAnyScale) {
  // A sheet of separate facets: as many loops, more than one thread's share to sort.
  TriangleSoup soup = unwelded(scaled(icosphere(5), 3));
  for (std::size_t p = 0; p < soup.points.size(); ++p)
    soup.points[p] = soup.points[p] * (1 + double(p / 3) * 0x1p-20);
  soup = weld(soup);
  const auto same = [](const DefectMap& a, const DefectMap& b, double scale) {
    ASSERT_EQ(a.defects.size(), b.defects.size());
    for (std::size_t d = 0; d < a.defects.size(); ++d) {
      ASSERT_EQ(a.defects[d].position * scale, b.defects[d].position);
      ASSERT_EQ(a.defects[d].length * scale, b.defects[d].length);
      ASSERT_EQ(a.defects[d].facet, b.defects[d].facet);
    }
  };
  const DefectMap map = map_of(soup);
  EXPECT_EQ(map.defects.size(), soup.facets.size());
  same(map, map_of(scaled(soup, 0x1p30)), 0x1p30);
  const ThreadLimit limit(1);
  same(map, map_of(soup), 1);
}

TEST(DefectMap, SizesStayFinite) {
  const DefectMap huge = map_of(scaled(without_facets(cube(), {0}), 1e300));
  ASSERT_EQ(huge.defects.size(), 1u);
  EXPECT_TRUE(is_finite(huge.defects[0].position));
  EXPECT_TRUE(std::isfinite(huge.defects[0].length) && std::isfinite(huge.defects[0].area));
  const DefectMap tiny = map_of(scaled(without_facets(cube(), {0}), 1e-300));
  expect_near(tiny.defects[0].position * 1e300, {0.5, 0.5, 0});
}

}  // namespace
}  // namespace burnish
