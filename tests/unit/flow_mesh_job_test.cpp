// From a triangle file to a volume mesh: sides, patches, numbers of cells, what is refused and what is written.
#include "burnish/pipeline/flow_mesh_job.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <set>
#include <string>

#include "burnish/io/foam_case.h"
#include "flow_mesh_cells.h"
#include "flow_mesh_patches.h"
#include "support/folder.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

constexpr double kRadius = 0.6;
constexpr double kCell = 0.1;

struct Fixture {
  Fixture() {
    ball = moved(scaled(icosphere(3), kRadius), {0.03, -0.01, 0.02});
    job.input = folder.write("ball.ply", ball);
    job.output = folder.path("case");
    job.cell = Length{kCell, LengthUnit::model};
  }
  Folder folder;
  TriangleSoup ball;
  FlowMeshJob job;
};

std::uint64_t cells_by_shape(const MeshQuality& q) {
  std::uint64_t sum = 0;
  for (const std::uint64_t n : q.cells_of_shape) sum += n;
  return sum;
}

TEST(FlowMeshJob, FillsABall) {
  Fixture f;
  const FlowMeshResult result = flow_mesh(f.job);
  ASSERT_FALSE(result.failure) << result.failure->what();
  EXPECT_TRUE(result.written && result.good && result.quality.ok);
  EXPECT_EQ(result.quality.regions, result.regions_wanted);
  EXPECT_DOUBLE_EQ(result.volume_wanted, signed_volume(f.ball));
  EXPECT_NEAR(result.quality.volume, result.volume_wanted, 0.02 * result.volume_wanted);
  EXPECT_EQ(cells_by_shape(result.quality), result.quality.cells);
  EXPECT_LE(result.surface_to_patches.max, 0.5 * kCell);
  EXPECT_LE(result.patches_to_surface.max, 0.5 * kCell);
  const FoamMesh read = read_foam_mesh(f.folder.path("case"));
  EXPECT_EQ(read.mesh.cells, result.quality.cells);
  EXPECT_EQ(read.mesh.faces(), result.quality.faces);
}

TEST(FlowMeshJob, OutsideIsTheDomainWithoutTheBall) {
  Fixture f;
  f.job.side = MeshSide::outside;
  f.job.output.clear();
  const FlowMeshResult result = flow_mesh(f.job);
  ASSERT_FALSE(result.failure) << result.failure->what();
  EXPECT_FALSE(result.written);
  // One longest side around, rounded outwards.
  const double side = 3 * result.solid.box.longest_side();
  for (int a = 0; a < 3; ++a) {
    EXPECT_GE(result.box.extent()[a], side - 1e-9);
    EXPECT_LE(result.box.extent()[a], side + 2 * 16 * kCell);
  }
  const Vec3 e = result.box.extent();
  EXPECT_NEAR(result.volume_wanted, e.x * e.y * e.z - signed_volume(f.ball), 1e-9);
  EXPECT_NEAR(result.quality.volume, result.volume_wanted, 0.002 * result.volume_wanted);
  ASSERT_EQ(result.patches.size(), 7u);
  double area = 0;
  for (std::size_t p = 1; p < 7; ++p) area += result.patches[p].area;
  EXPECT_NEAR(area, 2 * (e.x * e.y + e.y * e.z + e.z * e.x), 1e-9 * area);
}

TEST(FlowMeshJob, ADomainThatCutsTheModelIsRefused) {
  Fixture f;
  f.job.side = MeshSide::outside;
  f.job.domain.box = Box3{{-1, -1, -1}, {0.5, 1, 1}};
  EXPECT_THROW(flow_mesh(f.job), Error);
  f.job.domain.box.reset();
  f.job.domain.margin = Length{0.5 * kCell, LengthUnit::model};
  EXPECT_THROW(flow_mesh(f.job), Error);
}

