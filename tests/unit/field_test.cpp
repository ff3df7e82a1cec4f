#include "burnish/pipeline/field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "burnish/io/vdb.h"
#include "burnish/io/voxel_volume.h"
#include "support/folder.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

FieldJob job_for(const Folder& folder, const TriangleSoup& soup, int resolution) {
  FieldJob job;
  job.input = folder.write("in.stl", soup);
  job.options.resolution = resolution;
  return job;
}

double distance_in_unit_cube(const Vec3& p) {
  const Vec3 q{std::abs(p.x - 0.5) - 0.5, std::abs(p.y - 0.5) - 0.5, std::abs(p.z - 0.5) - 0.5};
  return -norm(max(q, Vec3{})) - std::min(0.0, std::max({q.x, q.y, q.z}));
}

TEST(Field, ReportsTheOctreeAndTheVolume) {
  const Folder folder;
  const TriangleSoup ball = icosphere(4);
  FieldJob job = job_for(folder, ball, 64);
  job.band = 5;
  job.verify = 400;
  const FieldResult result = field(job);
  ASSERT_FALSE(result.failure);
  EXPECT_FALSE(result.output.written);
  EXPECT_EQ(folder.file_count(), 1);
  EXPECT_EQ(result.band, 5);
  EXPECT_EQ(result.regions, 2u);
  EXPECT_EQ(result.facets, ball.facets.size());
  EXPECT_EQ(result.grid.nodes, 512 * result.grid.blocks);
  EXPECT_GT(result.grid.near_blocks, 0u);
  EXPECT_LE(result.grid.near_blocks, result.grid.finest_blocks);
  EXPECT_GT(result.grid.bytes, 4 * result.grid.nodes);
  EXPECT_NEAR(result.volume.prepared, signed_volume(ball), 1e-6);
  EXPECT_NEAR(result.volume.level_set, result.volume.prepared, 0.002 * result.volume.prepared);
  ASSERT_TRUE(result.verification);
  EXPECT_TRUE(result.verification->passed());
  EXPECT_EQ(result.verification->total(), 400u);
}

TEST(Field, OfBlocksOfSeveralLevelsIsAsGoodWithFewer) {
  const Folder folder;
  FieldJob job = job_for(folder, icosphere(5), 200);
  const FieldResult uniform = field(job);
  EXPECT_FALSE(uniform.is_adaptive());
  EXPECT_EQ(uniform.grid.by_level[0].near_blocks, uniform.grid.near_blocks);
  job.options.adapt = Length{0.1, LengthUnit::cells};
  job.verify = 1000;
  const FieldResult result = field(job);
  ASSERT_TRUE(result.is_adaptive());
  EXPECT_TRUE(result.verification->passed());
  EXPECT_EQ(result.options.coarsest_level, 3);
  std::uint64_t blocks = 0, near = 0, divided = result.growth.divided_by_balance;
  for (std::size_t l = 0; l < result.grid.by_level.size(); ++l) {
    blocks += result.grid.by_level[l].blocks;
    near += result.grid.by_level[l].near_blocks;
    EXPECT_EQ(result.grid.by_level[l].blocks, result.growth.levels[l].leaves);
  }
  EXPECT_EQ(blocks, result.grid.blocks);
  EXPECT_EQ(near, result.grid.near_blocks);
  for (const std::uint64_t n : result.growth.divided_by) divided += n;
  EXPECT_LE(7 * divided + 1, blocks);
  EXPECT_LT(4 * blocks, uniform.grid.blocks);
  EXPECT_LT(result.grid.by_level[0].near_blocks, near);
  // A tenth of a finest cell all over the surface of a ball of radius 1.
  EXPECT_NEAR(result.volume.level_set, uniform.volume.level_set, 0.1 * result.options.cell * 4 * 3.1416);
}

// The limits say how many facets a cell may have, not how far off it may be: beside --adapt they divide more, never less.
TEST(Field, TakesTheLimitsOfFacetsToo) {
  const Folder folder;
  FieldJob job = job_for(folder, icosphere(5), 100);
  job.options.adapt = Length{0.1, LengthUnit::cells};
  const FieldResult without = field(job);
  job.limits.max_face_limit = 0;
  const FieldResult with = field(job);
  ASSERT_EQ(with.growth.divided_by.size(), 2u);
  EXPECT_GT(with.growth.divided_by[0], 0u);
  EXPECT_GT(with.grid.by_level[0].near_blocks, without.grid.by_level[0].near_blocks);
  job.options.adapt.reset();
  const FieldResult alone = field(job);
  ASSERT_EQ(alone.growth.divided_by.size(), 1u);
  EXPECT_LE(alone.grid.blocks, with.grid.blocks);
}

