// Smoothing within the pipeline: which gear it runs in, regions at level set nodes, sweeps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "burnish/pipeline/sweep.h"
#include "burnish/surface/compare.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/weld.h"
#include "support/damage.h"
#include "support/noise.h"
#include "support/options_fixture.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

class Smoothing : public PipelineOptions {
 protected:
  std::string write_text(const std::string& name, const std::string& text) {
    std::ofstream(folder_.path(name)) << text;
    return folder_.path(name);
  }
};

CleanOptions automatic() {
  CleanOptions options;
  options.smooth_auto = true;
  return options;
}

CleanOptions in_mode(SmoothMode mode, double length, int resolution) {
  CleanOptions options;
  options.mode = mode;
  options.smooth = model_length(length);
  options.resolution = resolution;
  return options;
}

// Of the points farther than `least` from the centre.
double rms_to_unit_sphere(const TriangleSoup& soup, double least = 0) {
  double sum = 0, count = 0;
  for (const Vec3& p : soup.points)
    if (norm(p) > least) sum += (norm(p) - 1) * (norm(p) - 1), ++count;
  return std::sqrt(sum / count);
}

using Points = std::set<std::tuple<double, double, double>>;

Points points_where(const TriangleSoup& soup, const std::function<bool(const Vec3&)>& keep) {
  Points points;
  for (const Vec3& p : soup.points)
    if (keep(p)) points.emplace(p.x, p.y, p.z);
  return points;
}

double share_in(const Points& points, const Points& others) {
  return static_cast<double>(std::count_if(points.begin(), points.end(), [&](const auto& p) { return others.contains(p); })) / static_cast<double>(points.size());
}

// --- gears ------------------------------------------------------------------------------------------

// Walls inside a sphere, three facets at an edge, are more than the local gear takes; the level set is built of the denoised facets.
TEST_F(Smoothing, DenoisesInFrontOfTheLevelSetWhatLocalRepairRefuses) {
  const TriangleSoup clean = icosphere(4), noisy = with_noise(clean, 0.2, 1);
  TriangleSoup walls = noisy;
  Random random(5);
  walls.points.push_back({0, 0, 0});
  const auto middle = static_cast<std::uint32_t>(walls.points.size() - 1);
  for (int i = 0; i < 40; ++i) {
    const Facet& f = noisy.facets[random.below(noisy.facets.size())];
    walls.facets.push_back({f[0], f[1], middle});
  }
  const RepairReport report = run(walls, automatic());
  expect_solid(report, signed_volume(noisy), 1, 0.01);
  EXPECT_EQ(report.method, "levelset");
  EXPECT_FALSE(report.method_reason.empty());
  EXPECT_EQ(report.smoothing.mode, SmoothMode::feature);
  EXPECT_NEAR(report.smoothing.noise.sigma, 0.2 * mean_edge_length(noisy), 0.15 * 0.2 * mean_edge_length(noisy));
  EXPECT_GT(report.smoothing.rms_moved, 0.5 * report.smoothing.noise.sigma);
  EXPECT_EQ(report.smoothing.steps, 0);
  // Narrow wedges between walls may become hollow, farther inside.
  const double before = rms_to_unit_sphere(noisy), after = rms_to_unit_sphere(folder_.read("out.stl"), 0.9);
  RecordProperty("rms", std::to_string(before) + " -> " + std::to_string(after) + ", because " + report.method_reason);
  EXPECT_LT(after, 0.5 * before);
}

