// Clean shapes, damaged in every way that real files are, through the whole program with its defaults: what comes out is the
// shape that was damaged.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "burnish/pipeline/clean.h"
#include "burnish/surface/example_shapes.h"
#include "burnish/surface/weld.h"
#include "support/damage.h"
#include "support/folder.h"
#include "support/parts.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

constexpr double kPi = std::numbers::pi;

struct Shape {
  const char* name;
  TriangleSoup soup;
  long genus;
};

// Smooth shapes are coarser than a cell's default size, parts have edges along the axes and thin walls.
const Shape& sphere() {
  static const Shape shape{"sphere", icosphere(3), 0};
  return shape;
}
const Shape& ring() {
  static const Shape shape{"torus", torus(40, 20), 1};
  return shape;
}
const Shape& block() {
  static const Shape shape{"block", box({1, 0.8, 0.6}, 8, 6, 5), 0};
  return shape;
}
const Shape& angle() {
  static const Shape shape{"bracket", bracket(6), 2};
  return shape;
}
const Shape& plate() {
  static const Shape shape{"plate", thin_plate(), 0};
  return shape;
}
const Shape& vase() {
  static const Shape shape{"vase", make_example(ExampleShape::vase, {}).truth, 0};
  return shape;
}
const Shape& knot() {
  static const Shape shape{"knot", make_example(ExampleShape::knot, {}).truth, 1};
  return shape;
}

std::vector<Shape> all_shapes() { return {sphere(), ring(), block(), angle(), plate(), vase()}; }
std::vector<Shape> few_shapes() { return {sphere(), angle()}; }

// What the result has to be.
struct Truth {
  double volume = 0;
  std::size_t components = 1;
  long genus = 0;
  double volume_tolerance = 0.02;
  double lost = 0.003;  // rms distance from the damaged input to the result, in diagonals: a default cell is at most 1/300
};

// The genus of a closed surface, summed over its components: V - F / 2 = sum of 2 - 2 g.
long genus(const Defects& d) {
  const long euler = static_cast<long>(d.points) - static_cast<long>(d.facets) / 2;
  return static_cast<long>(d.components) - euler / 2;
}

class Damage : public ::testing::Test {
 protected:
  RepairReport run(const TriangleSoup& dirty, const CleanOptions& options = {}) {
    CleanJob job;
    job.options = options;
    job.input = folder_.write("in.stl", dirty);
    job.output = folder_.path("out.stl");
    job.overwrite = true;
    return clean(job);
  }

  void expect_repaired(const TriangleSoup& dirty, const Truth& truth) {
    const RepairReport report = run(dirty);
    ASSERT_FALSE(report.failure) << report.failure->what();
    EXPECT_TRUE(report.verified && report.written);
    EXPECT_TRUE(report.after.valid_solid());
    EXPECT_NEAR(report.after.volume / truth.volume, 1, truth.volume_tolerance);
    EXPECT_EQ(report.after.components, truth.components);
    EXPECT_EQ(genus(report.after), truth.genus);
    EXPECT_LE(report.deviation.input_to_output.rms / report.before.box.diagonal(), truth.lost);
  }

  // `damage` with two seeds on each of the shapes; the result has to be the shape itself.
  void expect_shapes_back(const std::vector<Shape>& shapes, const std::function<TriangleSoup(const TriangleSoup&, std::uint64_t)>& damage,
                          double lost = 0.003) {
    for (const Shape& shape : shapes)
      for (const std::uint64_t seed : {1, 2}) {
        SCOPED_TRACE(::testing::Message() << shape.name << ", seed " << seed);
        expect_repaired(damage(shape.soup, seed), {.volume = signed_volume(shape.soup), .genus = shape.genus, .lost = lost});
      }
  }

  Folder folder_;
};

// What is clean comes back as it is, up to the order of its facets.
TEST_F(Damage, None) {
  std::vector<Shape> shapes = all_shapes();
  shapes.push_back(knot());
  for (const Shape& shape : shapes) {
    SCOPED_TRACE(shape.name);
    const RepairReport report = run(shape.soup, {});
    ASSERT_TRUE(report.verified);
    EXPECT_EQ(report.after.facets, report.before.facets);
    EXPECT_EQ(report.after.points, report.before.points);
    EXPECT_NEAR(report.after.volume / report.before.volume, 1, 1e-6);
    EXPECT_EQ(genus(report.after), shape.genus);
    EXPECT_LE(report.deviation.input_to_output.max, 1e-6 * report.before.box.diagonal());
    EXPECT_LE(report.deviation.output_to_input.max, 1e-6 * report.before.box.diagonal());
  }
}

TEST_F(Damage, FacetsInAnyOrder) { expect_shapes_back({angle()}, shuffled); }

// --- facets one by one ---------------------------------------------------------------------------

