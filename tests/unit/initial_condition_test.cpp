// From a triangle file to a field in a case: volumes, files, and what is refused.
#include "burnish/pipeline/initial_condition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <nlohmann/json.hpp>

#include "burnish/io/foam_case.h"
#include "support/foam_files.h"
#include "support/folder.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

constexpr std::uint32_t kCells = 16;

// A case with a mesh of the cube [-1, 1]^3, and a ball of radius 0.6 at (0.03, -0.01, 0.02).
struct Fixture {
  explicit Fixture(const FoamFormat& format = {}) {
    PolyMeshWriter(folder.path("case/constant/polyMesh"), format).write(hexahedra(kCells, kCells, kCells, {{-1, -1, -1}, {1, 1, 1}}));
    ball = moved(scaled(icosphere(4), 0.6), {0.03, -0.01, 0.02});
    job.case_folder = folder.path("case");
    job.input = folder.write("ball.ply", ball);
  }
  void store(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories(std::filesystem::path(folder.path(name)).parent_path());
    std::ofstream(folder.path(name), std::ios::binary) << text;
  }
  // Values of a field that stands in text.
  std::vector<double> values(const std::string& name) const {
    const std::string text = folder.bytes(name);
    std::vector<double> read;
    const char* at = text.data() + text.find('(', text.find("internalField")) + 1;
    for (char* end = nullptr;; at = end) {
      const double v = std::strtod(at, &end);
      if (end == at) return read;
      read.push_back(v);
    }
  }
  Folder folder;
  TriangleSoup ball;
  InitialConditionJob job;
};

const char* const kField = R"(FoamFile { version 2.0; format ascii; class volScalarField; object alpha.water; }
dimensions [0 0 0 0 0 0 0];
internalField   uniform 0;
boundaryField { walls { type zeroGradient; /* kept */ } ends { type inletOutlet; inletValue uniform 0; value uniform 0; } }
)";

TEST(InitialCondition, HoldsTheVolumeOfTheTriangles) {
  Fixture f;
  const InitialConditionResult result = initial_condition(f.job);
  ASSERT_FALSE(result.failure);
  const double volume = signed_volume(f.ball);
  EXPECT_NEAR(result.solid.volume, volume, 1e-14);
  EXPECT_NEAR(result.alpha.volume, volume, 1e-13);
  ASSERT_TRUE(result.alpha.difference);
  EXPECT_EQ(result.alpha.clamped, 0u);
  EXPECT_EQ(result.mesh.cells, kCells * kCells * kCells);
  EXPECT_NEAR(result.mesh.volume, 8, 1e-12);
  const std::vector<double> alpha = f.values("case/0/alpha.water");
  ASSERT_EQ(alpha.size(), result.mesh.cells);
  double sum = 0;
  std::size_t mixed = 0;
  for (const double a : alpha) {
    EXPECT_TRUE(a >= 0 && a <= 1);
    sum += a / 512;
    mixed += a > 0 && a < 1;
  }
  EXPECT_NEAR(sum, volume, 1e-13);
  EXPECT_LE(mixed, result.alpha.mixed);
  EXPECT_TRUE(result.fields[0].from.empty());
  EXPECT_EQ(read_foam_field(f.folder.path("case/0/alpha.water")).patches, (std::vector<std::string>{"walls", "ends"}));
}

TEST(InitialCondition, IsTheSameInABinaryMesh) {
  Fixture text, binary(FoamFormat{.binary = true});
  const InitialConditionResult a = initial_condition(text.job), b = initial_condition(binary.job);
  EXPECT_EQ(a.alpha.volume, b.alpha.volume);
  const FoamField field = read_foam_field(binary.folder.path("case/0/alpha.water"));
  EXPECT_TRUE(field.format.binary);
  EXPECT_GT(binary.folder.bytes("case/0/alpha.water").size(), 8 * a.mesh.cells);
}