// Facets that share no point, and miss each other by a tenth of the noise, get neighbours by tolerance first.
TEST_F(Smoothing, ASoupOfSingleFacetsIsJoinedAndThenDenoised) {
  const TriangleSoup noisy = with_noise(icosphere(4), 0.2, 7), soup = unwelded_and_jittered(noisy, 0.02, 7);
  const RepairReport report = run(soup, automatic());
  expect_solid(report, signed_volume(noisy), 1, 0.002);
  EXPECT_GT(report.actions.points_welded_within_tolerance, noisy.points.size());
  EXPECT_EQ(report.smoothing.mode, SmoothMode::feature);
  EXPECT_NEAR(report.smoothing.noise.sigma, 0.2 * mean_edge_length(noisy), 0.15 * 0.2 * mean_edge_length(noisy));
  const double before = rms_to_unit_sphere(noisy), after = rms_to_unit_sphere(folder_.read("out.stl"));
  RecordProperty("rms", std::to_string(before) + " -> " + std::to_string(after));
  EXPECT_LT(after, 0.5 * before);
}

// Bounds hold wherever the facets are denoised.
TEST_F(Smoothing, DeviationsBoundDenoisedFacetsInBothGears) {
  const TriangleSoup noisy = with_noise(icosphere(4), 0.3, 2);
  const double free = run(noisy, automatic()).smoothing.max_moved;
  for (const Method method : {Method::automatic, Method::level_set}) {
    SCOPED_TRACE(name(method));
    CleanOptions options = automatic();
    options.method = method;
    options.mode = SmoothMode::feature;
    options.deviation = model_length(0.3 * free);
    const RepairReport report = run(noisy, options);
    ASSERT_FALSE(report.failure) << report.failure->what();
    EXPECT_EQ(report.method, method == Method::automatic ? "local" : "levelset");
    EXPECT_LE(report.smoothing.max_moved, 0.3 * free * (1 + 1e-9));
    EXPECT_GT(report.smoothing.max_moved, 0.29 * free);
    EXPECT_GT(report.smoothing.deviation, 0);
    EXPECT_LE(report.smoothing.deviation, 0.3 * free + std::max(report.options.cell, 1e-6));
  }
}

TEST_F(Smoothing, OpenSheetsAreDenoisedAndStayOpen) {
  const TriangleSoup flat = height_field(40, [](int, int) { return 0.0; }), noisy = with_noise(flat, 0.2, 3);
  CleanOptions options = automatic();
  options.keep_openings = true;
  const RepairReport report = run(noisy, options, "out.ply");
  expect_sheet(report, 1);
  EXPECT_EQ(report.method, "local") << report.method_reason;
  EXPECT_EQ(report.smoothing.mode, SmoothMode::feature);
  const TriangleSoup out = folder_.read("out.ply");
  ASSERT_EQ(out.points.size(), noisy.points.size());
  double before = 0, after = 0;
  for (const Vec3& p : weld(noisy).points) before += p.z * p.z;
  for (const Vec3& p : out.points) after += p.z * p.z;
  EXPECT_LT(after, 0.1 * before);
  // The rim moves along normals, which noise has tilted.
  const double within = 0.1 * mean_edge_length(flat);
  for (const double end : {bounding_box(out).upper.x, bounding_box(out).upper.y, 1 - bounding_box(out).lower.x, 1 - bounding_box(out).lower.y}) EXPECT_NEAR(end, 1, within);
}

// --- regions ----------------------------------------------------------------------------------------

