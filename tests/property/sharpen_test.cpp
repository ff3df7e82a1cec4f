// Whatever the solid and however it is turned: sharpening gives a valid solid with the reference's creases.
#include "burnish/extract/sharpen.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "burnish/surface/inspect.h"
#include "burnish/surface/triangle_index.h"
#include "support/creased_shapes.h"

namespace burnish {
namespace {

using namespace test;

const CreaseOptions kResolved{.angle = 40, .resolved_angle = 10, .resolved = 1};

struct Case {
  std::string name;
  TriangleSoup solid;
};

// Convex and concave edges, right angles and obtuse ones, as a lattice resolves them.
std::vector<Case> resolved_solids() {
  return {{"box", box({1, 1, 1}, 2, 2, 2)},
          {"cubes", cubes({{0, 0, 0}, {1, 0, 0}, {0, 1, 1}, {0, 0, 1}})},
          {"cylinder", prism(regular_polygon(64, 0.5), 1)},
          {"prism of 7 sides", prism(regular_polygon(7, 0.5), 1)},
          {"bracket", bracket(4)}};
}

// Tips that are thinner than a cell for a while.
std::vector<Case> sharp_solids() {
  return {{"wedge of 60 degrees", wedge(60)}, {"wedge of 35 degrees", wedge(35)}, {"wedge of 20 degrees", wedge(20)}, {"cone", cone(48)},
          {"fading ridge", block_with_fading_ridge(6, 1.2)}};
}

class SharpenProperty : public testing::TestWithParam<int> {
 protected:
  template <class Check>
  void for_each(const std::vector<Case>& cases, Check&& check) {
    const auto seed = static_cast<std::uint64_t>(GetParam());
    std::mt19937_64 engine(seed);
    for (const auto& [name, solid] : cases) {
      SCOPED_TRACE(name + ", seed " + std::to_string(seed));
      check(mapped(solid, Rotation::random(engine)), bounding_box(solid).longest_side() / 40);
    }
  }
};

// The share of the creases' length that is more than a tenth of a cell from the result.
double far_share(const Sharpened& x) {
  const TriangleIndex result(x.result.soup);
  double far = 0, whole = 0;
  for (const CreaseEdge& e : x.creases.edges) {
    const Vec3 &a = x.s.points[e.points[0]], &b = x.s.points[e.points[1]];
    const int pieces = 1 + static_cast<int>(4 * norm(b - a));
    for (int i = 0; i < pieces; ++i) {
      whole += norm(b - a) / pieces;
      if (result.closest(a + (b - a) * ((i + 0.5) / pieces)).squared_distance > 0.01) far += norm(b - a) / pieces;
    }
  }
  return whole > 0 ? far / whole : 0;
}

TEST_P(SharpenProperty, ResolvedSolidsComeBackWithTheirCreases) {
  for_each(resolved_solids(), [](const TriangleSoup& solid, double cell) {
    const Sharpened x = sharpened(solid, cell, kResolved);
    const Defects d = inspect(x.result.soup).defects;
    EXPECT_TRUE(d.valid_solid()) << d.self_intersecting_pairs << " intersections";
    EXPECT_NEAR(d.volume / signed_volume(x.s), 1, 1e-3);
    EXPECT_LE(x.result.kept, x.result.soup.points.size() / 500);
    std::size_t corners = 0;
    for (const SharpenedKind kind : x.result.kind) corners += kind == SharpenedKind::corner;
    EXPECT_EQ(corners, x.creases.corners.size());
    EXPECT_LT(far_share(x), 0.01);  // the bracket has corners 1.5 cells apart
  });
}

TEST_P(SharpenProperty, SharpSolidsSettleAsValidOnes) {
  for_each(sharp_solids(), [](const TriangleSoup& solid, double cell) {
    const Sharpened x = sharpened_and_settled(solid, cell, kResolved);
    const Defects d = inspect(x.result.soup).defects;
    EXPECT_TRUE(d.closed_manifold());
    EXPECT_EQ(d.self_intersecting_pairs, 0u);
    EXPECT_EQ(x.stuck, 0u);
  });
}

INSTANTIATE_TEST_SUITE_P(Seeds, SharpenProperty, testing::Range(1, 5));

}  // namespace
}  // namespace burnish