TEST(InitialCondition, KeepsConditionsAndReplacesNothingUnasked) {
  Fixture f;
  f.store("case/0/alpha.water", kField);
  EXPECT_THROW(initial_condition(f.job), Error);
  EXPECT_EQ(f.folder.bytes("case/0/alpha.water"), kField);
  f.job.dry_run = true;
  EXPECT_FALSE(initial_condition(f.job).fields[0].written);
  EXPECT_EQ(f.folder.bytes("case/0/alpha.water"), kField);
  f.job.dry_run = false;
  f.job.overwrite = true;
  f.job.patch_values = {{"ends", 1}};
  const InitialConditionResult result = initial_condition(f.job);
  EXPECT_EQ(result.fields[0].from, f.folder.path("case/0/alpha.water"));
  const std::string bytes = f.folder.bytes("case/0/alpha.water");
  EXPECT_NE(bytes.find("walls { type zeroGradient; /* kept */ } ends { type inletOutlet; inletValue uniform 1; value uniform 1; } }"), bytes.npos);
  EXPECT_EQ(f.values("case/0/alpha.water").size(), result.mesh.cells);
  f.job.patch_values = {{"wall", 1}};
  EXPECT_THROW(initial_condition(f.job), Error);
  EXPECT_EQ(f.folder.bytes("case/0/alpha.water"), bytes);
}

TEST(InitialCondition, TakesConditionsOfTheOriginal) {
  Fixture f;
  f.store("case/0.orig/alpha.water", kField);
  EXPECT_EQ(initial_condition(f.job).fields[0].from, f.folder.path("case/0.orig/alpha.water"));
  f.store("case/0/alpha.air.orig", kField);
  f.job.field = "alpha.air";
  EXPECT_EQ(initial_condition(f.job).fields[0].from, f.folder.path("case/0/alpha.air.orig"));
  EXPECT_EQ(f.folder.bytes("case/0/alpha.air.orig"), kField);
  EXPECT_NE(f.folder.bytes("case/0/alpha.air").find("/* kept */"), std::string::npos);
}

// What the link names is the field; the link stays.
TEST(InitialCondition, AFieldThatIsALinkIsItsFile) {
  Fixture f;
  f.store("case/fields/alpha.water", kField);
  std::filesystem::create_directories(f.folder.path("case/0"));
  std::filesystem::create_symlink("../fields/alpha.water", f.folder.path("case/0/alpha.water"));
  EXPECT_THROW(initial_condition(f.job), Error);
  EXPECT_EQ(f.folder.bytes("case/fields/alpha.water"), kField);
  f.job.overwrite = true;
  f.job.phi = "psi";
  initial_condition(f.job);
  EXPECT_TRUE(std::filesystem::is_symlink(f.folder.path("case/0/alpha.water")));
  EXPECT_EQ(f.values("case/fields/alpha.water").size(), kCells * kCells * kCells);
  EXPECT_NE(f.folder.bytes("case/fields/alpha.water").find("/* kept */"), std::string::npos);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(f.folder.path("case/0")), {}), 2);
}

// Records the stages that are told.
struct Told : Progress {
  std::vector<std::string> stages;
  void begin_stage(std::string_view name) override { stages.emplace_back(name); }
};

TEST(InitialCondition, NoStageIsToldTwice) {
  Fixture f;
  f.job.dry_run = true;
  f.job.method = FractionMethod::linear;
  Told told;
  initial_condition(f.job, told);
  for (const char* stage : {"volume fractions", "cutting cells"}) EXPECT_EQ(std::count(told.stages.begin(), told.stages.end(), stage), 1) << stage;
}

TEST(InitialCondition, InvertedItIsWhatIsLeft) {
  Fixture f;
  f.job.invert = true;
  f.job.phi = "psi";
  const InitialConditionResult result = initial_condition(f.job);
  EXPECT_NEAR(result.alpha.volume, 8 - signed_volume(f.ball), 1e-12);
  const std::vector<double> alpha = f.values("case/0/alpha.water"), psi = f.values("case/0/psi");
  ASSERT_EQ(psi.size(), alpha.size());
  const double h = 2.0 / kCells;
  for (std::size_t c = 0; c < psi.size(); ++c) {
    const Vec3 at{-1 + h * (0.5 + static_cast<double>(c % kCells)), -1 + h * (0.5 + static_cast<double>(c / kCells % kCells)), -1 + h * (0.5 + static_cast<double>(c / kCells / kCells))};
    // A facet's sagitta off the sphere.
    EXPECT_NEAR(psi[c], norm(at - Vec3{0.03, -0.01, 0.02}) - 0.6, 2e-3);
    if (std::abs(psi[c]) > h) {
      EXPECT_EQ(alpha[c], psi[c] > 0 ? 1 : 0);
    }
  }
  EXPECT_NE(f.folder.bytes("case/0/psi").find("[0 1 0 0 0 0 0]"), std::string::npos);
}

