// What a user can ask for, one option at a time, from file to file: method, bodies, position; and what the report lists.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "burnish/pipeline/clean.h"
#include "burnish/surface/compare.h"
#include "burnish/surface/weld.h"
#include "support/options_fixture.h"
#include "support/parts.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

// Of all losses together: there is one for each place.
struct AllLosses {
  double area = 0, distance = 0;
};

AllLosses together(const std::vector<Loss>& losses, const std::string& reason) {
  AllLosses all;
  for (const Loss& loss : losses) {
    EXPECT_EQ(loss.reason, reason);
    all.area += loss.area;
    all.distance = std::max(all.distance, loss.distance);
  }
  return all;
}

// --- method ---------------------------------------------------------------------------------------

TEST_F(PipelineOptions, WhatIsValidComesBackBitForBit) {
  // In float32 as an STL stores it; a PLY stores doubles.
  const TriangleSoup part = weld(moved(bracket(5), {0.1, 0.2, 0.3}));
  run(part, {}, "once.stl");
  const TriangleSoup as_stl = folder_.read("once.stl");
  for (const std::string suffix : {".stl", ".ply"}) {
    SCOPED_TRACE(suffix);
    const TriangleSoup& in = suffix == ".stl" ? as_stl : part;
    const RepairReport report = run(in, {}, "out" + suffix, "in" + suffix);
    expect_solid(report, signed_volume(part), 1, 1e-6);
    EXPECT_EQ(report.method, "local");
    EXPECT_NE(report.method_reason.find("valid as it is"), std::string::npos);
    const TriangleSoup out = folder_.read("out" + suffix);
    EXPECT_EQ(out.points, in.points);
    EXPECT_EQ(out.facets, in.facets);
    EXPECT_EQ(report.options.cell, 0);
    EXPECT_TRUE(report.changes.empty() && report.losses.empty() && report.holes.empty());
    EXPECT_EQ(report.actions.facets_kept, in.facets.size());
    EXPECT_EQ(report.actions.facets_added + report.actions.facets_removed, 0u);
  }
}

// One facet is missing: it comes back, and nothing else changes.
TEST_F(PipelineOptions, AutomaticMendsWhatIsBrokenAndNothingElse) {
  const TriangleSoup whole = icosphere(3), in = weld(without_facets(whole, {500}));
  const RepairReport report = run(in, {}, "out.ply");
  expect_solid(report, signed_volume(whole), 1, 1e-12);
  EXPECT_EQ(report.method, "local");
  EXPECT_EQ(report.actions.facets_kept, in.facets.size());
  EXPECT_EQ(report.actions.facets_added, 1u);
  ASSERT_EQ(report.changes.size(), 1u);
  EXPECT_EQ(report.changes[0].facets_added, 1u);
  EXPECT_NEAR(norm(report.changes[0].position - (whole.corner(500, 0) + whole.corner(500, 1) + whole.corner(500, 2)) / 3), 0, 0.1);
}

TEST_F(PipelineOptions, MethodsGiveReasons) {
  const TriangleSoup soup = icosphere(2);
  const auto reason = [&](const CleanOptions& options) {
    const RepairReport report = run(soup, options);
    EXPECT_TRUE(report.verified && report.written);
    return std::pair(report.method, report.method_reason);
  };
  const std::string rebuilt = "levelset";
  EXPECT_EQ(reason({}).first, "local");
  EXPECT_EQ(reason(with_method(Method::local)).first, "local");
  CleanOptions options;
  options.resolution = 24;
  EXPECT_EQ(reason(options), std::pair(rebuilt, std::string("a cell was asked for")));
  options.thicken = model_length(0.3);
  EXPECT_EQ(reason(options), std::pair(rebuilt, std::string("a thickness was asked for")));
  options.smooth = model_length(0.2);
  EXPECT_EQ(reason(options), std::pair(rebuilt, std::string("smoothing of the level set was asked for")));
  options.method = Method::level_set;
  EXPECT_EQ(reason(options), std::pair(rebuilt, std::string("asked for")));
}

TriangleSoup block(double at, double side) { return moved(scaled(cube(), side), {at, at, at}); }

// Two cavities that overlap each other, in a file that is right and in one that is inside out.
TEST_F(PipelineOptions, CavitiesThatOverlapStayCavities) {
  const TriangleSoup soup = merged(block(0, 20), flipped(merged(block(4, 6), block(8, 6))));
  for (const TriangleSoup& in : {soup, flipped(soup)}) expect_solid(run(in), 8000 - 216 - 216 + 8, 2, 1e-6);
  CleanOptions solid;
  solid.nesting = Nesting::solid;
  expect_solid(run(soup, solid), 8000, 1, 1e-9);
}

