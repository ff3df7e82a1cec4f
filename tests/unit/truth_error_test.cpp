#include "burnish/surface/truth_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "burnish/core/parallel.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

constexpr double kDegree = std::numbers::pi / 180;

ClosestQuery query(const TriangleIndex& index) {
  return [&index](const Vec3& p) -> ClosestPoint {
    const TriangleIndex::Closest c = index.closest(p);
    return {c.point, c.squared_distance, c.facet};
  };
}

TruthError error_of(const TriangleSoup& result, const TriangleSoup& truth, double near_crease = 0.1, double crease_angle = 30) {
  const TriangleIndex of_result(result), of_truth(truth);
  return truth_error(result, query(of_result), truth, query(of_truth), CreaseEdges(truth, crease_angle), {60'000, near_crease});
}

// Two unit squares that meet at right angles along the y axis, facing up; the one on the right is turned up about that axis by `angle`.
TriangleSoup valley(double angle) {
  const double left = 135 * kDegree, right = 45 * kDegree + angle;
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {0, 1, 0}, {std::cos(left), 0, std::sin(left)}, {std::cos(left), 1, std::sin(left)},
                 {std::cos(right), 0, std::sin(right)}, {std::cos(right), 1, std::sin(right)}};
  soup.facets = {{0, 1, 3}, {0, 3, 2}, {0, 4, 5}, {0, 5, 1}};
  return soup;
}

TEST(CreaseEdges, OfACubeAreItsEdges) {
  const CreaseEdges creases(cube(), 30);
  EXPECT_EQ(creases.count(), 12u);
  EXPECT_EQ(creases.length(), 12);
  EXPECT_TRUE(creases.within({0.5, 0.1, 0}, 0.1 + 1e-15));
  EXPECT_FALSE(creases.within({0.5, 0.1, 0}, 0.1 - 1e-15));
  EXPECT_FALSE(creases.within({0.5, 0.5, 0}, 0.49)) << "the middle of a face's diagonal";
  EXPECT_EQ(CreaseEdges(cube(), 91).count(), 0u);
  EXPECT_FALSE(CreaseEdges(cube(), 91).within({0, 0, 0}, 1));
}

TEST(CreaseEdges, OfACoarseSphereDependOnTheAngle) {
  EXPECT_EQ(CreaseEdges(icosphere(0), 41).count(), 30u);  // an icosahedron's normals turn by 41.8 degrees
  EXPECT_EQ(CreaseEdges(icosphere(0), 42).count(), 0u);
}

TEST(CreaseEdges, RimsAreNoneAndFacetsWithoutAreaHideNone) {
  TriangleSoup sliver = valley(0);
  EXPECT_EQ(CreaseEdges(sliver, 30).count(), 1u);
  EXPECT_EQ(CreaseEdges(sliver, 30).length(), 1);
  sliver.points[5] = sliver.points[1];  // takes the normal of the facet behind it
  EXPECT_EQ(CreaseEdges(sliver, 30).count(), 1u);
}

TEST(TruthError, OfTheTruthItselfIsNone) {
  const TruthError e = error_of(torus(60, 30), torus(60, 30));
  EXPECT_LT(e.all.rms(), 1e-15);
  EXPECT_LT(e.all.angle(), 0.05);  // samples that are rounded to the other side of an edge
  EXPECT_EQ(e.all.there.samples, 60'000u);
  EXPECT_EQ(e.all.back.samples, 60'000u);
}

TEST(TruthError, OfAWingThatIsTurned) {
  const double alpha = 10 * kDegree, near = 0.25, sine = std::sin(alpha);
  const TruthError e = error_of(valley(alpha), valley(0), near);
  // Half the area is off by alpha, and by s sin(alpha) at s from the crease; the projection of either wing lies within the other one's length.
  for (const ErrorFigures& way : {e.all.there, e.all.back}) {
    EXPECT_NEAR(way.angle, 5, 1e-3);
    EXPECT_NEAR(way.rms, sine / std::sqrt(6.0), 5e-5);
  }
  EXPECT_NEAR(e.all.angle(), 5, 1e-3);
  EXPECT_NEAR(e.all.rms(), sine / std::sqrt(6.0), 5e-5);
  // Near is what the truth's point is: s of samples of the truth, s cos(alpha) of those of the turned wing.
  const double share_there = 0.5 * (near + near / std::cos(alpha));
  EXPECT_NEAR(static_cast<double>(e.near_creases.there.samples) / 60'000, share_there, 1e-3);
  EXPECT_NEAR(static_cast<double>(e.near_creases.back.samples) / 60'000, near, 1e-3);
  EXPECT_NEAR(e.near_creases.back.angle, 5, 0.02);
  EXPECT_NEAR(e.near_creases.back.rms, near * sine / std::sqrt(6.0), 1e-4);
  EXPECT_NEAR(e.elsewhere.back.angle, 5, 0.02);
  EXPECT_NEAR(e.elsewhere.back.rms, sine * std::sqrt((1 - near * near * near) / (1 - near) / 6), 1e-4);
  EXPECT_EQ(e.near_creases.there.samples + e.elsewhere.there.samples, 60'000u);
}

TEST(TruthError, OfConcentricSpheresIsTheirDistance) {
  const TriangleSoup inner = icosphere(5), outer = scaled(inner, 1.1);
  const TruthError e = error_of(outer, inner);
  EXPECT_NEAR(e.all.there.rms, 0.1, 1e-4);
  EXPECT_NEAR(e.all.back.rms, 0.1, 1e-4);
  EXPECT_LT(e.all.angle(), 0.2);  // neighbours are 2 degrees apart
  EXPECT_TRUE(e.near_creases.empty());
  EXPECT_EQ(e.elsewhere.there.samples, e.all.there.samples);
  EXPECT_EQ(e.elsewhere.rms(), e.all.rms());
}

// A sphere moved by d: by d cos(polar angle) along the normal, so rms d / sqrt 3; the normal at the closest point is off by asin(d sin(...)),
// of mean d pi / 4 to first order.
TEST(TruthError, OfASphereThatIsMoved) {
  const double d = 0.01;
  const TriangleSoup sphere = icosphere(6);
  const TruthError e = error_of(moved(sphere, {0, 0, d}), sphere);
  EXPECT_NEAR(e.all.rms(), d / std::sqrt(3.0), 2e-5);
  EXPECT_NEAR(e.all.angle(), d * std::numbers::pi / 4 / kDegree, 0.1);  // facets turn in steps of a degree
}

TEST(TruthError, OfTheTruthInsideOutIsAHalfTurn) {
  const TruthError e = error_of(flipped(icosphere(3)), icosphere(3));
  EXPECT_NEAR(e.all.angle(), 180, 0.2);
  EXPECT_LT(e.all.rms(), 1e-15);
}

TEST(TruthError, SeesWhatIsMissingAndWhatIsTooMuch) {
  const TriangleSoup large = icosphere(3), both = merged(large, moved(icosphere(3), {10, 0, 0}));
  const TruthError missing = error_of(large, both), surplus = error_of(both, large);
  EXPECT_LT(missing.all.there.rms, 1e-15);
  EXPECT_GT(missing.all.back.rms, 5);
  EXPECT_EQ(missing.all.back.rms, surplus.all.there.rms);
  EXPECT_DOUBLE_EQ(missing.all.rms(), std::hypot(missing.all.there.rms, missing.all.back.rms) / std::numbers::sqrt2);
}

TEST(TruthError, HasNoNumbersWhereThereIsNothing) {
  const TruthError none = error_of(TriangleSoup{}, cube());
  EXPECT_TRUE(none.all.empty());
  TriangleSoup folded = cube();
  for (Facet& f : folded.facets) f[2] = f[1];
  const TruthError flat = error_of(cube(), folded);
  EXPECT_EQ(flat.all.back.samples, 0u);
  EXPECT_TRUE(std::isnan(flat.all.there.angle));
  EXPECT_EQ(flat.all.rms(), flat.all.there.rms);
}

TEST(TruthError, SameBitsForAnyNumberOfThreads) {
  const auto measure = [](int threads) {
    const ThreadLimit limit(threads);
    return error_of(scaled(torus(50, 20), 1.01), torus(40, 30), 0.01, 5);
  };
  const TruthError one = measure(1), four = measure(4);
  EXPECT_FALSE(one.near_creases.empty() || one.elsewhere.empty());
  EXPECT_EQ(one.all.angle(), four.all.angle());
  EXPECT_EQ(one.near_creases.rms(), four.near_creases.rms());
  EXPECT_EQ(one.elsewhere.angle(), four.elsewhere.angle());
}

TEST(FacetErrors, AreThoseOfTheirCentroids) {
  const double alpha = 10 * kDegree;
  const TriangleSoup result = valley(alpha), truth = valley(0);
  const TriangleIndex index(truth);
  const FacetErrors e = facet_errors(result, truth, query(index));
  ASSERT_EQ(e.angle.size(), 4u);
  for (std::size_t f = 0; f < 2; ++f) {
    EXPECT_NEAR(e.angle[f], 0, 1e-12);
    EXPECT_NEAR(e.distance[f], 0, 1e-15);
    EXPECT_NEAR(e.angle[f + 2], 10, 1e-12);
  }
  EXPECT_NEAR(e.distance[2], 2.0 / 3 * std::sin(alpha), 1e-15);
  EXPECT_NEAR(e.distance[3], 1.0 / 3 * std::sin(alpha), 1e-15);
}

}  // namespace
}  // namespace burnish