TEST(Field, WritesWhatIsAskedFor) {
  const Folder folder;
  FieldJob job = job_for(folder, cube(), 24);
  std::uint64_t blocks = 0, near = 0;
  for (const char* suffix : {".vtu", ".htg"})
    for (const FieldCells cells : {FieldCells::blocks, FieldCells::near, FieldCells::cells}) {
      job.output = folder.path(std::string(name(cells)) + suffix);
      job.cells = cells;
      const FieldResult result = field(job);
      EXPECT_TRUE(result.output.written);
      EXPECT_EQ(result.output.bytes, std::filesystem::file_size(job.output));
      blocks = result.grid.blocks, near = result.grid.near_blocks;
      EXPECT_GT(blocks, near);
      const std::uint64_t cut = cells == FieldCells::blocks ? 0 : cells == FieldCells::near ? near : blocks;
      EXPECT_EQ(result.output.cell_count, blocks + 511 * cut);
      EXPECT_EQ(result.output.point_count > 0, suffix == std::string(".vtu"));
      // Of a full tree in which a node has eight children.
      EXPECT_EQ(result.output.octant_count, suffix == std::string(".htg") ? result.output.cell_count + (result.output.cell_count - 1) / 7 : 0);
    }
}

// A facet without an area closes what it closes, and the octree's lists do not number it.
TEST(Field, FacetsWithoutAnAreaAreNoPartOfIt) {
  const Folder folder;
  TriangleSoup soup = cube();
  const Facet split = soup.facets[0];
  const auto middle = static_cast<std::uint32_t>(soup.points.size());
  soup.points.push_back((soup.corner(0, 0) + soup.corner(0, 1)) * 0.5);
  soup.facets[0] = {split[0], middle, split[2]};
  soup.facets.push_back({middle, split[1], split[2]});
  soup.facets.insert(soup.facets.begin(), Facet{split[0], split[1], middle});
  FieldJob job = job_for(folder, soup, 24);
  job.verify = 1000;
  job.output = folder.path("out.htg");
  const FieldResult result = field(job);
  ASSERT_FALSE(result.failure);
  EXPECT_EQ(result.before.degenerate_facets, 1u);
  EXPECT_EQ(result.facets, 13u);
  ASSERT_TRUE(result.verification);
  EXPECT_TRUE(result.verification->passed());
}

TEST(Field, AnOpenSheetHasNone) {
  const Folder folder;
  FieldJob job = job_for(folder, without_facets(cube(), {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}), 24);
  job.output = folder.path("out.vtu");
  const FieldResult result = field(job);
  ASSERT_TRUE(result.failure);
  EXPECT_EQ(result.failure->code(), ErrorCode::guarantee_unmet);
  EXPECT_EQ(folder.file_count(), 1);
  const auto json = nlohmann::json::parse(to_json(result));
  EXPECT_TRUE(json["grid"].is_null() && json["verification"].is_null());
  EXPECT_EQ(json["failure"]["exit_code"], 5);
}

TEST(Field, TooManyCellsForTheBudgetAreRefused) {
  const Folder folder;
  FieldJob job = job_for(folder, cube(), 64);
  job.output = folder.path("out.vtu");
  job.cells = FieldCells::cells;
  job.options.memory_bytes = 90'000'000;
  try {
    field(job);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::memory_limit);
    EXPECT_NE(error.hint().find("--blocks"), std::string::npos);
  }
  EXPECT_EQ(folder.file_count(), 1);
}

// A layer is held at once, and so are all blocks of a .vdb.
TEST(Field, TooManySamplesForTheBudgetAreRefused) {
  const Folder folder;
  FieldJob job = job_for(folder, cube(), 16);
  job.options.memory_bytes = 200'000'000;
  const auto expect_refused = [&](const char* hint) {
    try {
      field(job);
      ADD_FAILURE() << job.output;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::memory_limit) << error.what();
      EXPECT_NE(error.hint().find(hint), std::string::npos) << error.hint();
    }
    EXPECT_EQ(folder.file_count(), 1);
  };
  job.output = folder.path("out.nrrd");
  job.content.box = Box3{{0, 0, 0}, {1, 1, 0}};
  job.content.samples = 10'000;
  expect_refused("--spacing");
  if (!has_openvdb()) return;
  job = job_for(folder, cube(), 100);
  job.options.memory_bytes = 100'000'000;
  job.output = folder.path("out.vdb");
  job.content.narrow_band = Length{100, LengthUnit::cells};
  expect_refused("--narrow-band");
}