// What encloses nothing is no part of the solid, and is told as lost.
TEST_F(PipelineOptions, ADoubledCavityWallIsLostAloud) {
  const RepairReport report = run(merged(merged(block(0, 20), flipped(block(2, 16))), merged(flipped(block(3, 14)), block(6, 8))));
  EXPECT_TRUE(report.verified);
  EXPECT_FALSE(report.losses.empty());
  EXPECT_FALSE(report.warnings.empty());
}

// However thin or many: what is valid is not judged for its shape.
TEST_F(PipelineOptions, ThinSolidsThatAreValidComeBack) {
  const TriangleSoup plate = mapped(cube(), [](const Vec3& p) { return Vec3{100 * p.x, 100 * p.y, 1e-4 * p.z}; });
  EXPECT_TRUE(run(plate).verified);
  TriangleSoup chips;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j)
      chips = merged(chips, mapped(cube(), [&](const Vec3& p) { return Vec3{10 * p.x + 11 * i, 10 * p.y + 11 * j, 0.05 * p.z}; }));
  const RepairReport report = run(chips);
  EXPECT_TRUE(report.verified);
  EXPECT_EQ(report.after.components, 1600u);
}

TEST_F(PipelineOptions, CavitiesGoWithTheirBody) {
  const TriangleSoup soup = merged(block(0, 10), flipped(block(4, 1)));
  CleanOptions options;
  options.min_component = VolumeLimit{2, false};
  expect_solid(run(soup, options), 999, 2, 1e-9);
  options.min_component = VolumeLimit{1e9, false};
  EXPECT_TRUE(run(soup, options).failure);
  CleanOptions largest;
  largest.keep_largest = true;
  const RepairReport report = run(merged(merged(block(0, 20), flipped(block(2, 16))), block(6, 8)), largest);
  EXPECT_TRUE(report.verified);
  EXPECT_NEAR(report.after.volume, 8000 - 4096, 1e-9);
}

// Fine tessellations of faces in common planes: nearly linear in their facets.
TEST_F(PipelineOptions, CoplanarFacesAreUnited) {
  const TriangleSoup fine = scaled(box({1, 1, 1}, 24, 24, 24), 10);
  const RepairReport report = run(merged(fine, moved(fine, {3.375, 1.125, 0})));
  EXPECT_EQ(report.method, "local");
  EXPECT_NEAR(report.after.volume, 2000 - 6.625 * 8.875 * 10, 1e-6);
  EXPECT_EQ(report.after.components, 1u);
}

TEST_F(PipelineOptions, OverlappingBodiesAreUnitedExactly) {
  const TriangleSoup soup = merged(box({1, 1, 1}, 4, 4, 4), moved(box({1, 1, 1}, 4, 4, 4), {0.5, 0.25, 0.125}));
  const RepairReport united = run(soup);
  EXPECT_EQ(united.method, "local");
  EXPECT_EQ(united.after.components, 1u);
  EXPECT_NEAR(united.after.volume, 2 - 0.5 * 0.75 * 0.875, 1e-12);
  EXPECT_GT(united.actions.facets_kept, soup.facets.size() / 2);
  EXPECT_GT(united.actions.facets_cut, 0u);
  EXPECT_EQ(with_fate(united, "merged").size(), 2u);
}

// --- bodies inside bodies ---------------------------------------------------------------------------

TEST_F(PipelineOptions, NestedBodiesAreWhatIsAskedFor) {
  const TriangleSoup outer = icosphere(3), inner = scaled(icosphere(2), 0.5);
  const double full = signed_volume(outer), hollow = full - signed_volume(inner);
  for (const bool same_way : {true, false})
    for (const bool inside_out : {false, true})
      for (const Method method : {Method::automatic, Method::level_set}) {
        SCOPED_TRACE(::testing::Message() << "same way " << same_way << ", inside out " << inside_out << ", " << name(method));
        TriangleSoup soup = merged(outer, same_way ? inner : flipped(inner));
        if (inside_out) soup = flipped(soup);
        CleanOptions options = quick(method);
        const double tolerance = method == Method::automatic ? 1e-6 : 0.01;
        options.nesting = Nesting::solid;
        const RepairReport solid = run(soup, options);
        expect_solid(solid, full, 1, tolerance);
        EXPECT_EQ(with_fate(solid, "absorbed").size(), 1u);
        options.nesting = Nesting::cavity;
        const RepairReport cavity = run(soup, options);
        expect_solid(cavity, hollow, 2, tolerance);
        EXPECT_EQ(with_fate(cavity, "cavity").size(), 1u);
        options.nesting = Nesting::automatic;
        expect_solid(run(soup, options), same_way ? full : hollow, same_way ? 1 : 2, tolerance);
      }
}

