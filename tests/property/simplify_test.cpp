#include "burnish/surface/simplify.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "burnish/surface/inspect.h"
#include "burnish/surface/triangle_index.h"
#include "support/repetitions.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

// A sphere or a torus with waves of random directions, lengths and heights; some of them steep.
TriangleSoup wavy(std::mt19937_64& random) {
  std::uniform_real_distribution<double> in(-1, 1);
  TriangleSoup shape = random() % 2 ? icosphere(4) : torus(90, 40);
  for (int wave = 0; wave < 4; ++wave) {
    const Vec3 k = Vec3{in(random), in(random), in(random)} * 8;
    const Vec3 along = Vec3{in(random), in(random), in(random)} * (0.3 / (1 + norm(k)));
    shape = mapped(shape, [&](const Vec3& p) { return p + along * std::sin(dot(k, p)); });
  }
  return shape;
}

TEST(SimplifyProperty, TheDeviationIsKeptAndTheResultIsValid) {
  for (std::uint64_t seed = 1; seed <= repetitions(12, 4); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const TriangleSoup given = wavy(random);
    if (!inspect(given).defects.valid_solid()) continue;
    const double deviation = mean_edge_length(given) * std::exp(std::uniform_real_distribution<double>(-2.5, 0.5)(random));
    const SimplifiedSurface r = simplify(given, {.deviation = deviation});
    EXPECT_EQ(r.why_not, "");
    EXPECT_LT(r.soup.facets.size(), given.facets.size());
    const Defects before = inspect(given).defects, after = inspect(r.soup).defects;
    EXPECT_TRUE(after.valid_solid());
    EXPECT_EQ(after.points - after.facets / 2, before.points - before.facets / 2);  // Euler characteristic
    EXPECT_LE(r.deviation.input_to_output.max, deviation);
    EXPECT_LE(r.deviation.output_to_input.max, deviation);
    // All points, exactly as promised; other samples than those that were verified, nearly.
    const TriangleIndex of_given(given), of_result(r.soup);
    for (const Vec3& p : given.points) ASSERT_LE(of_result.closest(p).squared_distance, deviation * deviation);
    for (const Vec3& p : r.soup.points) ASSERT_LE(of_given.closest(p).squared_distance, deviation * deviation);
    const CompareOptions others{.area_samples = 77'777, .vertex_samples = 0};
    EXPECT_LE(one_sided_distance(given, of_result, others).max, 1.05 * deviation);
    EXPECT_LE(one_sided_distance(r.soup, of_given, others).max, 1.05 * deviation);
  }
}

TEST(SimplifyProperty, AnyCountGivesAValidSolid) {
  for (std::uint64_t seed = 101; seed <= 100 + repetitions(10, 3); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const TriangleSoup given = wavy(random);
    if (!inspect(given).defects.valid_solid()) continue;
    const auto count = std::uniform_int_distribution<std::size_t>(60, given.facets.size())(random);
    const SimplifiedSurface r = simplify(given, {.facets = count});
    EXPECT_TRUE(inspect(r.soup).defects.valid_solid());
    EXPECT_EQ(r.reached, r.soup.facets.size() <= count + 1);
    EXPECT_GE(r.soup.facets.size() + 1, count);
  }
}

}  // namespace
}  // namespace burnish
