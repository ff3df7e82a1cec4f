// The main job, from file to file: what goes in damaged comes out as the right solid, or not at all.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/pipeline/clean.h"
#include "burnish/surface/compare.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/weld.h"
#include "support/folder.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

constexpr double kPi = std::numbers::pi;

CleanOptions at_resolution(int cells) {
  CleanOptions options;
  options.resolution = cells;
  return options;
}

// The level set even where single facets could be mended.
CleanOptions rebuilt() {
  CleanOptions options;
  options.method = Method::level_set;
  return options;
}

class Pipeline : public ::testing::Test {
 protected:
  RepairReport run(const TriangleSoup& soup, const CleanOptions& options = at_resolution(48), const std::string& in = "in.stl",
                   const std::string& out = "out.stl") {
    return clean(job(folder_.write(in, soup), options, out));
  }
  CleanJob job(const std::string& in, const CleanOptions& options, const std::string& out = "out.stl") const {
    CleanJob job;
    job.input = in;
    job.output = folder_.path(out);
    job.options = options;
    job.overwrite = true;
    return job;
  }
  Folder folder_;
};

// The genus of a closed surface, summed over its components: V - F / 2 = sum of 2 - 2 g.
long genus(const Defects& d) {
  const long euler = static_cast<long>(d.points) - static_cast<long>(d.facets) / 2;
  return static_cast<long>(d.components) - euler / 2;
}

void expect_verified(const RepairReport& report, double volume, std::size_t components, double tolerance = 0.02) {
  EXPECT_FALSE(report.failure) << report.failure->what();
  EXPECT_TRUE(report.verified);
  EXPECT_TRUE(report.written);
  EXPECT_TRUE(report.after.valid_solid());
  EXPECT_EQ(report.after.components, components);
  EXPECT_NEAR(report.after.volume / volume, 1, tolerance);
}

std::vector<std::size_t> chosen_facets(const TriangleSoup& soup, double share, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::vector<std::size_t> facets;
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    if (static_cast<double>(engine() >> 11) * 0x1p-53 < share) facets.push_back(f);
  return facets;
}

TriangleSoup with_flipped_facets(TriangleSoup soup, double share, std::uint64_t seed) {
  for (const std::size_t f : chosen_facets(soup, share, seed)) soup = with_flipped_facet(std::move(soup), f);
  return soup;
}

TriangleSoup without_facets_where(const TriangleSoup& soup, const std::function<bool(const Vec3&)>& drop) {
  std::vector<std::size_t> facets;
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    if (drop((soup.corner(f, 0) + soup.corner(f, 1) + soup.corner(f, 2)) / 3)) facets.push_back(f);
  return without_facets(soup, facets);
}

// n x n squares in the plane z = 0.
TriangleSoup sheet(int n) {
  return height_field(n, [n](int i, int) { return 0.1 * std::sin(3.0 * i / n); });
}

TriangleSoup noisy_sphere(int level, double sigma, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  return mapped(icosphere(level), [&](const Vec3& p) {
    double sum = -6;  // twelve uniform numbers: nearly Gaussian, the same everywhere
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(engine() >> 11) * 0x1p-53;
    return p * (1 + sigma * sum);
  });
}

struct Shape {
  const char* name;
  TriangleSoup soup;
  long genus;
};

std::vector<Shape> shapes() { return {{"sphere", icosphere(4), 0}, {"torus", torus(64, 32), 1}, {"cube", cube(), 0}}; }

TEST_F(Pipeline, CleanShapesComeBackWithinACell) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    const RepairReport report = run(shape.soup, at_resolution(64));
    expect_verified(report, signed_volume(shape.soup), 1, 0.005);
    EXPECT_EQ(genus(report.after), shape.genus);
    const double cell = report.options.cell;
    EXPECT_NEAR(report.options.cells_along_longest_side, 64, 1e-9);
    EXPECT_LE(report.deviation.output_to_input.rms, 0.1 * cell);
    EXPECT_LE(report.deviation.output_to_input.max, 1.0 * cell);
    EXPECT_LE(report.deviation.input_to_output.rms, 0.1 * cell);
    EXPECT_LE(report.deviation.input_to_output.max, 1.0 * cell);
    EXPECT_EQ(report.before.open_edges, 0u);
    EXPECT_EQ(report.actions.open_loops_capped, 0u);
  }
}