TEST(FlowMeshJob, CavitiesAreRegionsOfTheOutside) {
  Fixture f;
  f.job.input = f.folder.write("hollow.ply", merged(scaled(icosphere(3), 1.2), flipped(scaled(icosphere(3), 0.6))));
  f.job.output.clear();
  const FlowMeshResult inside = flow_mesh(f.job);
  EXPECT_EQ(inside.solid.cavities, 1u);
  EXPECT_EQ(inside.regions_wanted, 1u);
  EXPECT_EQ(inside.quality.regions, 1u);
  f.job.side = MeshSide::outside;
  const FlowMeshResult outside = flow_mesh(f.job);
  EXPECT_EQ(outside.regions_wanted, 2u);
  EXPECT_EQ(outside.quality.regions, 2u);
}

TEST(FlowMeshJob, WhatHasNoVolumeIsAFailure) {
  Fixture f;
  f.job.input = f.folder.write("facet.ply", TriangleSoup{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {}});
  const FlowMeshResult result = flow_mesh(f.job);
  ASSERT_TRUE(result.failure);
  EXPECT_EQ(result.failure->code(), ErrorCode::guarantee_unmet);
  EXPECT_FALSE(result.written || result.meshed);
  EXPECT_FALSE(f.folder.has("case"));
}

TEST(FlowMeshJob, ReplacesNothingUnasked) {
  Fixture f;
  ASSERT_TRUE(flow_mesh(f.job).written);
  const std::string faces = f.folder.bytes("case/constant/polyMesh/faces");
  f.job.cell = Length{2 * kCell, LengthUnit::model};
  EXPECT_THROW(flow_mesh(f.job), Error);
  EXPECT_EQ(f.folder.bytes("case/constant/polyMesh/faces"), faces);
  f.job.write.overwrite = true;
  ASSERT_TRUE(flow_mesh(f.job).written);
  EXPECT_NE(f.folder.bytes("case/constant/polyMesh/faces"), faces);
}

TEST(FlowMeshJob, ScalesWhatIsWritten) {
  Fixture f;
  ASSERT_TRUE(flow_mesh(f.job).written);
  const FoamMesh whole = read_foam_mesh(f.folder.path("case"));
  f.job.output = f.folder.path("small");
  f.job.scale = 0.001;
  const FlowMeshResult result = flow_mesh(f.job);
  EXPECT_DOUBLE_EQ(result.cell, kCell);
  const FoamMesh small = read_foam_mesh(f.folder.path("small"));
  ASSERT_EQ(small.mesh.points.size(), whole.mesh.points.size());
  for (std::size_t p = 0; p < small.mesh.points.size(); ++p) EXPECT_EQ(small.mesh.points[p], whole.mesh.points[p] * 0.001);
}

// Told in the model's units, whatever the scale.
TEST(FlowMeshJob, JudgesWhatIsWritten) {
  Fixture f;
  f.job.output.clear();
  const FlowMeshResult one = flow_mesh(f.job);
  f.job.scale = 1000;
  const FlowMeshResult large = flow_mesh(f.job);
  EXPECT_TRUE(large.good);
  EXPECT_NEAR(large.quality.volume, one.quality.volume, 1e-12 * one.quality.volume);
  for (const MeshCheck& c : one.quality.checks) {
    const MeshCheck& same = large.quality.check(c.name);
    EXPECT_EQ(same.failing, c.failing) << c.name;
    EXPECT_NEAR(same.worst, c.worst, 1e-6 * std::abs(c.worst) + 1e-12) << c.name;
  }
  // Volumes that no double holds: a mesh that would be read back as flat.
  f.job.scale = 1e-110;
  f.job.output = f.folder.path("case");
  const FlowMeshResult none = flow_mesh(f.job);
  ASSERT_TRUE(none.failure);
  EXPECT_EQ(none.failure->code(), ErrorCode::guarantee_unmet);
  EXPECT_FALSE(none.written || f.folder.has("case"));
}