// Below the border nothing of the level set changes; well above it, the noise goes as without a region.
TEST_F(Smoothing, LevelSetsOutsideTheRegionKeepTheirBits) {
  const TriangleSoup noisy = with_noise(icosphere(4), 0.3, 4);
  const std::string region = write_text("half.txt", "box -2 -2 0 2 2 2\n");
  CleanOptions rough;
  rough.resolution = 48;
  rough.surface = Extractor::tetrahedra;
  ASSERT_TRUE(run(noisy, rough, "rough.ply").verified);
  const TriangleSoup unsmoothed = folder_.read("rough.ply");
  for (const SmoothMode mode : {SmoothMode::volume, SmoothMode::mcf, SmoothMode::filtered}) {
    SCOPED_TRACE(name(mode));
    CleanOptions options = in_mode(mode, 0.5, 48);
    options.surface = Extractor::tetrahedra;
    ASSERT_TRUE(run(noisy, options, "whole.ply").verified);
    options.region = region;
    const RepairReport report = run(noisy, options, "half.ply");
    ASSERT_FALSE(report.failure) << report.failure->what();
    const double cell = report.options.cell;
    const TriangleSoup half = folder_.read("half.ply"), whole = folder_.read("whole.ply");
    const auto below = [&](const Vec3& p) { return p.z < -6 * cell; };
    // Whether a thin facet is improved depends on its neighbours, and through them on what is farther away.
    EXPECT_GT(share_in(points_where(half, below), points_where(unsmoothed, below)), 0.995);
    EXPECT_LT(share_in(points_where(whole, below), points_where(unsmoothed, below)), 0.01);
    const auto rms_above = [](const TriangleSoup& soup) {
      double sum = 0, count = 0;
      for (const Vec3& p : soup.points)
        if (p.z > 0.5) sum += (norm(p) - 1) * (norm(p) - 1), ++count;
      return std::sqrt(sum / count);
    };
    EXPECT_LT(rms_above(half), 0.5 * rms_above(unsmoothed));
  }
}

// A region is where the user sees the model, wherever it is moved to.
TEST_F(Smoothing, RegionsMoveWithARecentredModel) {
  const Vec3 at{4096, -1024, 512};
  const TriangleSoup noisy = with_noise(icosphere(4), 0.3, 4);
  CleanOptions options = automatic();
  options.region = write_text("here.txt", "box -2 -2 0 2 2 2\n");
  const RepairReport here = run(noisy, options, "here.ply");
  options.region = write_text("far.txt", "box 4094 -1026 512 4098 -1022 514\n");
  options.recentre = true;
  const TriangleSoup far = weld(moved(noisy, at));
  const RepairReport report = run(far, options, "far.ply");
  ASSERT_FALSE(report.failure || here.failure);
  const TriangleSoup out = folder_.read("far.ply");
  ASSERT_EQ(out.points.size(), far.points.size());
  for (std::size_t p = 0; p < out.points.size(); ++p)
    if (far.points[p].z < at.z) {
      ASSERT_EQ(out.points[p] + report.recentred_by, far.points[p]);
    }
  EXPECT_NEAR(report.smoothing.rms_moved / here.smoothing.rms_moved, 1, 1e-6);
  EXPECT_GT(report.smoothing.rms_moved, 0);
}

// --- sweeps -----------------------------------------------------------------------------------------

// How often each stage began.
class StageCount : public Progress {
 public:
  void begin_stage(std::string_view name) override { ++count[std::string(name)]; }
  std::map<std::string, int> count;
};

