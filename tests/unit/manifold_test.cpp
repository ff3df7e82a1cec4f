#include "burnish/surface/manifold.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <tuple>

#include "burnish/surface/inspect.h"
#include "burnish/surface/orient.h"
#include "burnish/surface/shells.h"
#include "burnish/surface/weld.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

// Facets and coordinates are the input's, whatever was doubled.
void expect_same_geometry(const TriangleSoup& before, const ManifoldPieces& after) {
  ASSERT_EQ(after.soup.facets.size(), before.facets.size());
  ASSERT_EQ(after.original.size(), after.soup.points.size());
  EXPECT_EQ(after.soup.points.size(), before.points.size() + after.points_split);
  for (std::size_t f = 0; f < before.facets.size(); ++f)
    for (int i = 0; i < 3; ++i) ASSERT_EQ(after.soup.corner(f, i), before.corner(f, i));
  for (std::size_t p = 0; p < after.original.size(); ++p) ASSERT_EQ(after.soup.points[p], before.points[after.original[p]]);
}

void expect_one_fan_each(const ManifoldPieces& pieces) {
  EXPECT_TRUE(pieces.manifold);
  EXPECT_TRUE(non_manifold_points(pieces.soup).empty());
}

TEST(Manifold, ASolidStaysAsItIs) {
  const TriangleSoup soup = torus(12, 8);
  const ManifoldPieces pieces = split_into_manifold_pieces(soup);
  expect_same_geometry(soup, pieces);
  expect_one_fan_each(pieces);
  EXPECT_EQ(pieces.points_split, 0u);
  EXPECT_EQ(pieces.cut_edges, 0u);
}

// Two cubes that touch: in a corner one point is shared, along an edge two points and the edge.
TEST(Manifold, TouchingCubesComeApart) {
  struct Touch {
    Vec3 by;
    std::size_t points, edges;
  };
  for (const auto& [by, points, edges] : {Touch{{1, 1, 1}, 1, 0}, Touch{{1, 1, 0}, 2, 1}, Touch{{0, 1, 1}, 2, 1}, Touch{{1, 0, -1}, 2, 1}}) {
    SCOPED_TRACE(::testing::Message() << by.x << ' ' << by.y << ' ' << by.z);
    const TriangleSoup soup = weld(merged(cube(), moved(cube(), by)));
    const ManifoldPieces pieces = split_into_manifold_pieces(soup);
    expect_same_geometry(soup, pieces);
    expect_one_fan_each(pieces);
    EXPECT_EQ(pieces.points_split, points);
    EXPECT_EQ(pieces.cut_edges, edges);
    const Shells shells = find_shells(pieces.soup);
    ASSERT_EQ(shells.shells.size(), 2u);
    for (const Shell& shell : shells.shells) {
      EXPECT_TRUE(shell.closed);
      EXPECT_NEAR(shell.volume, 1, 1e-12);
    }
  }
}

// One cube touches two along edges, and a third one in a corner.
TEST(Manifold, AChainOfCubes) {
  const TriangleSoup soup = weld(merged(merged(cube(), moved(cube(), {-1, -1, 0})), merged(moved(cube(), {1, 1, 0}), moved(cube(), {1, -1, 1}))));
  const ManifoldPieces pieces = split_into_manifold_pieces(soup);
  expect_one_fan_each(pieces);
  EXPECT_EQ(find_shells(pieces.soup).shells.size(), 4u);
}

// A facet that stands on the cube's edge or on the diagonal of a face, facing either way.
TEST(Manifold, AFinIsCutOff) {
  const Vec3 away{-1, -1, 0.5}, above{0.5, 0.5, 2};
  for (const auto& [a, b, tip] : {std::tuple{Vec3{0, 0, 0}, Vec3{0, 0, 1}, away}, std::tuple{Vec3{0, 0, 1}, Vec3{1, 1, 1}, above}})
    for (const bool turned : {false, true}) {
      TriangleSoup soup = cube();
      const auto first = static_cast<std::uint32_t>(soup.points.size());
      soup.points.insert(soup.points.end(), {a, b, tip});
      soup.facets.push_back(turned ? Facet{first + 1, first, first + 2} : Facet{first, first + 1, first + 2});
      soup = weld(soup);
      const ManifoldPieces pieces = split_into_manifold_pieces(soup);
      expect_same_geometry(soup, pieces);
      expect_one_fan_each(pieces);
      EXPECT_EQ(pieces.points_split, 2u);
      EXPECT_EQ(pieces.cut_edges, 1u);
      const Shells shells = find_shells(pieces.soup);
      ASSERT_EQ(shells.shells.size(), 2u);
      EXPECT_TRUE(shells.shells[0].closed);
      EXPECT_EQ(shells.shells[0].facets, 12u);
      EXPECT_FALSE(shells.shells[1].closed);
    }
}

// A strip of n squares with half a turn.
TriangleSoup moebius_strip(std::uint32_t n) {
  TriangleSoup soup;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double t = 2 * std::numbers::pi * i / n;
    for (const double s : {-0.3, 0.3}) {
      const double r = 1 + s * std::cos(t / 2);
      soup.points.push_back({r * std::cos(t), r * std::sin(t), s * std::sin(t / 2)});
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const bool last = i + 1 == n;
    const std::uint32_t a = 2 * i, b = a + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    soup.facets.push_back({a, c, b});
    soup.facets.push_back({c, d, b});
  }
  return soup;
}

// One-sided: it keeps a seam however it is oriented, and comes out as the two-sided strip that it is when cut there.
TEST(Manifold, AMoebiusStripIsCutAtItsSeam) {
  const TriangleSoup oriented = orient(moebius_strip(24)).soup;
  ASSERT_EQ(inspect(oriented).defects.misoriented_edges, 1u);
  const ManifoldPieces pieces = split_into_manifold_pieces(oriented);
  expect_same_geometry(oriented, pieces);
  expect_one_fan_each(pieces);
  EXPECT_EQ(pieces.cut_edges, 1u);
  EXPECT_EQ(pieces.points_split, 2u);
  const Defects d = inspect(pieces.soup, {.self_intersections = false}).defects;
  EXPECT_EQ(d.misoriented_edges, 0u);
  EXPECT_EQ(d.open_edges, 2u * 24 + 2);
  EXPECT_EQ(d.open_loops, 1u);
}

// Two pairs of facets share an edge and are one fan at each of its ends: no doubling of points takes them apart.
TEST(Manifold, AnEdgeThatFansReachAroundStays) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0.5}, {0, 1, 0.5}, {-1, 0, 0.5}, {0, -1, 0.5}};
  soup.facets = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {1, 0, 5}, {0, 2, 3}, {1, 3, 2}};
  const ManifoldPieces pieces = split_into_manifold_pieces(soup);
  EXPECT_EQ(pieces.cut_edges, 1u);
  EXPECT_FALSE(pieces.manifold);
}

}  // namespace
}  // namespace burnish
