#include "burnish/pipeline/cell_octree.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>

#include "burnish/core/parallel.h"
#include "burnish/surface/example_shapes.h"
#include "support/folder.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

// What the rule of docs/benchmarks.md gives is the default.
TEST(CellOctree, OfTheThesisSphereHasTheCountsOfTheBenchmarks) {
  const Folder folder;
  CellOctreeJob job;
  job.input = folder.write("sphere.stl", make_example(ExampleShape::sphere, {}).dirty);
  const CellOctreeResult result = cell_octree(job);
  EXPECT_EQ(result.facets, 550u);
  EXPECT_EQ(result.statistics.cells(), 1737u);
  EXPECT_EQ(result.statistics.cells_cut(), 660u);
  EXPECT_EQ(result.limits.max_face_limit, 3u);
  EXPECT_EQ(result.limits.refine_tol, 2.0);
  EXPECT_EQ(result.limits.coarsest_level, 5);
  EXPECT_NEAR(result.cells_along_longest_side, 160, 1e-9);
  EXPECT_EQ(result.cell_max, 32 * result.cell);
  EXPECT_FALSE(result.output.written);
  EXPECT_EQ(folder.file_count(), 1);
  // Every division makes seven octants more.
  const std::uint64_t divided = std::accumulate(result.statistics.divided_by.begin(), result.statistics.divided_by.end(), std::uint64_t{0});
  EXPECT_EQ((result.statistics.cells() - 1) % 7, 0u);
  EXPECT_LT(divided + result.statistics.divided_by_balance, (result.statistics.cells() - 1) / 7);
}

TEST(CellOctree, WritesACellForEachLeaf) {
  const Folder folder;
  CellOctreeJob job;
  job.input = folder.write("in.stl", icosphere(3));
  for (const char* name : {"f.vtu", "f.htg"}) {
    job.output = folder.path(name);
    const CellOctreeResult result = cell_octree(job);
    EXPECT_TRUE(result.output.written);
    EXPECT_EQ(result.output.cell_count, result.statistics.cells());
    EXPECT_EQ(result.output.bytes, std::filesystem::file_size(job.output));
    EXPECT_THROW(cell_octree(job), Error) << "written twice";
  }
}

// A sheet has no inside; an octree of its facets is none the worse.
TEST(CellOctree, TakesSheets) {
  const Folder folder;
  TriangleSoup sheet = icosphere(3);
  sheet.facets.resize(sheet.facets.size() / 2);
  CellOctreeJob job;
  job.input = folder.write("in.stl", sheet);
  job.limits.max_face_cut = 8;
  job.resolution = 64;
  job.cell_max = Length{8, LengthUnit::cells};
  const CellOctreeResult result = cell_octree(job);
  EXPECT_EQ(result.limits.coarsest_level, 3);
  EXPECT_FALSE(result.limits.max_face_limit) << "a default beside a limit that was given";
  ASSERT_EQ(result.statistics.divided_by.size(), 1u);
  EXPECT_GT(result.statistics.divided_by[0], 0u);
  for (std::size_t level = 4; level < result.statistics.levels.size(); ++level) EXPECT_EQ(result.statistics.levels[level].cells_cut, 0u);
  const auto json = nlohmann::json::parse(to_json(result));
  EXPECT_EQ(json["divided"]["max_face_cut"], result.statistics.divided_by[0]);
  EXPECT_TRUE(json["divided"]["refine_tol"].is_null());
  EXPECT_TRUE(json["output"].is_null());
  EXPECT_EQ(json["cells"]["cut"], result.statistics.cells_cut());
}

TEST(CellOctree, IsTheSameFileForAnyNumberOfThreads) {
  const Folder folder;
  CellOctreeJob job;
  job.input = folder.write("in.stl", torus(48, 24));
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    job.output = folder.path(std::to_string(threads) + ".htg");
    cell_octree(job);
  }
  EXPECT_EQ(folder.bytes("1.htg"), folder.bytes("3.htg"));
}

TEST(CellOctree, RefusesWhatMakesNoSense) {
  const Folder folder;
  const auto code_of = [](const CellOctreeJob& job) {
    try {
      cell_octree(job);
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode::bug;
  };
  CellOctreeJob job;
  job.input = folder.write("in.stl", cube());
  job.cell = Length{0.1, LengthUnit::model};
  job.cell_max = Length{0.05, LengthUnit::model};
  EXPECT_EQ(code_of(job), ErrorCode::usage);
  job.cell_max.reset();
  job.cell = Length{1e-7, LengthUnit::model};
  EXPECT_EQ(code_of(job), ErrorCode::memory_limit);
  job.cell.reset();
  job.output = folder.path("f.htg");
  job.memory_bytes = 200'000;
  EXPECT_EQ(code_of(job), ErrorCode::memory_limit) << "writing";
  job.output.clear();
  EXPECT_EQ(code_of(job), ErrorCode::bug) << "growing alone takes less";
  job.limits.max_face_cut = 0;  // down to the finest cells, everywhere
  job.resolution = 4000;
  EXPECT_EQ(code_of(job), ErrorCode::memory_limit);
  job.limits = {};
  job.resolution.reset();
  job.output.clear();
  job.input = folder.write("point.stl", TriangleSoup{{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}}, {}});
  EXPECT_EQ(code_of(job), ErrorCode::guarantee_unmet);
}

}  // namespace
}  // namespace burnish