// Both against the exact method, on the same triangles.
TEST(InitialCondition, LevelSetsComeNear) {
  Fixture f;
  f.job.dry_run = true;
  f.job.method = FractionMethod::linear;
  const InitialConditionResult linear = initial_condition(f.job);
  EXPECT_NEAR(linear.alpha.cell, 0.5 * 2 / kCells, 1e-12);
  EXPECT_NEAR(linear.alpha.volume, linear.alpha.in_mesh, 1e-3 * linear.alpha.in_mesh);
  f.job.method = FractionMethod::curved;
  const InitialConditionResult curved = initial_condition(f.job);
  EXPECT_NEAR(curved.alpha.volume, curved.alpha.in_mesh, 2e-4 * curved.alpha.in_mesh);
  EXPECT_LE(curved.alpha.max, 1);
  EXPECT_GE(curved.alpha.min, 0);
}

TEST(InitialCondition, RepairsWhatIsBroken) {
  Fixture f;
  // A hole, a facet the wrong way round, and another ball that overlaps the first.
  const TriangleSoup ball = scaled(icosphere(2), 0.6);
  const TriangleSoup broken = merged(with_flipped_facet(without_facets(ball, {7}), 100), moved(ball, {0.2, 0.1, 0}));
  f.job.input = f.folder.write("broken.ply", broken);
  const InitialConditionResult result = initial_condition(f.job);
  ASSERT_FALSE(result.failure);
  EXPECT_EQ(result.solid.repair, "local");
  // Two balls whose centres are d apart: the lens they share is pi (2 R - d)^2 (d^2 + 4 d R) / (12 d).
  const double r = 0.6, d = std::hypot(0.2, 0.1);
  const double lens = std::numbers::pi * (2 * r - d) * (2 * r - d) * (d * d + 4 * d * r) / (12 * d);
  EXPECT_NEAR(result.alpha.volume, 2 * 4.0 / 3 * std::numbers::pi * r * r * r - lens, 0.04);  // facets cut off 3 %
  EXPECT_NEAR(result.alpha.volume, result.solid.volume, 1e-12);
}

TEST(InitialCondition, ModelsMayReachOutOfTheMesh) {
  Fixture f;
  f.job.input = f.folder.write("half.ply", moved(scaled(icosphere(3), 0.5), {1, 0, 0}));
  const InitialConditionResult result = initial_condition(f.job);
  ASSERT_FALSE(result.failure);
  EXPECT_FALSE(result.alpha.difference);
  EXPECT_NEAR(result.alpha.in_mesh, 0.5 * result.solid.volume, 1e-12);
}

TEST(InitialCondition, RefusesWhatIsElsewhereOrOpen) {
  Fixture f;
  f.job.input = f.folder.write("far.ply", moved(f.ball, {10, 0, 0}));
  InitialConditionResult result = initial_condition(f.job);
  ASSERT_TRUE(result.failure);
  EXPECT_NE(std::string(result.failure->what()).find("the model is in (9.43, -0.61, -0.58) to (10.63, 0.59, 0.62), the mesh in (-1, -1, -1) to (1, 1, 1)"), std::string::npos) << result.failure->what();
  EXPECT_EQ(result.failure->hint().find("--scale"), std::string::npos);
  f.job.input = f.folder.write("mm.ply", scaled(moved(f.ball, {0.9, 0, 0}), 1000));
  result = initial_condition(f.job);
  ASSERT_TRUE(result.failure);
  EXPECT_NE(result.failure->hint().find("--scale 0.001 would fit"), std::string::npos) << result.failure->hint();
  f.job.scale = 1e-3;
  EXPECT_FALSE(initial_condition(f.job).failure);
  std::filesystem::remove_all(f.folder.path("case/0"));
  f.job.scale = 1;
  f.job.input = f.folder.write("around.ply", scaled(f.ball, 1000));
  f.job.dry_run = true;
  result = initial_condition(f.job);
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_NE(result.warnings[0].find("times as large as the mesh"), std::string::npos);
  EXPECT_EQ(result.alpha.min, 1);
  f.job.dry_run = false;
  f.job.input = f.folder.write("sheet.ply", height_field(4, [](int, int) { return 0.0; }));
  result = initial_condition(f.job);
  ASSERT_TRUE(result.failure);
  EXPECT_EQ(result.failure->code(), ErrorCode::guarantee_unmet);
  EXPECT_FALSE(f.folder.has("case/0"));
  const nlohmann::json json = nlohmann::json::parse(to_json(result));
  EXPECT_TRUE(json["alpha"].is_null());
  EXPECT_EQ(json["failure"]["exit_code"], 5);
}

}  // namespace
}  // namespace burnish
