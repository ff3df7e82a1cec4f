// Whatever the solid and however it is turned: sharpening gives a valid solid with the reference's creases.
#include "burnish/extract/sharpen.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "burnish/surface/inspect.h"
#include "burnish/surface/triangle_index.h"
#include "support/creased_shapes.h"

namespace burnish {
namespace {

using namespace test;

std::vector<std::pair<std::string, TriangleSoup>> solids() {
  return {{"box", box({1, 1, 1}, 2, 2, 2)},
          {"three cubes", cubes({{0, 0, 0}, {1, 0, 0}, {0, 1, 1}, {0, 0, 1}})},
          {"wedge of 60 degrees", wedge(60)},
          {"wedge of 35 degrees", wedge(35)},
          {"cylinder", prism(regular_polygon(64, 0.5), 1)},
          {"prism of 7 sides", prism(regular_polygon(7, 0.5), 1)},
          {"cone", cone(48)},
          {"bracket", bracket(4)},
          {"fading ridge", block_with_fading_ridge(6, 1.2)}};
}

class SharpenProperty : public testing::TestWithParam<int> {};

TEST_P(SharpenProperty, ValidSolidsWithAllCorners) {
  const auto seed = static_cast<std::uint64_t>(GetParam());
  std::mt19937_64 engine(seed);
  for (const auto& [name, solid] : solids()) {
    const TriangleSoup turned = mapped(solid, Rotation::random(engine));
    const Sharpened x = sharpened(turned, bounding_box(solid).longest_side() / 40, {.angle = 40, .resolved_angle = 10, .resolved = 1});
    SCOPED_TRACE(name + ", seed " + std::to_string(seed));
    const Defects d = inspect(x.result.soup).defects;
    EXPECT_TRUE(d.valid_solid()) << d.self_intersecting_pairs << " intersections";
    EXPECT_NEAR(d.volume / signed_volume(x.s), 1, 1e-3);
    EXPECT_EQ(x.result.kept, 0u);
    std::size_t corners = 0;
    for (const SharpenedKind kind : x.result.kind) corners += kind == SharpenedKind::corner;
    EXPECT_EQ(corners, x.creases.corners.size());
    const TriangleIndex result(x.result.soup);
    for (const CreaseEdge& e : x.creases.edges)
      EXPECT_LT(std::sqrt(result.closest((x.s.points[e.points[0]] + x.s.points[e.points[1]]) * 0.5).squared_distance), 0.1);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, SharpenProperty, testing::Range(1, 7));

}  // namespace
}  // namespace burnish