TEST_F(Damage, UnweldedAndJittered) {
  expect_shapes_back({sphere(), block(), angle(), vase()}, [](const TriangleSoup& s, std::uint64_t seed) { return unwelded_and_jittered(s, 0.02, seed); });
}

TEST_F(Damage, OnePercentOfFacetsMissing) {
  expect_shapes_back({sphere(), block()}, [](const TriangleSoup& s, std::uint64_t seed) { return without_random_facets(s, 0.01, seed); });
}

TEST_F(Damage, FivePercentOfFacetsMissing) {
  expect_shapes_back({ring(), angle(), vase()}, [](const TriangleSoup& s, std::uint64_t seed) { return without_random_facets(s, 0.05, seed); });
}

// Holes grow together: not for parts whose holes and walls are a few facets wide.
TEST_F(Damage, TwentyPercentOfFacetsMissing) {
  expect_shapes_back({sphere(), ring(), block()}, [](const TriangleSoup& s, std::uint64_t seed) { return without_random_facets(s, 0.2, seed); });
}

TEST_F(Damage, TenPercentOfFacetsFlipped) {
  expect_shapes_back({ring(), block(), vase()}, [](const TriangleSoup& s, std::uint64_t seed) { return with_random_flips(s, 0.1, seed); });
}

TEST_F(Damage, ThirtyPercentOfFacetsFlipped) {
  expect_shapes_back(few_shapes(), [](const TriangleSoup& s, std::uint64_t seed) { return with_random_flips(s, 0.3, seed); });
}

TEST_F(Damage, FacetsMissingAndFlipped) {
  expect_shapes_back(few_shapes(), [](const TriangleSoup& s, std::uint64_t seed) {
    return with_random_flips(without_random_facets(s, 0.05, seed), 0.1, seed);
  });
}

TEST_F(Damage, FacetsTwice) {
  expect_shapes_back(few_shapes(), [](const TriangleSoup& s, std::uint64_t seed) { return with_random_copies(s, 0.1, seed); });
}

TEST_F(Damage, Slivers) {
  expect_shapes_back(few_shapes(), [](const TriangleSoup& s, std::uint64_t seed) { return with_slivers(s, 0.05, seed); });
}

// --- holes and cracks ----------------------------------------------------------------------------

// A fifth of a sphere's surface is a cap of height 2/5; the disc through its rim closes the hole with the least area. The rim
// runs along facets, so the cap is known up to the facets' size.
TEST_F(Damage, AFifthOfTheSurfaceIsAHole) {
  const double height = 2 * 0.2, cap = kPi * height * height * (3 - height) / 3;
  for (const int level : {3, 4})
    for (const std::uint64_t seed : {1, 2}) {
      SCOPED_TRACE(::testing::Message() << "sphere, level " << level << ", seed " << seed);
      const TriangleSoup whole = icosphere(level);
      expect_repaired(with_round_hole(whole, 0.2, seed), {.volume = signed_volume(whole) * (1 - cap / (4.0 / 3.0 * kPi))});
    }
}

// Small against the part: what the cap cuts off, where the hole takes an edge with it, does not count.
TEST_F(Damage, HoleInAPart) {
  expect_shapes_back({block()}, [](const TriangleSoup& s, std::uint64_t seed) { return with_round_hole(s, 0.03, seed); });
}

TEST_F(Damage, TJunctions) {
  expect_shapes_back({ring(), angle(), plate()}, [](const TriangleSoup& s, std::uint64_t seed) { return with_t_junctions(s, 0.1, 0.01, seed); });
}

TEST_F(Damage, TJunctionsInLine) {
  expect_shapes_back({block()}, [](const TriangleSoup& s, std::uint64_t seed) { return with_t_junctions(s, 0.3, 0, seed); });
}

TEST_F(Damage, Slits) {
  expect_shapes_back(few_shapes(), [](const TriangleSoup& s, std::uint64_t seed) { return with_slits(s, 3, 8, 0.05, seed); });
}

TEST_F(Damage, GapingSlits) {
  expect_shapes_back({sphere(), ring()}, [](const TriangleSoup& s, std::uint64_t seed) { return with_slits(s, 3, 6, 0.3, seed); });
}

// --- orientation ---------------------------------------------------------------------------------

TEST_F(Damage, InsideOut) {
  for (const Shape& shape : all_shapes()) {
    SCOPED_TRACE(shape.name);
    expect_repaired(flipped(shape.soup), {.volume = signed_volume(shape.soup), .genus = shape.genus});
  }
}

TEST_F(Damage, OneOfThreeBodiesInsideOut) {
  const TriangleSoup& soup = block().soup;
  for (const double beside : {1.2, -1.2}) {
    SCOPED_TRACE(beside);
    const TriangleSoup dirty = merged(merged(soup, flipped(moved(soup, {beside, 0.1, 0}))), moved(soup, {0.1, 1.1, 0}));
    expect_repaired(dirty, {.volume = 3 * signed_volume(soup), .components = 3});
  }
}

