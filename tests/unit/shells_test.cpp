#include "burnish/surface/shells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/surface/weld.h"
#include "support/damage.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;
using Around = std::vector<std::pair<std::uint32_t, int>>;

// The cube of this side about the origin.
TriangleSoup centred_cube(double side) { return moved(scaled(cube(), side), Vec3{-0.5, -0.5, -0.5} * side); }

TriangleSoup box_between(const Box3& b) {
  return mapped(cube(), [&](const Vec3& p) {
    return Vec3{b.lower.x + p.x * (b.upper.x - b.lower.x), b.lower.y + p.y * (b.upper.y - b.lower.y), b.lower.z + p.z * (b.upper.z - b.lower.z)};
  });
}

// Cubes in each other, each facing outwards (bit set) or inwards: what wraps a cube are those outside it.
TEST(Shells, NestedCubesOfEveryOrientation) {
  for (unsigned outwards = 0; outwards < 8; ++outwards) {
    SCOPED_TRACE(outwards);
    TriangleSoup soup;
    for (unsigned i = 0; i < 3; ++i) {
      const TriangleSoup next = centred_cube(8 >> i);
      soup = merged(soup, outwards >> i & 1 ? next : flipped(next));
    }
    const Shells found = find_shells(weld(soup));
    ASSERT_EQ(found.shells.size(), 3u);
    std::size_t misnested = 0;
    int wrapped = 0;
    Around around;
    for (std::uint32_t i = 0; i < 3; ++i) {
      const Shell& shell = found.shells[i];
      const int sign = outwards >> i & 1 ? 1 : -1;
      const double side = 8 >> i;
      EXPECT_TRUE(shell.closed);
      EXPECT_EQ(shell.facets, 12u);
      EXPECT_DOUBLE_EQ(shell.volume, sign * side * side * side);
      EXPECT_DOUBLE_EQ(shell.area, 6 * side * side);
      EXPECT_EQ(shell.wrapped, wrapped);
      EXPECT_EQ(shell.around, around);
      misnested += !(sign > 0 && wrapped == 0) && !(sign < 0 && wrapped == 1);
      wrapped += sign;
      around.emplace_back(i, sign);
    }
    EXPECT_EQ(count_misnested(found), misnested);
  }
}

TEST(Shells, DisjointBodiesWrapNothing) {
  const Shells found = find_shells(weld(merged(merged(cube(), moved(cube(), {0, 0, 3})), moved(icosphere(2), {5, 0, 0}))));
  ASSERT_EQ(found.shells.size(), 3u);
  for (const Shell& shell : found.shells) {
    EXPECT_TRUE(shell.around.empty());
    EXPECT_EQ(shell.wrapped, 0);
  }
  EXPECT_EQ(count_misnested(found), 0u);
  EXPECT_EQ(found.of_facet[0], 0u);
  EXPECT_EQ(found.of_facet[12], 1u);
  EXPECT_EQ(found.of_facet[24], 2u);
}

// What straddles another is in it if most of it is.
TEST(Shells, OverlappingBodiesFollowTheMajority) {
  const TriangleSoup small = moved(scaled(cube(), 0.5), {0, 0.25, 0.25});
  const Shells mostly_in = find_shells(weld(merged(cube(), moved(small, {0.6, 0, 0}))));
  EXPECT_EQ(mostly_in.shells.at(1).around, (Around{{0, 1}}));
  EXPECT_TRUE(mostly_in.shells.at(0).around.empty());
  const Shells mostly_out = find_shells(weld(merged(cube(), moved(small, {0.9, 0, 0}))));
  EXPECT_TRUE(mostly_out.shells.at(1).around.empty());
  EXPECT_TRUE(mostly_out.shells.at(0).around.empty());
}

TEST(Shells, OpenShellsAreNotClosedAndWrapNothing) {
  const Shells found = find_shells(weld(merged(without_facets(centred_cube(4), {3}), centred_cube(1))));
  ASSERT_EQ(found.shells.size(), 2u);
  EXPECT_FALSE(found.shells[0].closed);
  EXPECT_TRUE(found.shells[1].closed);
  EXPECT_TRUE(found.shells[1].around.empty());
}