TEST_F(Pipeline, DefaultCell) {
  const TriangleSoup soup = icosphere(3);
  const RepairReport report = run(soup, rebuilt());
  expect_verified(report, signed_volume(soup), 1, 0.005);
  EXPECT_EQ(report.method, "levelset");
  EXPECT_TRUE(report.options.cell_was_chosen);
  EXPECT_LE(report.deviation.output_to_input.rms, 0.1 * report.options.cell);
}

TEST_F(Pipeline, MissingFacets) {
  for (const Shape& shape : shapes())
    for (const double share : {0.01, 0.05}) {
      if (shape.soup.facets.size() < 100) continue;
      SCOPED_TRACE(::testing::Message() << shape.name << ' ' << share);
      const auto dropped = chosen_facets(shape.soup, share, 11);
      const RepairReport report = run(without_facets(shape.soup, dropped));
      expect_verified(report, signed_volume(shape.soup), 1);
      EXPECT_EQ(genus(report.after), shape.genus);
      EXPECT_GT(report.before.open_edges, 0u);
      EXPECT_GT(report.actions.open_loops_capped, 0u);
    }
}

TEST_F(Pipeline, CubeWithoutAFacet) {
  for (std::size_t f = 0; f < 12; ++f) {
    SCOPED_TRACE(f);
    expect_verified(run(without_facets(cube(), {f}), at_resolution(24)), 1, 1);
  }
}

TEST_F(Pipeline, FlippedFacets) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    const RepairReport report = run(with_flipped_facets(shape.soup, 0.1, 5));
    expect_verified(report, signed_volume(shape.soup), 1);
    EXPECT_EQ(genus(report.after), shape.genus);
    EXPECT_GT(report.actions.facets_flipped, 0u);
  }
}

TEST_F(Pipeline, InsideOut) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    expect_verified(run(flipped(shape.soup)), signed_volume(shape.soup), 1);
  }
}

TEST_F(Pipeline, BigHoleIsClosedFlat) {
  const double z = 0.5, height = 1 - z;
  const TriangleSoup open = without_facets_where(icosphere(4), [&](const Vec3& p) { return p.z > z; });
  const double cap = kPi * height * height * (3 - height) / 3;
  const RepairReport report = run(open);
  expect_verified(report, 4.0 / 3.0 * kPi - cap, 1);
  EXPECT_EQ(report.actions.open_loops_capped, 1u);
  EXPECT_NEAR(report.actions.cap_area, kPi * (1 - z * z), 0.15);
}

TEST_F(Pipeline, DuplicatedShell) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    const RepairReport report = run(merged(shape.soup, shape.soup));
    expect_verified(report, signed_volume(shape.soup), 1);
    EXPECT_EQ(report.actions.duplicate_facets_dropped, shape.soup.facets.size());
  }
}

TEST_F(Pipeline, TwoOverlappingSpheres) {
  const double d = 1, lens = kPi * (2 - d) * (2 - d) * (d * d + 4 * d) / (12 * d);
  const RepairReport report = run(merged(icosphere(4), moved(icosphere(4), {d, 0.013, 0.007})));
  expect_verified(report, 8.0 / 3.0 * kPi - lens, 1);
  EXPECT_GT(report.before.self_intersecting_pairs, 0u);
}

TEST_F(Pipeline, TwoSpheresApart) {
  expect_verified(run(merged(icosphere(3), moved(scaled(icosphere(3), 0.4), {1.7, 0, 0}))),
                  signed_volume(icosphere(3)) * (1 + 0.064), 2);
}

TEST_F(Pipeline, CavityStays) {
  const TriangleSoup outer = icosphere(4), inner = flipped(scaled(icosphere(3), 0.5));
  expect_verified(run(merged(outer, inner)), signed_volume(outer) + signed_volume(inner), 2);
}