// --- several bodies ------------------------------------------------------------------------------

TEST_F(Damage, ShellTwice) {
  expect_shapes_back(few_shapes(), [](const TriangleSoup& s, std::uint64_t seed) { return merged(s, shuffled(s, seed)); });
}

TEST_F(Damage, ShellTwiceOnceInsideOut) {
  expect_shapes_back(few_shapes(), [](const TriangleSoup& s, std::uint64_t seed) { return merged(s, shuffled(flipped(s), seed)); });
}

TEST_F(Damage, ShellTwiceNearlyTheSame) {
  expect_shapes_back(few_shapes(), [](const TriangleSoup& s, std::uint64_t seed) { return merged(s, jittered(s, 1e-4, seed)); });
}

// Overlapping surfaces are input too, and no part of the result: they are as far from it as they reach inside.
constexpr double kInsideCounts = 0.2;

TEST_F(Damage, TwoOverlappingSpheres) {
  const TriangleSoup& soup = sphere().soup;
  const double d = 1, lens = kPi * (2 - d) * (2 - d) * (d * d + 4 * d) / (12 * d);
  const double faceted = signed_volume(soup) / (4.0 / 3.0 * kPi);
  for (const Vec3& by : {Vec3{d, 0, 0}, Vec3{0.36, 0.48, 0.8}}) {
    SCOPED_TRACE(by.x);
    expect_repaired(merged(soup, moved(soup, by)), {.volume = faceted * (8.0 / 3.0 * kPi - lens), .lost = kInsideCounts});
  }
}

// Boxes in a row, each overlapping the next: with faces in common planes, and without.
TEST_F(Damage, ThreeOverlappingBoxes) {
  const TriangleSoup unit = box({1, 1, 1}, 4, 4, 4);
  for (const double off : {0.0, 0.1}) {
    SCOPED_TRACE(off);
    const TriangleSoup dirty = merged(merged(unit, moved(unit, {0.5, off, off})), moved(unit, {1.1, -off, off}));
    // The union of two sections, where boxes overlap: by 0.5 and by 0.4.
    const double first = 2 - (1 - off) * (1 - off), second = 2 - (1 - 2 * off);
    expect_repaired(dirty, {.volume = 0.5 + 0.5 * first + 0.1 + 0.4 * second + 0.6, .lost = kInsideCounts});
  }
}

TEST_F(Damage, BodiesThatTouchInAFace) {
  const TriangleSoup unit = box({1, 1, 1}, 4, 4, 4);
  expect_repaired(merged(unit, moved(unit, {1, 0, 0})), {.volume = 2, .lost = kInsideCounts});
}

TEST_F(Damage, CavityStays) {
  const TriangleSoup& outer = sphere().soup;
  const TriangleSoup inner = scaled(icosphere(2), 0.5);
  const double volume = signed_volume(outer) - signed_volume(inner);
  expect_repaired(merged(outer, flipped(inner)), {.volume = volume, .components = 2});
}

// Neither flips in the cavity's wall nor holes in the shell, through which it can be seen from outside, fill it.
TEST_F(Damage, CavityStaysWhateverElseIsWrong) {
  const TriangleSoup &outer = sphere().soup, inner = flipped(scaled(icosphere(2), 0.5));
  const double volume = signed_volume(outer) + signed_volume(inner);
  for (const std::uint64_t seed : {1, 2})
    for (const double missing : {0.0, 0.05})
      for (const double wrong : {0.0, 0.1}) {
        if (missing + wrong == 0) continue;
        SCOPED_TRACE(::testing::Message() << "missing " << missing << ", flipped " << wrong << ", seed " << seed);
        expect_repaired(merged(without_random_facets(outer, missing, seed), with_random_flips(inner, wrong, seed + 1)),
                        {.volume = volume, .components = 2});
      }
}

// A solid within a solid, facing as the outer one does, adds nothing to it.
TEST_F(Damage, NestedBody) {
  const TriangleSoup& outer = block().soup;
  const TriangleSoup inner = moved(scaled(icosphere(2), 0.2), {0.5, 0.4, 0.3});
  expect_repaired(merged(outer, inner), {.volume = signed_volume(outer), .lost = kInsideCounts});
}

TEST_F(Damage, BodyWithinACavity) {
  const TriangleSoup &outer = sphere().soup, middle = scaled(icosphere(3), 0.7), inner = scaled(icosphere(2), 0.3);
  const double volume = signed_volume(outer) - signed_volume(middle) + signed_volume(inner);
  expect_repaired(merged(merged(outer, flipped(middle)), inner), {.volume = volume, .components = 3});
}

// --- sheets --------------------------------------------------------------------------------------

TEST_F(Damage, Fin) {
  expect_shapes_back({sphere(), block()}, [](const TriangleSoup& s, std::uint64_t seed) { return with_fin(s, 5, 1, seed); }, 0.02);
}

}  // namespace
}  // namespace burnish