// Tells which stages began, and does something at the beginning of one.
class AtStage : public Progress {
 public:
  explicit AtStage(std::string stage = {}, std::function<void()> act = {}) : stage_(std::move(stage)), act_(std::move(act)) {}
  void begin_stage(std::string_view name) override {
    stages.insert(std::string(name));
    if (name == stage_) act_();
  }
  std::set<std::string> stages;

 private:
  std::string stage_;
  std::function<void()> act_;
};

TEST(FlowMeshJob, WhatCannotBeWrittenIsKnownBeforeTheWork) {
  namespace fs = std::filesystem;
  Fixture f;
  std::ofstream(f.folder.path("file")) << "mine";
  fs::create_directories(f.folder.path("old/constant/polyMesh"));
  std::ofstream(f.folder.path("old/constant/polyMesh/cellZones")) << "of a mesh";
  fs::create_directories(f.folder.path("odd"));
  std::ofstream(f.folder.path("odd/system")) << "no folder";
  for (const char* output : {"file/case", "missing/mesh.vtu", "old", "odd"}) {
    f.job.output = f.folder.path(output);
    AtStage progress;
    try {
      flow_mesh(f.job, progress);
      ADD_FAILURE() << output;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::unwritable_output) << e.what();
    }
    EXPECT_FALSE(progress.stages.contains("meshing")) << output;
  }
  EXPECT_FALSE(f.folder.has("missing"));
}

TEST(FlowMeshJob, AMeshThatCannotBeWrittenIsToldAllTheSame) {
  Fixture f;
  AtStage progress("writing", [&] { std::ofstream(f.folder.path("case")) << "somebody was faster"; });
  const FlowMeshResult result = flow_mesh(f.job, progress);
  ASSERT_TRUE(result.failure);
  EXPECT_EQ(result.failure->code(), ErrorCode::unwritable_output);
  EXPECT_TRUE(result.meshed && result.good && !result.written);
  EXPECT_GT(result.quality.cells, 0u);
}

// Whatever the reason is.
TEST(FlowMeshJob, AMeshThatNoFormatTakesIsToldAllTheSame) {
  Fixture f;
  f.job.write.msh_version = 40;
  f.job.output = f.folder.path("mesh.msh");
  const FlowMeshResult result = flow_mesh(f.job);
  ASSERT_TRUE(result.failure);
  EXPECT_EQ(result.failure->code(), ErrorCode::usage);
  EXPECT_TRUE(result.meshed && result.good && !result.written);
  EXPECT_GT(result.quality.cells, 0u);
  EXPECT_FALSE(f.folder.has("mesh.msh"));
}

bool warns_of(const FlowMeshResult& result, const std::string& part) {
  return std::any_of(result.warnings.begin(), result.warnings.end(), [&](const std::string& w) { return w.find(part) != w.npos; });
}

// More than fits after a mesh that did: that one is the result.
TEST(FlowMeshJob, ANumberOfCellsThatDoesNotFitLeavesTheMeshBefore) {
  Fixture f;
  f.job.cell.reset();
  f.job.cells = 100'000;
  f.job.options.memory_bytes = 110'000'000;
  const FlowMeshResult result = flow_mesh(f.job);
  ASSERT_FALSE(result.failure) << result.failure->what();
  ASSERT_EQ(result.trials.size(), 1u);
  EXPECT_TRUE(result.written && result.good);
  EXPECT_EQ(result.cell, result.trials[0].cell);
  EXPECT_EQ(result.quality.cells, result.trials[0].cells);
  EXPECT_TRUE(warns_of(result, "memory"));
}

