// Settling: where sharpening makes a surface meet itself, it goes back to what was extracted there, and nowhere else.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "burnish/core/parallel.h"
#include "burnish/extract/sharpen.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/shells.h"
#include "burnish/surface/triangle_index.h"
#include "support/creased_shapes.h"

namespace burnish {
namespace {

using namespace test;

constexpr double kCell = 1.0 / 24;
const SharpenOptions kFarReach{.reach = 4};

// Two turned boxes 2.5 cells apart.
TriangleSoup two_boxes() {
  std::mt19937_64 engine(11);
  const TriangleSoup one = box({1, 1, 1}, 2, 2, 2);
  return mapped(merged(one, moved(scaled(one, 0.6), {0.2, 0.2, 1 + 2.5 * kCell})), Rotation::random(engine));
}

// From the lower box to the upper one; their points stand in the order of those of one box.
Vec3 upwards(const TriangleSoup& boxes) {
  const std::size_t half = boxes.points.size() / 2;
  const Vec3 apart = (boxes.points[half] - boxes.points[0]) + (boxes.points.back() - boxes.points[half - 1]);
  return apart / norm(apart);
}

// What they were extracted from, and a reference whose boxes overlap by 0.6 cells: no surface on it is one of two solids.
struct Overlapping {
  TriangleSoup m, s;
  ReferenceSurface reference;
};

Overlapping overlapping() {
  const TriangleSoup solid = two_boxes();
  const GridFrame frame = make_frame(bounding_box(solid), kCell, 8);
  TriangleSoup m = extract_surface(level_set_from_triangles(solid, frame).level_set).soup;
  TriangleSoup s = to_lattice(solid, frame);
  const Vec3 up = upwards(s);
  for (std::size_t p = s.points.size() / 2; p < s.points.size(); ++p) s.points[p] = s.points[p] - up * 3.1;
  ReferenceSurface reference(s, find_creases(s));
  return {std::move(m), std::move(s), std::move(reference)};
}

TEST(Settle, BoxesThatWouldMeetStayApart) {
  const Overlapping x = overlapping();
  Sharpening sharpening(x.m, x.reference, {}, kFarReach);
  ASSERT_GT(inspect(sharpening.surface().soup).defects.self_intersecting_pairs, 0u) << "nothing to settle";
  EXPECT_TRUE(sharpening.settle().empty());
  const Defects after = inspect(sharpening.surface().soup).defects;
  EXPECT_TRUE(after.valid_solid()) << after.self_intersecting_pairs << " intersections, " << after.open_edges << " open edges";
  EXPECT_EQ(find_shells(sharpening.surface().soup).shells.size(), 2u);
}

TEST(Settle, FarFromThereNothingChanges) {
  const Overlapping x = overlapping();
  Sharpening sharpening(x.m, x.reference, {}, kFarReach);
  const Vec3 n = upwards(x.s);
  double top = -1e9;
  for (std::size_t p = 0; p < x.s.points.size() / 2; ++p) top = std::max(top, dot(n, x.s.points[p]));
  const auto far_points = [&](const TriangleSoup& soup) {
    std::vector<std::array<double, 3>> points;
    for (const Vec3& p : soup.points)
      if (std::abs(dot(n, p) - top) > 6) points.push_back({p.x, p.y, p.z});
    std::sort(points.begin(), points.end());
    return points;
  };
  const auto before = far_points(sharpening.surface().soup);
  sharpening.settle();
  EXPECT_EQ(before, far_points(sharpening.surface().soup));
  EXPECT_GT(before.size(), x.m.points.size() / 2);
}

TEST(Settle, AllTakenBackIsWhatWasExtracted) {
  const Overlapping x = overlapping();
  Sharpening sharpening(x.m, x.reference, {}, kFarReach);
  std::vector<std::uint32_t> all(sharpening.surface().soup.facets.size());
  for (std::uint32_t f = 0; f < all.size(); ++f) all[f] = f;
  EXPECT_TRUE(sharpening.take_back(all));
  const SharpenedSurface result = sharpening.surface();
  EXPECT_NEAR(signed_volume(result.soup), signed_volume(x.m), 1e-9 * signed_volume(x.m));
  const TriangleIndex m(x.m);
  for (const Vec3& p : result.soup.points) ASSERT_LT(m.closest(p).squared_distance, 1e-20);
  EXPECT_EQ(result.soup.points.size(), x.m.points.size() + result.cut) << "edges stay cut, nothing stays collapsed";
  all.resize(result.soup.facets.size());
  for (std::uint32_t f = 0; f < all.size(); ++f) all[f] = f;
  EXPECT_FALSE(sharpening.take_back(all)) << "there is nothing left to take back";
}

TEST(Settle, AShellThatEndsUpInsideAnotherGoesBack) {
  // A small ball beside a large one, and a reference that has it within.
  const TriangleSoup large = icosphere(4);
  const std::size_t count = large.points.size();
  const TriangleSoup solid = merged(large, moved(scaled(icosphere(2), 0.1), {1.2, 0, 0}));
  const GridFrame frame = make_frame(bounding_box(solid), kCell, 8);
  const TriangleSoup m = extract_surface(level_set_from_triangles(solid, frame).level_set).soup;
  TriangleSoup s = to_lattice(solid, frame);
  for (std::size_t p = count; p < s.points.size(); ++p) s.points[p].x -= 12;
  Sharpening sharpening(m, ReferenceSurface(s, {}), {}, {.reach = 20});
  ASSERT_FALSE(inspect(sharpening.surface().soup).defects.valid_solid()) << "nothing to settle";
  sharpening.settle();
  EXPECT_TRUE(inspect(sharpening.surface().soup).defects.valid_solid());
}

TEST(Settle, RoundingToTheFilesPrecisionMakesNothingMeet) {
  // Cells: edges that sharpening has made are not much longer, those of M are.
  constexpr double kStep = 0x1p-3;
  const auto round = [](const Vec3& p) { return Vec3{std::round(p.x / kStep) * kStep, std::round(p.y / kStep) * kStep, std::round(p.z / kStep) * kStep}; };
  const Overlapping x = overlapping();
  const auto pairs_as_written = [&](const SharpenOptions& options) {
    Sharpening sharpening(x.m, x.reference, {}, options);
    EXPECT_TRUE(sharpening.settle().empty());
    TriangleSoup soup = sharpening.surface().soup;
    EXPECT_TRUE(inspect(soup).defects.closed_manifold());
    for (Vec3& p : soup.points) p = round(p);
    return self_intersecting_pairs(soup).size();
  };
  SharpenOptions options = kFarReach;
  ASSERT_GT(pairs_as_written(options), 0u) << "nothing that rounding breaks";
  options.written = round;
  EXPECT_EQ(pairs_as_written(options), 0u);
}

TEST(Settle, SameBitsOnOneThreadAndOnTwo) {
  const Overlapping x = overlapping();
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    Sharpening sharpening(x.m, x.reference, {}, kFarReach);
    sharpening.settle();
    return sharpening.surface().soup;
  };
  const TriangleSoup one = run(1), two = run(2);
  EXPECT_EQ(one.facets, two.facets);
  EXPECT_EQ(one.points, two.points);
}

}  // namespace
}  // namespace burnish