// --- components -----------------------------------------------------------------------------------

// Spheres of radius 1, 1/2 and 1/5: volumes of 1, 1/8 and 1/125.
TriangleSoup three_spheres() {
  const TriangleSoup s = icosphere(2);
  return merged(merged(moved(scaled(s, 0.5), {3, 0, 0}), s), moved(scaled(s, 0.2), {0, 3, 0}));
}

TEST_F(PipelineOptions, OnlyTheLargestComponentStays) {
  CleanOptions options;
  options.keep_largest = true;
  const RepairReport report = run(three_spheres(), options, "out.ply");
  expect_solid(report, signed_volume(icosphere(2)), 1, 1e-12);
  const std::vector<ComponentFate> dropped = with_fate(report, "dropped");
  ASSERT_EQ(dropped.size(), 2u);
  EXPECT_EQ(dropped[0].reason, "not the largest component");
  EXPECT_EQ(dropped[0].facets, 320u);
  EXPECT_NEAR(dropped[0].volume, signed_volume(icosphere(2)) / 8, 1e-12);
  EXPECT_NEAR(norm(dropped[0].position - Vec3{3, 0, 0}), 0.5, 0.02);
  ASSERT_FALSE(report.losses.empty());
  EXPECT_EQ(report.losses[0].reason, "a component that was not wanted");
}

// The largest one's cavity is part of it.
TEST_F(PipelineOptions, TheLargestComponentKeepsItsCavity) {
  CleanOptions options;
  options.keep_largest = true;
  const TriangleSoup inner = scaled(icosphere(1), 0.4);
  expect_solid(run(merged(three_spheres(), flipped(inner)), options), signed_volume(icosphere(2)) - signed_volume(inner), 2, 1e-6);
}

TEST_F(PipelineOptions, SmallComponentsAreDropped) {
  const double unit = signed_volume(icosphere(2));
  struct Limit {
    VolumeLimit limit;
    std::size_t stay;
    double volume;
  };
  for (const auto& [limit, stay, volume] : {Limit{{0.1, false}, 2, 1 + 1 / 8.0}, Limit{{5, true}, 2, 1 + 1 / 8.0}, Limit{{20, true}, 1, 1},
                                            Limit{{0.001, false}, 3, 1 + 1 / 8.0 + 1 / 125.0}, Limit{{0.5, true}, 3, 1 + 1 / 8.0 + 1 / 125.0}}) {
    SCOPED_TRACE(::testing::Message() << limit.value << (limit.percent_of_largest ? " %" : ""));
    CleanOptions options;
    options.min_component = limit;
    const RepairReport report = run(three_spheres(), options);
    expect_solid(report, unit * volume, stay, 1e-6);
    EXPECT_EQ(with_fate(report, "kept").size(), stay);
    for (const ComponentFate& c : with_fate(report, "dropped")) EXPECT_EQ(c.reason, "smaller than --min-component");
    EXPECT_EQ(report.components.size(), 3u);
  }
}

// What lies inside other bodies, whether a whole facet or part of one, and what was to be dropped is no reason to warn.
TEST_F(PipelineOptions, NothingIsLostWhereBodiesOverlapOrAreDropped) {
  const TriangleSoup large = scaled(cube(), 2);
  CleanOptions options;
  options.resolution = 60;
  for (const Vec3& by : {Vec3{1.5, 0.5, 0.4}, Vec3{1.2, 0.5, 0.4}, Vec3{0.5, 0.5, 0.4}}) {
    SCOPED_TRACE(by.x);
    const RepairReport united = run(merged(large, moved(cube(), by)), options);
    expect_solid(united, 8 + std::max(by.x - 1, 0.0));
    for (const Loss& loss : united.losses) EXPECT_EQ(loss.reason, "inside the solid") << loss.area;
    EXPECT_EQ(united.actions.area_lost, 0);
    EXPECT_EQ(united.actions.components_lost, 0u);
    EXPECT_TRUE(united.warnings.empty()) << united.warnings[0];
  }
  options.keep_largest = true;
  const RepairReport dropped = run(merged(large, moved(cube(), {4, 0, 0})), options);
  expect_solid(dropped, 8);
  EXPECT_EQ(dropped.actions.components_lost, 0u);
  for (const Loss& loss : dropped.losses) EXPECT_EQ(loss.reason, "a component that was not wanted");
}

// --- position -------------------------------------------------------------------------------------