// Layers are judged by the cells of the result: those of the first mesh, which were too small for them, do not matter.
TEST(FlowMeshJob, LayersHaveToFitTheLastOfTheTrials) {
  Fixture f;
  f.job.output.clear();
  f.job.side = MeshSide::outside;
  f.job.cell.reset();
  f.job.cells = 5'000;
  f.job.layers = {3, Length{0.0604, LengthUnit::model}, 1.2};
  const FlowMeshResult result = flow_mesh(f.job);
  const double thickness = 0.0604 * (1 + 1.2 + 1.44);
  ASSERT_GT(result.trials.size(), 1u);
  EXPECT_GT(thickness, kThickestLayers * result.trials.front().cell);
  EXPECT_LT(thickness, kThickestLayers * result.cell);
  ASSERT_FALSE(result.failure) << result.failure->what();
  EXPECT_NEAR(result.layers.thickness, thickness, 1e-12);
  EXPECT_EQ(warns_of(result, "of the wall's area"), result.layers.covered < 0.5);
}

TEST(FlowMeshJob, LayersThatHaveNoRoomInANumberOfCells) {
  Fixture f;
  f.job.output.clear();
  f.job.cell.reset();
  f.job.cells = 5'000;
  f.job.layers = {2, Length{0.3, LengthUnit::model}, 1};
  const FlowMeshResult thick = flow_mesh(f.job);
  ASSERT_TRUE(thick.failure);
  EXPECT_EQ(thick.failure->code(), ErrorCode::usage);
  EXPECT_NE(thick.failure->hint().find("--cells"), std::string::npos) << thick.failure->hint();
  EXPECT_FALSE(thick.trials.empty());
  f.job.layers.first = Length{1e-4, LengthUnit::model};
  EXPECT_TRUE(warns_of(flow_mesh(f.job), "badly shaped"));
}

TEST(FlowMeshJob, LayersThatAreNearlyNowhereAreWarnedOf) {
  Fixture f;
  f.job.output.clear();
  f.job.layers.count = 3;
  const FlowMeshResult smooth = flow_mesh(f.job);
  EXPECT_GT(smooth.layers.covered, 0.5);
  EXPECT_FALSE(warns_of(smooth, "of the wall's area"));
  f.job.side = MeshSide::outside;
  f.job.input = f.folder.write("cube.ply", cube());
  const FlowMeshResult sharp = flow_mesh(f.job);
  EXPECT_EQ(warns_of(sharp, "of the wall's area"), sharp.layers.covered < 0.5) << sharp.layers.covered;
}

// The first, small mesh would have cells that have no room between model and domain.
TEST(FlowMeshJob, ANumberOfCellsInANarrowDomain) {
  Fixture f;
  f.job.output.clear();
  f.job.side = MeshSide::outside;
  f.job.domain.margin = Length{0.14, LengthUnit::model};
  f.job.cell.reset();
  f.job.cells = 5000;
  const FlowMeshResult few = flow_mesh(f.job);
  ASSERT_TRUE(few.meshed);
  EXPECT_NEAR(few.cell, 0.035, 1e-6);
  EXPECT_EQ(few.trials.size(), 1u);
  EXPECT_TRUE(std::any_of(few.warnings.begin(), few.warnings.end(), [](const std::string& w) { return w.find("have no room") != w.npos; }));
  f.job.cells = few.quality.cells * 2;
  const FlowMeshResult more = flow_mesh(f.job);
  EXPECT_NEAR(static_cast<double>(more.quality.cells) / static_cast<double>(*f.job.cells), 1, 0.15);
}

TEST(FlowMeshJob, SizesAreThoseOfTheFinestCells) {
  Fixture f;
  f.job.output.clear();
  f.job.refinements = {{{{0.5, -0.1, -0.1}, {0.7, 0.1, 0.1}}, Length{0.25 * kCell, LengthUnit::model}}};
  const FlowMeshResult result = flow_mesh(f.job);
  EXPECT_DOUBLE_EQ(result.cell, kCell);
  EXPECT_NEAR(result.finest_cell, 0.25 * kCell, 1e-12);
  std::uint64_t sum = 0;
  for (const std::uint64_t n : result.cells_of_level) sum += n;
  EXPECT_EQ(sum, result.quality.cells);
}