// A vertex in the middle of one facet's edge, which its neighbour has not, and a little off it.
TEST_F(Pipeline, CrackAtATJunction) {
  for (const double off : {0.0, 0.002, -0.002}) {
    TriangleSoup soup = cube();
    soup.points.push_back({0.5, off, off});
    soup.facets[4] = {8, 1, 5};
    soup.facets.push_back({0, 8, 5});
    SCOPED_TRACE(off);
    expect_verified(run(unwelded(soup)), 1, 1);
  }
}

// Every facet by itself, its corners off by up to 2 % of an edge.
TEST_F(Pipeline, UnweldedAndJittered) {
  std::mt19937_64 engine(3);
  const auto off = [&] { return 0.0015 * (static_cast<double>(engine() >> 11) * 0x1p-52 - 1); };
  const TriangleSoup soup = mapped(unwelded(icosphere(4)), [&](const Vec3& p) { return p + Vec3{off(), off(), off()}; });
  const RepairReport report = run(soup);
  expect_verified(report, 4.0 / 3.0 * kPi, 1);
  EXPECT_GT(report.actions.weld_tolerance, 0);
}

TEST_F(Pipeline, OpenSheetIsNoSolidAndNothingIsWritten) {
  const RepairReport report = run(sheet(20));
  ASSERT_TRUE(report.failure);
  EXPECT_EQ(report.failure->code(), ErrorCode::guarantee_unmet);
  EXPECT_FALSE(report.failure->hint().empty());
  EXPECT_FALSE(report.verified);
  EXPECT_FALSE(report.written);
  EXPECT_EQ(folder_.file_count(), 1) << "besides the input";
}

TEST_F(Pipeline, ExistingOutputIsLeftAlone) {
  const std::string in = folder_.write("in.stl", cube());
  folder_.write("out.stl", icosphere(0));
  const std::string before = folder_.bytes("out.stl");
  CleanJob refused = job(in, at_resolution(16));
  refused.overwrite = false;
  try {
    clean(refused);
    ADD_FAILURE() << "overwrote a file";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::unwritable_output);
  }
  EXPECT_EQ(folder_.bytes("out.stl"), before);
  EXPECT_EQ(folder_.file_count(), 2);
  EXPECT_TRUE(clean(job(in, at_resolution(16))).written);
  EXPECT_NE(folder_.bytes("out.stl"), before);
}

// In float32 a unit sphere at 10^6 is a heap of steps of 1/16.
TEST_F(Pipeline, FarFromTheOrigin) {
  const TriangleSoup far = moved(icosphere(3), {1e6, 1e6, 1e6});
  const std::string in = folder_.write("in.ply", far);
  const RepairReport doubles = clean(job(in, at_resolution(48), "out.ply"));
  expect_verified(doubles, signed_volume(icosphere(3)), 1);

  CleanJob as_stl = job(in, at_resolution(48), "out.stl");
  const RepairReport report = clean(as_stl);
  ASSERT_TRUE(report.failure);
  EXPECT_EQ(report.failure->code(), ErrorCode::guarantee_unmet);
  EXPECT_NE(report.failure->hint().find(".ply"), std::string::npos) << report.failure->hint();
  EXPECT_FALSE(report.written);
  EXPECT_FALSE(folder_.has("out.stl"));

  as_stl.allow_invalid = true;
  const RepairReport allowed = clean(as_stl);
  EXPECT_TRUE(allowed.failure);
  EXPECT_FALSE(allowed.verified);
  EXPECT_TRUE(allowed.written);
  EXPECT_TRUE(folder_.has("out.stl"));
}

TEST_F(Pipeline, FarFromTheOriginAsStl) {
  const RepairReport report = run(moved(icosphere(3), {1e6, 1e6, 1e6}), at_resolution(24));
  if (report.failure) {
    EXPECT_EQ(report.failure->code(), ErrorCode::guarantee_unmet);
    EXPECT_FALSE(report.failure->hint().empty());
    EXPECT_FALSE(report.written);
  } else {
    EXPECT_TRUE(report.after.valid_solid());
  }
}