TEST_F(Smoothing, ASweepPreparesOnceAndEqualsSingleRuns) {
  const TriangleSoup noisy = without_random_facets(with_noise(icosphere(4), 0.2, 6), 0.01, 1);
  const double lengths[] = {0.4, 0.15, 0.8};
  for (const SmoothMode mode : {SmoothMode::volume, SmoothMode::mcf, SmoothMode::filtered, SmoothMode::feature}) {
    SCOPED_TRACE(name(mode));
    CleanOptions options = in_mode(mode, 0.15, 28);
    if (mode == SmoothMode::feature) options.resolution.reset();
    // Delaunay's points are zeros to 1e-5 cells, and rounding decides which.
    if (mode != SmoothMode::feature) options.surface = Extractor::tetrahedra;
    CleanJob job;
    job.input = folder_.write("in.ply", noisy);
    job.options = options;
    job.overwrite = true;
    std::vector<SweepStep> steps;
    for (const double length : lengths) steps.push_back({model_length(length), folder_.path("sweep" + std::to_string(steps.size()) + ".ply")});
    StageCount stages;
    const std::vector<RepairReport> reports = sweep(job, steps, stages);
    ASSERT_EQ(reports.size(), 3u);
    for (const char* stage : {"reading", "inspecting", "preparing"}) EXPECT_EQ(stages.count[stage], 1) << stage;
    EXPECT_EQ(stages.count["writing"], 3);
    for (std::size_t i = 0; i < 3; ++i) {
      SCOPED_TRACE(lengths[i]);
      ASSERT_FALSE(reports[i].failure) << reports[i].failure->what();
      options.smooth = model_length(lengths[i]);
      const RepairReport single = run(noisy, options, "single.ply");
      const TriangleSoup one = folder_.read("single.ply"), swept = folder_.read("sweep" + std::to_string(i) + ".ply");
      // A longer length's room moves the lattice's origin by whole cells, and with it the rounding.
      if (mode == SmoothMode::feature) {
        EXPECT_TRUE(folder_.bytes("single.ply") == folder_.bytes("sweep" + std::to_string(i) + ".ply"));
      }
      ASSERT_EQ(one.facets.size(), swept.facets.size());
      EXPECT_LT(one_sided_distance(one, TriangleIndex(swept)).max, 1e-12);
      EXPECT_LT(one_sided_distance(swept, TriangleIndex(one)).max, 1e-12);
      EXPECT_EQ(reports[i].output, steps[i].output);
      EXPECT_EQ(reports[i].method, single.method);
      EXPECT_EQ(reports[i].smoothing.length, lengths[i]);
      EXPECT_NEAR(reports[i].smoothing.rms_moved / single.smoothing.rms_moved, 1, 1e-9);
      EXPECT_EQ(reports[i].options.cell, single.options.cell);
      EXPECT_NEAR(reports[i].after.volume / single.after.volume, 1, 1e-12);
      EXPECT_EQ(reports[i].warnings, single.warnings);
    }
  }
}

// Without a cell, all take the one that suits the shortest length.
TEST_F(Smoothing, ASweepHasOneCell) {
  CleanJob job;
  job.input = folder_.write("in.ply", mapped(icosphere(4), [](const Vec3& p) { return Vec3{p.x, 0.15 * p.y, 0.15 * p.z}; }));
  job.options.mode = SmoothMode::volume;
  job.overwrite = true;
  const std::vector<SweepStep> steps{{model_length(0.2), folder_.path("a.ply")}, {model_length(0.15), folder_.path("b.ply")}};
  const std::vector<RepairReport> reports = sweep(job, steps);
  ASSERT_EQ(reports.size(), 2u);
  const double cell = 0.15 / 12;  // [T-CELL-1]
  for (const RepairReport& report : reports) {
    EXPECT_TRUE(report.verified);
    EXPECT_TRUE(report.options.cell_was_chosen);
    EXPECT_NEAR(report.options.cell / cell, 1, 1e-12);
  }
}

// Each length that fails has a report of its own; the others are written.
TEST_F(Smoothing, WhatIsSmoothedAwayDoesNotEndASweep) {
  CleanJob job;
  job.input = folder_.write("in.ply", icosphere(3));
  job.options = in_mode(SmoothMode::mcf, 1, 24);
  job.overwrite = true;
  const std::vector<SweepStep> steps{{model_length(0.4), folder_.path("kept.ply")}, {model_length(3.5), folder_.path("gone.ply")}};
  const std::vector<RepairReport> reports = sweep(job, steps);
  ASSERT_EQ(reports.size(), 2u);
  EXPECT_TRUE(reports[0].verified && reports[0].written);
  EXPECT_TRUE(folder_.has("kept.ply"));
  ASSERT_TRUE(reports[1].failure);
  EXPECT_NE(reports[1].failure->hint().find("--smooth"), std::string::npos);
  EXPECT_FALSE(folder_.has("gone.ply"));
  EXPECT_EQ(folder_.file_count(), 2) << "temporaries are left";
}

}  // namespace
}  // namespace burnish