// A level set is only as fine as the mesh asks for.
TEST(FlowMeshJob, TheLevelSetFollowsTheCell) {
  Fixture f;
  f.job.options.method = Method::level_set;
  f.job.output.clear();
  EXPECT_NEAR(flow_mesh(f.job).solid.cell, 0.5 * kCell, 1e-12);
  f.job.options.cell = Length{0.8 * kCell, LengthUnit::model};
  EXPECT_NEAR(flow_mesh(f.job).solid.cell, 0.8 * kCell, 1e-12);
}

TEST(FlowMeshPatches, AreTheGroups) {
  TriangleSoup soup = cube();
  ASSERT_EQ(soup.facets.size(), 12u);
  soup.groups = {{"in let", 0, 4}, {"xMin", 4, 2}, {"in;let", 6, 4}, {"", 10, 2}};
  const SurfacePatches patches = surface_patches(soup, false, MeshSide::outside);
  EXPECT_EQ(patches.names, (std::vector<std::string>{"in_let", "xMin_2", "in_let_2", "surface"}));
  EXPECT_EQ(patches.groups, (std::vector<std::string>{"in let", "xMin", "in;let", ""}));
  EXPECT_EQ(patches.of_facet, (std::vector<std::uint32_t>{0, 0, 0, 0, 1, 1, 2, 2, 2, 2, 3, 3}));
  // Inside there are no sides of a domain to be taken for.
  EXPECT_EQ(surface_patches(soup, false, MeshSide::inside).names, (std::vector<std::string>{"in_let", "xMin", "in_let_2", "surface"}));
  const SurfacePatches one = surface_patches(soup, true, MeshSide::inside);
  EXPECT_EQ(one.names, std::vector<std::string>{"surface"});
  EXPECT_TRUE(one.of_facet.empty());
}

TEST(FlowMeshPatches, TypesAreForPatchesThatExist) {
  std::vector<MeshPatch> patches{{"a", "wall"}, {"b", "wall"}};
  set_patch_types({{"b", "patch"}}, patches);
  EXPECT_EQ(patches[0].type, "wall");
  EXPECT_EQ(patches[1].type, "patch");
  EXPECT_THROW(set_patch_types({{"c", "patch"}}, patches), Error);
}

TEST(FlowMeshPatches, AreOfOneTypeEach) {
  require_one_type_each({{"a", "wall"}, {"b", "patch"}, {"a", "wall"}});
  try {
    require_one_type_each({{"inlet", "patch"}, {"b", "patch"}, {"inlet", "symmetry"}});
    ADD_FAILURE() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::usage);
    const std::string what = e.what();
    for (const char* word : {"inlet", "patch", "symmetry"}) EXPECT_NE(what.find(word), what.npos) << what;
  }
}

// A mesh whose number of cells goes as a A / h^2 + b / h^3.
TEST(FlowMeshCells, AreMetInThreeTrials) {
  for (const double a : {4.0, 15.0, 60.0})
    for (const double b : {0.0, 0.05, 0.5})
      for (const std::uint64_t wanted : {2'000u, 50'000u, 1'000'000u, 20'000'000u}) {
        CellChooser chooser(wanted, 1.0);
        while (const auto h = chooser.next()) chooser.learn(*h, static_cast<std::uint64_t>(a / (*h * *h) + b / (*h * *h * *h)));
        EXPECT_LE(chooser.trials().size(), 3u);
        EXPECT_NEAR(static_cast<double>(chooser.trials().back().cells) / static_cast<double>(wanted), 1, 0.15) << "a = " << a << ", b = " << b << ", wanted " << wanted;
        // The first one is the small one, unless cells are many for the surface.
        if (wanted >= 1'000'000u && b == 0) {
          EXPECT_LE(chooser.trials().front().cells, wanted);
        }
      }
}

}  // namespace
}  // namespace burnish