TEST(Shells, AFacetThatRepeatsAPointIsAShellOfItsOwn) {
  TriangleSoup soup = cube();
  soup.facets.push_back({0, 1, 1});
  const Shells found = find_shells(weld(soup));
  ASSERT_EQ(found.shells.size(), 2u);
  EXPECT_TRUE(found.shells[0].closed);
  EXPECT_FALSE(found.shells[1].closed);
  EXPECT_EQ(found.shells[1].facets, 1u);
}

TEST(Shells, OneShellIsWrappedByNothingEvenIfInsideOut) {
  const Shells found = find_shells(flipped(torus(20, 10)));
  ASSERT_EQ(found.shells.size(), 1u);
  EXPECT_EQ(found.shells[0].wrapped, 0);
  EXPECT_EQ(count_misnested(found), 1u);
}

// --- random boxes -------------------------------------------------------------------------------

bool contains(const Box3& a, const Box3& b) {
  for (int i = 0; i < 3; ++i)
    if (!(a.lower[i] < b.lower[i] && b.upper[i] < a.upper[i])) return false;
  return true;
}

bool apart(const Box3& a, const Box3& b) {
  for (int i = 0; i < 3; ++i)
    if (a.upper[i] < b.lower[i] || b.upper[i] < a.lower[i]) return true;
  return false;
}

// Boxes with corners on a lattice, so that rays meet edges and corners of others: each in one of those before it, or
// beside them. None touches another.
std::vector<Box3> random_boxes(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Box3> boxes;
  while (boxes.size() < count) {
    Box3 within{{0, 0, 0}, {128, 128, 128}};
    if (const std::size_t i = random.below(boxes.size() + 4); i < boxes.size()) within = boxes[i];
    Box3 box;
    for (int corner = 0; corner < 2; ++corner) {
      Vec3 p;
      for (int i = 0; i < 3; ++i) p[i] = std::floor(random.uniform(within.lower[i] + 1, within.upper[i]));
      box.extend(p);
    }
    const Vec3 e = box.extent();
    if (std::min({e.x, e.y, e.z}) < 1 || !contains(within, box)) continue;
    const auto clashes = [&](const Box3& other) { return !apart(box, other) && !contains(box, other) && !contains(other, box); };
    if (std::none_of(boxes.begin(), boxes.end(), clashes)) boxes.push_back(box);
  }
  return boxes;
}

Vec3 rotated(const Vec3& p) {
  const double c = std::cos(0.7), s = std::sin(0.7);
  const Vec3 q{c * p.x - s * p.y, s * p.x + c * p.y, p.z};
  return {q.x, c * q.y - s * q.z, s * q.y + c * q.z};
}

void expect_true_nesting(const std::vector<Box3>& boxes, const std::vector<int>& signs, const Shells& found) {
  ASSERT_EQ(found.shells.size(), boxes.size());
  std::size_t misnested = 0, deepest = 0;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    Around around;
    int wrapped = 0;
    for (std::uint32_t j = 0; j < boxes.size(); ++j) {
      if (!contains(boxes[j], boxes[i])) continue;
      around.emplace_back(j, signs[j]);
      wrapped += signs[j];
    }
    ASSERT_EQ(found.shells[i].around, around) << "box " << i;
    ASSERT_EQ(found.shells[i].wrapped, wrapped) << "box " << i;
    misnested += !(signs[i] > 0 && wrapped == 0) && !(signs[i] < 0 && wrapped == 1);
    deepest = std::max(deepest, around.size());
  }
  EXPECT_EQ(count_misnested(found), misnested);
  EXPECT_GE(deepest, 3u) << "the boxes are hardly nested";
}

TEST(Shells, RandomBoxesAgreeWithExactContainment) {
  const std::vector<Box3> boxes = random_boxes(200, 5);
  Random random(6);
  std::vector<int> signs;
  TriangleSoup soup;
  for (const Box3& box : boxes) {
    signs.push_back(random.below(2) ? 1 : -1);
    soup = merged(soup, signs.back() > 0 ? box_between(box) : flipped(box_between(box)));
  }
  expect_true_nesting(boxes, signs, find_shells(weld(soup)));
  const TriangleSoup turned = weld(mapped(soup, rotated));
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    expect_true_nesting(boxes, signs, find_shells(turned));
  }
}

}  // namespace
}  // namespace burnish