TEST_F(Pipeline, TooFineForTheMemoryAllowed) {
  CleanOptions options = at_resolution(4000);
  options.memory_bytes = std::uint64_t{64} << 20;
  try {
    run(icosphere(3), options);
    ADD_FAILURE() << "planned within 64 MB";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::memory_limit);
    EXPECT_NE(error.hint().find("--cell"), std::string::npos);
  }
  EXPECT_EQ(folder_.file_count(), 1);
  options.resolution.reset();
  const RepairReport coarsened = run(icosphere(3), options);
  EXPECT_TRUE(coarsened.verified);
  EXPECT_LE(coarsened.grid.bytes_planned, options.memory_bytes);
}

TriangleSoup damaged_sphere() {
  const TriangleSoup soup = noisy_sphere(4, 0.004, 3);
  return without_facets(with_flipped_facets(soup, 0.05, 1), chosen_facets(soup, 0.02, 2));
}

TEST_F(Pipeline, SameBytesForAnyNumberOfThreads) {
  CleanOptions options = at_resolution(64);
  for (const double smooth : {0.0, 0.2}) {
    options.smooth.value = smooth;
    for (const int threads : {1, 2}) {
      const ThreadLimit limit(threads);
      EXPECT_TRUE(run(damaged_sphere(), options, "in.stl", std::to_string(threads) + ".stl").verified);
    }
    EXPECT_EQ(folder_.bytes("1.stl"), folder_.bytes("2.stl")) << "smooth " << smooth;
  }
}

TEST_F(Pipeline, PowersOfTwoScaleTheResultBitForBit) {
  CleanOptions options;
  options.smooth = {2, LengthUnit::percent_of_diagonal};
  run(damaged_sphere(), options, "in.stl", "one.ply");
  const TriangleSoup one = folder_.read("one.ply");
  ASSERT_GT(one.facets.size(), 1000u);
  for (const int power : {30, -30}) {
    const double factor = std::ldexp(1.0, power);
    run(scaled(weld(read_mesh(folder_.path("in.stl")).soup), factor), options, "scaled.stl", "scaled.ply");
    const TriangleSoup other = folder_.read("scaled.ply");
    EXPECT_EQ(other.facets, one.facets);
    EXPECT_EQ(other.points, scaled(one, factor).points) << "2^" << power;
  }
}

// In double precision the scaled file holds the same shape to 1e-16. An STL rounds every scaled coordinate to float32, by
// up to 6e-8 of it: it is another shape, and of the decisions the extraction takes on thresholds a few may fall
// otherwise, each within a small part of a cell.
TEST_F(Pipeline, PowersOfTenScaleTheResult) {
  const TriangleSoup in = damaged_sphere();
  for (const std::string suffix : {".ply", ".stl"}) {
    const RepairReport first = run(in, rebuilt(), "in" + suffix, "one" + suffix);
    ASSERT_TRUE(first.verified);
    const TriangleSoup one = folder_.read("one" + suffix);
    const TriangleIndex one_index(one);
    for (const double factor : {1e9, 1e-9}) {
      SCOPED_TRACE(suffix + " x " + std::to_string(factor));
      const RepairReport report = run(scaled(in, factor), rebuilt(), "scaled" + suffix, "other" + suffix);
      EXPECT_TRUE(report.verified);
      EXPECT_EQ(report.after.components, first.after.components);
      EXPECT_EQ(genus(report.after), genus(first.after));
      const TriangleSoup other = scaled(folder_.read("other" + suffix), 1 / factor);
      const double bound = suffix == ".ply" ? 1e-6 * first.after.box.diagonal() : 0.05 * first.options.cell;
      EXPECT_LE(one_sided_distance(other, one_index).max, bound);
      EXPECT_LE(one_sided_distance(one, TriangleIndex(other)).max, bound);
    }
  }
}

double rms_to_unit_sphere(const TriangleSoup& soup) {
  double sum = 0;
  for (const Vec3& p : soup.points) sum += (norm(p) - 1) * (norm(p) - 1);
  return std::sqrt(sum / static_cast<double>(soup.points.size()));
}