// Coordinates as a survey has them, in metres from the equator: float32 has steps of half a metre there.
constexpr Vec3 kFarAway{4.8e6 + 0.125, 512345.625, 321.0625};

TEST_F(PipelineOptions, FarFromTheOriginAnStlNeedsRecentring) {
  const TriangleSoup soup = moved(icosphere(2), kFarAway);
  CleanOptions options = with_method(Method::level_set);
  options.resolution = 32;
  expect_failure(run(soup, options, "none.stl"), {".ply", "--recentre"});
  EXPECT_FALSE(folder_.has("none.stl"));
  const RepairReport doubles = run(soup, options, "out.ply");
  expect_solid(doubles, signed_volume(icosphere(2)), 1, 0.01);
  EXPECT_EQ(doubles.recentred_by, Vec3{});
  options.recentre = true;
  const RepairReport recentred = run(soup, options, "out.stl");
  expect_solid(recentred, signed_volume(icosphere(2)), 1, 0.01);
  EXPECT_LE(norm(recentred.after.box.center() + recentred.recentred_by - kFarAway), recentred.options.cell);
}

// What was subtracted gives the input back, to the last bit.
TEST_F(PipelineOptions, RecentringIsExact) {
  CleanOptions options;
  options.recentre = true;
  for (const Vec3& at : {kFarAway, Vec3{-1e7, 3, 2e4}, Vec3{3, 2, 1}}) {
    SCOPED_TRACE(at.x);
    TriangleSoup soup = weld(moved(icosphere(2), at));
    // Near the origin the coordinates are what an STL holds: doubles there have more digits than the difference can keep.
    if (at.x == 3) soup = mapped(soup, [](const Vec3& p) { return Vec3{double(float(p.x)), double(float(p.y)), double(float(p.z))}; });
    const RepairReport report = run(soup, options, "out.ply");
    expect_solid(report, signed_volume(icosphere(2)), 1, 1e-6);
    const TriangleSoup out = folder_.read("out.ply");
    ASSERT_EQ(out.points.size(), soup.points.size());
    EXPECT_EQ(out.facets, soup.facets);
    for (std::size_t i = 0; i < out.points.size(); ++i) {
      EXPECT_EQ(out.points[i], soup.points[i] - report.recentred_by);
      EXPECT_EQ(out.points[i] + report.recentred_by, soup.points[i]);
    }
    const Vec3 c = report.after.box.center();
    const double reach = std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}) + 1;
    EXPECT_LE(std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)}), 0x1p-12 * reach + 1e-12);
  }
}

// --- what the report lists --------------------------------------------------------------------------

TEST_F(PipelineOptions, AThinFinIsListedAsLost) {
  const TriangleSoup block = box({1, 1, 1}, 8, 8, 8);
  // A fin of 0.3 x 0.2 on the top face, along its grid lines.
  TriangleSoup fin;
  fin.points = {{0.25, 0.5, 1}, {0.5, 0.5, 1}, {0.5, 0.5, 1.2}, {0.25, 0.5, 1.2}, {0.375, 0.5, 1}};
  fin.facets = {{0, 4, 3}, {4, 2, 3}, {4, 1, 2}};
  for (const Method method : {Method::automatic, Method::level_set}) {
    SCOPED_TRACE(name(method));
    const RepairReport report = run(merged(block, fin), quick(method));
    expect_solid(report, 1, 1, method == Method::automatic ? 1e-6 : 0.01);
    ASSERT_FALSE(report.losses.empty());
    const AllLosses lost = together(report.losses, "a sheet without thickness");
    EXPECT_NEAR(lost.distance, 0.2, 0.01);
    EXPECT_NEAR(lost.area, 0.05, 0.012) << "without what is near the block";
    EXPECT_NEAR(report.actions.area_lost, lost.area, 1e-12);
    EXPECT_FALSE(report.warnings.empty());
    EXPECT_EQ(with_fate(report, "lost").size(), 1u);
  }
}

TEST_F(PipelineOptions, AStrayFacetIsListedAsLost) {
  TriangleSoup stray;
  stray.points = {{4, 0, 0}, {4.1, 0, 0}, {4, 0.1, 0}};
  stray.facets = {{0, 1, 2}};
  const RepairReport report = run(merged(icosphere(2), stray));
  expect_solid(report, signed_volume(icosphere(2)), 1, 1e-6);
  EXPECT_EQ(report.method, "local");
  ASSERT_FALSE(report.losses.empty());
  const AllLosses all = together(report.losses, "a sheet without thickness");
  EXPECT_NEAR(all.area, 0.005, 1e-6);
  EXPECT_NEAR(all.distance, 3.1, 0.01);
  const std::vector<ComponentFate> lost = with_fate(report, "lost");
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_EQ(lost[0].facets, 1u);
  EXPECT_NEAR(lost[0].area, 0.005, 1e-9);
}