// Distances to the input's facets, on a grid of the user's.
TEST(Field, UniformGridsHaveTheDistance) {
  const Folder folder;
  for (const char* suffix : {".vti", ".nrrd"}) {
    FieldJob job = job_for(folder, cube(), 24);
    job.output = folder.path(std::string("out") + suffix);
    job.content.box = Box3{{-1, 0, 0.2}, {3, 1.1, 0.7}};
    job.content.samples = 41;
    const FieldResult result = field(job);
    ASSERT_TRUE(result.output.written);
    const VoxelVolume volume = read_voxels(job.output);
    EXPECT_EQ(volume.nodes, (std::array<std::uint32_t, 3>{41, 12, 6}));
    EXPECT_EQ(volume.nodes, result.output.samples);
    std::size_t v = 0;
    for (std::uint32_t k = 0; k < volume.nodes[2]; ++k)
      for (std::uint32_t j = 0; j < volume.nodes[1]; ++j)
        for (std::uint32_t i = 0; i < volume.nodes[0]; ++i, ++v) {
          const Vec3 p = volume.origin + Vec3{i * volume.spacing.x, j * volume.spacing.y, k * volume.spacing.z};
          const double exact = distance_in_unit_cube(p), phi = static_cast<double>(volume.values[v]);
          ASSERT_NEAR(phi, exact, std::abs(exact) < 3 * result.options.cell ? 1e-7 : 0.0102 * std::abs(exact)) << p.x << ' ' << p.y << ' ' << p.z;
        }
    job.content.narrow_band = Length{0.1, LengthUnit::model};
    job.overwrite = true;
    field(job);
    const VoxelVolume clamped = read_voxels(job.output);
    for (v = 0; v < clamped.values.size(); ++v) ASSERT_EQ(clamped.values[v], std::clamp(volume.values[v], -0.1f, 0.1f));
  }
}

// The flow's surface, and a distance through the whole domain.
TEST(Field, SmoothedIsTheDistanceToTheSmoothedSurface) {
  const Folder folder;
  TriangleSoup ball = icosphere(4);
  for (std::size_t p = 0; p < ball.points.size(); ++p) ball.points[p] = ball.points[p] * (1 + (p % 3 == 0 ? 0.02 : p % 3 == 1 ? -0.02 : 0.0));
  for (const bool adapt : {false, true}) {
    FieldJob job = job_for(folder, ball, 48);
    job.options.smooth = Length{0.6, LengthUnit::model};
    job.options.mode = SmoothMode::volume;
    if (adapt) job.options.adapt = Length{0.1, LengthUnit::cells};
    job.output = folder.path("out.vti");
    job.overwrite = true;
    job.content.box = Box3{{-1.6, -1.6, -1.6}, {1.6, 1.6, 1.6}};
    job.content.samples = 33;
    const FieldResult result = field(job);
    ASSERT_TRUE(result.output.written);
    EXPECT_EQ(result.smoothing.mode, SmoothMode::volume);
    EXPECT_GT(result.smoothing.rms_moved, 0.002);
    const VoxelVolume volume = read_voxels(job.output);
    std::size_t v = 0;
    double worst = 0;
    for (int k = 0; k < 33; ++k)
      for (int j = 0; j < 33; ++j)
        for (int i = 0; i < 33; ++i, ++v) {
          const double r = 0.1 * norm(Vec3{i - 16.0, j - 16.0, k - 16.0});
          if (r > 0.3) worst = std::max(worst, std::abs(static_cast<double>(volume.values[v]) - (1 - r)));
        }
    EXPECT_LT(worst, 0.012) << "adaptive: " << adapt;
  }
}

TEST(Field, SmoothingExcludesWhatHoldsOnToTheFacets) {
  const Folder folder;
  FieldJob job = job_for(folder, cube(), 24);
  job.options.smooth = Length{0.2, LengthUnit::model};
  job.verify = 10;
  EXPECT_THROW(field(job), Error);
  job.verify = 0;
  job.redistance = RedistanceMethod::fmm;
  job.exact = ExactNodes::band;
  EXPECT_THROW(field(job), Error);
}

}  // namespace
}  // namespace burnish