TEST_F(Pipeline, SmoothingTakesNoiseAwayAndKeepsTheVolume) {
  CleanOptions options = at_resolution(64);
  const TriangleSoup noisy = noisy_sphere(4, 0.01, 7);
  EXPECT_TRUE(run(noisy, options).verified);
  const double before = rms_to_unit_sphere(folder_.read("out.stl"));
  options.smooth.value = 0.4;
  const RepairReport report = run(noisy, options);
  expect_verified(report, signed_volume(noisy), 1, 0.002);
  const double after = rms_to_unit_sphere(folder_.read("out.stl"));
  RecordProperty("rms", std::to_string(before) + " -> " + std::to_string(after));
  EXPECT_LE(after, 0.5 * before) << before << " -> " << after;
  EXPECT_NEAR(report.smoothing.volume_after / report.smoothing.volume_before, 1, 1e-4);
  EXPECT_GT(report.smoothing.steps, 0);
  EXPECT_DOUBLE_EQ(report.smoothing.length, 0.4);
}

TEST_F(Pipeline, SmoothingStaysWithinTheDeviationAskedFor) {
  CleanOptions options = at_resolution(64);
  const TriangleSoup noisy = noisy_sphere(4, 0.01, 7);
  options.smooth.value = 0.4;
  const double free = run(noisy, options).deviation.output_to_input.max;
  options.smooth.value = 0;
  const double unsmoothed = run(noisy, options).deviation.output_to_input.max;
  options.smooth.value = 0.4;
  options.deviation = Length{0.008, LengthUnit::model};
  const RepairReport report = run(noisy, options);
  EXPECT_TRUE(report.verified);
  EXPECT_GT(free, 0.02);
  // The bound is on the distance to the repaired surface, which the grid sees as far from the input as without smoothing.
  EXPECT_LE(report.deviation.output_to_input.max, 0.008 + unsmoothed);
  RecordProperty("deviation", std::to_string(report.deviation.output_to_input.max) + " free " + std::to_string(free) + " unsmoothed " + std::to_string(unsmoothed));
}

// Bounds beyond the band of exact distances hold as well: a ball that the flow alone would make vanish.
TEST_F(Pipeline, LargeDeviationsAreBoundsToo) {
  CleanOptions options = at_resolution(24);
  options.mode = SmoothMode::mcf;
  options.smooth = {30, LengthUnit::cells};
  EXPECT_FALSE(run(icosphere(3), options).verified);
  options.deviation = Length{6, LengthUnit::cells};
  const RepairReport report = run(icosphere(3), options);
  EXPECT_TRUE(report.verified);
  EXPECT_LE(report.deviation.input_to_output.max, 6.2 * report.options.cell);
}

TEST_F(Pipeline, SmoothingAwayTheModelWritesNothing) {
  CleanOptions options = at_resolution(24);
  options.mode = SmoothMode::mcf;
  options.smooth = {40, LengthUnit::cells};
  CleanJob vanishing = job(folder_.write("in.stl", icosphere(2)), options);
  vanishing.allow_invalid = true;
  const RepairReport report = clean(vanishing);
  ASSERT_TRUE(report.failure);
  EXPECT_EQ(report.failure->code(), ErrorCode::guarantee_unmet);
  EXPECT_NE(report.failure->hint().find("--smooth"), std::string::npos);
  EXPECT_FALSE(report.written);
}

// Areas of such a model overflow: it has to be refused before a sum of them decides anything.
TEST_F(Pipeline, SizesBeyondDoublePrecisionAreRefused) {
  for (const double size : {1e100, 1e-100}) {
    SCOPED_TRACE(size);
    const std::string in = folder_.write("huge.obj", scaled(without_facets(icosphere(1), {0, 1, 2, 3}), size));
    try {
      clean(job(in, at_resolution(24)));
      FAIL() << "taken";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::unreadable_input);
      EXPECT_FALSE(error.hint().empty());
    }
  }
}

}  // namespace
}  // namespace burnish