TEST_F(PipelineOptions, DetailsThinnerThanACellAreListedAsLost) {
  CleanOptions options = with_method(Method::level_set);
  options.cell = model_length(0.05);
  const TriangleSoup plate = moved(box({0.5, 0.5, 0.004}, 4, 4, 1), {2, 0, 0});
  const RepairReport report = run(merged(icosphere(3), plate), options);
  expect_solid(report, signed_volume(icosphere(3)), 1, 0.01);
  EXPECT_EQ(report.actions.components_lost, 1u);
  EXPECT_NEAR(report.actions.area_lost, area(plate), 0.05 * area(plate));
  ASSERT_FALSE(report.losses.empty());
  EXPECT_EQ(report.losses[0].reason, "thinner than a cell");
  ASSERT_EQ(with_fate(report, "lost").size(), 1u);
  EXPECT_EQ(with_fate(report, "lost")[0].reason, "thinner than a cell");
}

// The top of a block has an opening of 3/8 x 2/8.
TEST_F(PipelineOptions, HolesAreListedWithPlaceAndSize) {
  const TriangleSoup soup = without_facets_where(box({1, 1, 1}, 8, 8, 8), [](const Vec3& p) { return p.z == 1 && p.x > 0.25 && p.x < 0.625 && p.y > 0.5 && p.y < 0.75; });
  for (const Method method : {Method::automatic, Method::level_set}) {
    SCOPED_TRACE(name(method));
    const RepairReport report = run(soup, quick(method));
    expect_solid(report, 1, 1, 0.01);
    ASSERT_EQ(report.holes.size(), 1u);
    const Hole& hole = report.holes[0];
    EXPECT_EQ(hole.edges, 10u);
    EXPECT_NEAR(hole.perimeter, 1.25, 1e-12);
    EXPECT_NEAR(hole.area, 0.375 * 0.25, 1e-12);
    EXPECT_NEAR(norm(hole.position - Vec3{0.4375, 0.625, 1}), 0, 1e-12);
    EXPECT_TRUE(hole.filled);
  }
}

// --- names and colours ------------------------------------------------------------------------------

// A named, coloured block beside another; each has a hole.
TriangleSoup two_named_blocks() {
  const TriangleSoup block = without_facets(box({1, 1, 1}, 4, 4, 4), {9});
  TriangleSoup soup = merged(block, moved(block, {2, 0, 0}));
  const auto n = static_cast<std::uint32_t>(block.facets.size());
  soup.groups = {{"left", 0, n}, {"right", n, n}};
  soup.colors.assign(2 * n, color_of(248, 0, 0));
  std::fill(soup.colors.begin() + n, soup.colors.end(), color_of(0, 0, 248));
  return soup;
}

TEST_F(PipelineOptions, NamesAndColoursStayWithTheirFacets) {
  for (const Method method : {Method::automatic, Method::level_set})
    for (const std::string suffix : {".ply", ".stla", ".stl"}) {
      SCOPED_TRACE(std::string(name(method)) + " " + suffix);
      const RepairReport report = run(two_named_blocks(), quick(method), "out" + suffix);
      expect_solid(report, 2, 2);
      EXPECT_EQ(report.method, method == Method::automatic ? "local" : "levelset");
      ASSERT_EQ(report.groups.size(), 2u);
      const TriangleSoup out = folder_.read("out" + suffix);
      const auto is_left = [&](std::size_t f) { return out.corner(f, 0).x < 1.5; };
      if (suffix != ".stl") {
        ASSERT_EQ(out.groups.size(), 2u);
        EXPECT_EQ(out.groups[0].name, "left");
        EXPECT_EQ(out.groups[1].name, "right");
        for (std::size_t f = 0; f < out.facets.size(); ++f) ASSERT_EQ(is_left(f), f < out.groups[0].facet_count);
      }
      if (suffix == ".stla") continue;  // it holds no colours
      ASSERT_EQ(out.colors.size(), out.facets.size());
      std::size_t colored = 0;
      for (std::size_t f = 0; f < out.facets.size(); ++f) {
        if (out.colors[f] == kNoColor) continue;
        ++colored;
        for (const int i : {0, 2}) EXPECT_NEAR(channel(out.colors[f], i), (i == 0) == is_left(f) ? 248 : 0, 8);
      }
      EXPECT_GE(colored, out.facets.size() * 9 / 10);
    }
}

}  // namespace
}  // namespace burnish
