// What is done with openings and sheets, from file to file: kept, closed up to a size, joined, thickened.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>

#include "burnish/pipeline/clean.h"
#include "burnish/surface/compare.h"
#include "burnish/surface/edge_table.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/weld.h"
#include "support/damage.h"
#include "support/options_fixture.h"
#include "support/parts.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

constexpr double kPi = std::numbers::pi;

class Openings : public PipelineOptions {};

// A unit sphere, open at the top.
TriangleSoup bowl(int level) {
  return without_facets_where(icosphere(level), [](const Vec3& p) { return p.z > 0.3; });
}

// n x n squares over [0, 1]^2 with waves of this height.
TriangleSoup terrain(int n, double height) {
  return height_field(n, [=](int i, int j) { return height * std::sin(2 * kPi * (1.0 * i / n)) * std::cos(2 * kPi * (1.0 * j / n)); });
}

// Its open edges, each as a facet without an area: distances to it are distances to the rim.
TriangleSoup rim(const TriangleSoup& welded) {
  TriangleSoup edges{welded.points, {}, {}};
  const EdgeTable table(welded);
  for (std::size_t e = 0; e < table.size(); ++e)
    if (table.is_open(e)) edges.facets.push_back({table.edge(e)[0], table.edge(e)[1], table.edge(e)[1]});
  return weld(edges);
}

double farthest(const TriangleSoup& from, const TriangleSoup& to) {
  const TriangleIndex index(to);
  double worst = 0;
  for (const Facet& f : from.facets)
    for (const std::uint32_t p : f) worst = std::max(worst, std::sqrt(index.closest(from.points[p]).squared_distance));
  return worst;
}

double mean_distance(const TriangleSoup& from, const TriangleSoup& to) {
  return one_sided_distance(from, TriangleIndex(to), {.area_samples = 0}).mean;
}

// --- openings -------------------------------------------------------------------------------------

TEST_F(Openings, SheetsStaySheets) {
  for (const TriangleSoup& sheet : {bowl(3), terrain(20, 0.1)}) {
    SCOPED_TRACE(sheet.facets.size());
    const RepairReport report = run(sheet, keeping_openings(), "out.ply");
    expect_sheet(report, 1);
    EXPECT_EQ(report.method, "local");
    EXPECT_EQ(report.after.facets, sheet.facets.size());
    EXPECT_EQ(report.after.open_edges, report.before.open_edges);
    const TriangleSoup out = folder_.read("out.ply");
    EXPECT_EQ(area(rim(out)), 0);
    EXPECT_EQ(farthest(rim(sheet), rim(out)), 0);
    EXPECT_EQ(farthest(rim(out), rim(sheet)), 0);
    EXPECT_EQ(report.actions.facets_kept, sheet.facets.size());
    ASSERT_EQ(report.holes.size(), 1u);
    EXPECT_FALSE(report.holes[0].filled);
  }
}

// A solid whose openings may stay, and which has none, is a solid.
TEST_F(Openings, KeepingOpeningsOfASolid) { expect_solid(run(icosphere(2), keeping_openings()), signed_volume(icosphere(2)), 1, 1e-6); }

TEST_F(Openings, SheetsThatAreDamagedAreMended) {
  TriangleSoup sheet = with_random_flips(terrain(24, 0.1), 0.05, 3);
  sheet = with_copied_facet(std::move(sheet), 40);
  const RepairReport report = run(sheet, keeping_openings());
  expect_sheet(report, 1);
  EXPECT_EQ(report.after.facets, 2u * 24 * 24);
  EXPECT_EQ(report.after.open_edges, 4u * 24);
}

TEST_F(Openings, WithoutTheOptionASheetIsNoSolidAndHasAWayOut) { expect_failure(run(terrain(10, 0.1)), {"--keep-openings", "--thicken"}); }

// Noise of 1 % on a bowl: the rebuilt, smoothed and trimmed sheet is nearer to the bowl than the noise, and ends where it did.
TEST_F(Openings, ANoisyBowlIsSmoothedAndStaysOpen) {
  constexpr double kNoise = 0.01;
  const TriangleSoup truth = bowl(4);
  Random random(9);
  const TriangleSoup noisy = mapped(truth, [&](const Vec3& p) {
    double sum = -6;  // twelve uniform numbers: nearly Gaussian
    for (int i = 0; i < 12; ++i) sum += random.uniform(0, 1);
    return p * (1 + kNoise * sum);
  });
  CleanOptions options = keeping_openings();
  options.resolution = 48;
  options.smooth = model_length(0.15);
  const RepairReport report = run(noisy, options, "out.ply");
  expect_sheet(report, 1);
  EXPECT_EQ(report.method, "levelset");
  const TriangleSoup out = folder_.read("out.ply");
  // The noise moves the rim, too: by up to three times its deviation.
  const double cell = report.options.cell;
  for (const auto& [from, to] : {std::pair(rim(out), rim(truth)), std::pair(rim(truth), rim(out))}) {
    EXPECT_LE(farthest(from, to), cell + 3 * kNoise);
    EXPECT_LE(mean_distance(from, to), cell);
  }
  const double rms = one_sided_distance(out, TriangleIndex(truth)).rms;
  EXPECT_LE(rms, 0.6 * kNoise);
}

TEST_F(Openings, SmallHolesAreClosedAndLargeOnesStay) {
  const TriangleSoup sphere = icosphere(4);
  const TriangleSoup soup = without_facets_where(sphere, [](const Vec3& p) { return p.z > 0.7 || p.x > 0.97 || p.y > 0.97; });
  for (const bool rebuild : {false, true}) {
    SCOPED_TRACE(rebuild ? "level set" : "local");
    CleanOptions options;
    options.max_hole = model_length(1);
    if (rebuild) options.method = Method::level_set;
    const RepairReport report = run(soup, options, "out.ply");
    expect_sheet(report, 1);
    EXPECT_EQ(report.method, rebuild ? "levelset" : "local");
    ASSERT_EQ(report.holes.size(), 3u);
    EXPECT_FALSE(report.holes[0].filled);
    EXPECT_TRUE(report.holes[1].filled && report.holes[2].filled);
    // The rim runs along z = 0.7, up to a facet.
    const TriangleSoup edges = rim(folder_.read("out.ply"));
    for (const Facet& f : edges.facets) EXPECT_NEAR(edges.points[f[0]].z, 0.7, 0.1);
    const double area_below = area(without_facets_where(sphere, [](const Vec3& p) { return p.z > 0.7; }));
    EXPECT_NEAR(report.after.area / area_below, 1, 0.01);
  }
}

// --- thickness ------------------------------------------------------------------------------------

// The volume within T / 2 of a flat, convex sheet of area A and perimeter L is A T + L pi T^2 / 8 + pi T^3 / 6.
TEST_F(Openings, AFlatSheetGetsAThickness) {
  const double t = 0.1;
  CleanOptions options;
  options.thicken = model_length(t);
  const RepairReport report = run(terrain(4, 0), options);
  expect_solid(report, t + 4 * kPi * t * t / 8 + kPi * t * t * t / 6);
  EXPECT_EQ(report.method, "levelset");
  EXPECT_NEAR(report.after.box.extent().z, t, 0.1 * report.options.cell);
  EXPECT_NEAR(report.after.box.extent().x, 1 + t, 0.2 * report.options.cell);
  EXPECT_EQ(report.options.thicken, t);
}

TEST_F(Openings, AWavySheetGetsAThickness) {
  const double t = 0.05;
  const TriangleSoup sheet = terrain(24, 0.1);
  const Hole edge = [&] {
    CleanOptions options = keeping_openings();
    return run(sheet, options).holes.at(0);
  }();
  CleanOptions options;
  options.thicken = model_length(t);
  const RepairReport report = run(sheet, options);
  expect_solid(report, area(sheet) * t + edge.perimeter * kPi * t * t / 8, 1, 0.03);
  // Every point of the result is half the thickness from the sheet.
  EXPECT_NEAR(report.deviation.output_to_input.mean, 0.5 * t, 0.1 * report.options.cell);
  EXPECT_TRUE(report.losses.empty());
}

// --- gaps -----------------------------------------------------------------------------------------

// A block whose top face is slit from x = 1/4 to 3/4 along y = 1/2, the far bank drawn back by `width`.
TriangleSoup slit_block(double width) {
  TriangleSoup soup = unwelded(box({1, 1, 1}, 8, 8, 8));
  for (std::size_t f = 0; f < soup.facets.size(); ++f) {
    const double y = (soup.corner(f, 0).y + soup.corner(f, 1).y + soup.corner(f, 2).y) / 3;
    for (const std::uint32_t p : soup.facets[f]) {
      Vec3& at = soup.points[p];
      if (at.z == 1 && at.y == 0.5 && y > 0.5 && at.x > 0.2 && at.x < 0.8) at.y += width;
    }
  }
  return weld(soup);
}

TEST_F(Openings, GapsUpToTheWidthAreJoined) {
  const double width = 0x1p-6;
  const TriangleSoup soup = slit_block(width);
  ASSERT_EQ(inspect(soup).defects.open_loops, 1u);
  CleanOptions options;
  options.gap = model_length(1.5 * width);
  const RepairReport joined = run(soup, options, "out.ply");
  expect_solid(joined, 1, 1, 1e-12);
  EXPECT_EQ(joined.method, "local");
  EXPECT_EQ(joined.after.facets, soup.facets.size());
  EXPECT_EQ(joined.actions.points_welded_within_tolerance, 5u);
  EXPECT_EQ(joined.actions.weld_tolerance, 1.5 * width);
  EXPECT_TRUE(joined.holes.empty());

  options.gap = model_length(0.5 * width);
  const RepairReport filled = run(soup, options, "out.ply");
  expect_solid(filled, 1, 1, 1e-12);
  EXPECT_EQ(filled.actions.points_welded_within_tolerance, 0u);
  ASSERT_EQ(filled.holes.size(), 1u);
  EXPECT_GT(filled.after.facets, soup.facets.size());
}

}  // namespace
}  // namespace burnish
