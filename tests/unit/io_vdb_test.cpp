// What `field` writes as .vdb, read back by OpenVDB.
#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Diagnostics.h>
#include <openvdb/tools/Interpolation.h>

#include <cmath>

#include "burnish/core/parallel.h"
#include "burnish/io/vdb.h"
#include "burnish/pipeline/field.h"
#include "burnish/surface/exact_distance.h"
#include "support/folder.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

// The only grid of a file.
openvdb::FloatGrid::Ptr grid_in(const std::string& path) {
  openvdb::initialize();
  openvdb::io::File file(path);
  file.open();
  const auto grids = file.getGrids();
  EXPECT_EQ(grids->size(), 1u);
  return openvdb::gridPtrCast<openvdb::FloatGrid>(grids->front());
}

double in_unit_cube(const Vec3& p) {
  const Vec3 q{std::abs(p.x - 0.5) - 0.5, std::abs(p.y - 0.5) - 0.5, std::abs(p.z - 0.5) - 0.5};
  return -norm(max(q, Vec3{})) - std::min(0.0, std::max({q.x, q.y, q.z}));
}

Vec3 world(const openvdb::FloatGrid& grid, const openvdb::Coord& at) {
  const openvdb::Vec3d p = grid.indexToWorld(at);
  return {p.x(), p.y(), p.z()};
}

FieldJob job_for(const Folder& folder, const TriangleSoup& soup, double cell) {
  FieldJob job;
  job.input = folder.write("in.stl", soup);
  job.output = folder.path("out.vdb");
  job.options.cell = Length{cell, LengthUnit::model};
  return job;
}

// Every voxel's value is the negative of the distance, rounded to float; active are those within the band, and no others.
void expect_band_of_a_cube(const openvdb::FloatGrid& grid, double cell, double half_width) {
  EXPECT_EQ(grid.getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_EQ(grid.voxelSize().x(), cell);
  const double background = static_cast<double>(grid.background());
  EXPECT_FLOAT_EQ(grid.background(), static_cast<float>(half_width));
  const auto accessor = grid.getConstAccessor();
  const openvdb::Coord lower = openvdb::Coord::round(grid.worldToIndex({-0.5, -0.5, -0.5})), upper = openvdb::Coord::round(grid.worldToIndex({1.5, 1.5, 1.5}));
  std::size_t active = 0, wrong = 0;
  double worst = 0;
  for (int i = lower.x(); i <= upper.x(); ++i)
    for (int j = lower.y(); j <= upper.y(); ++j)
      for (int k = lower.z(); k <= upper.z(); ++k) {
        const openvdb::Coord at(i, j, k);
        const double d = in_unit_cube(world(grid, at)), value = static_cast<double>(accessor.getValue(at));
        if (std::abs(std::abs(d) - background) < 1e-6) continue;
        const bool within = std::abs(d) < background;
        wrong += accessor.isValueOn(at) != within;
        active += within;
        worst = std::max(worst, std::abs(value + std::clamp(d, -background, background)));
      }
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(active, 1000u);
  EXPECT_LT(worst, 1e-7 * 2);
}

TEST(Vdb, HasTheDistanceInEveryVoxelOfTheBand) {
  const Folder folder;
  const FieldResult result = field(job_for(folder, cube(), 0.05));
  ASSERT_TRUE(result.output.written);
  EXPECT_EQ(result.output.spacing, 0.05);
  const auto grid = grid_in(folder.path("out.vdb"));
  expect_band_of_a_cube(*grid, 0.05, 0.15);
  EXPECT_EQ(grid->activeVoxelCount(), result.output.voxel_count);
  EXPECT_EQ(grid->getName(), "surface");
}

TEST(Vdb, BandsMayBeWiderThanThatOfExactNodes) {
  const Folder folder;
  FieldJob job = job_for(folder, cube(), 0.05);
  job.content.narrow_band = Length{5, LengthUnit::cells};
  field(job);
  expect_band_of_a_cube(*grid_in(job.output), 0.05, 0.25);
}

// Blocks that are coarse are sampled.
TEST(Vdb, OfAnAdaptiveOctreeIsAsExact) {
  const Folder folder;
  FieldJob job = job_for(folder, cube(), 0.02);
  job.options.adapt = Length{0.5, LengthUnit::cells};
  job.options.cell_max = Length{4, LengthUnit::cells};
  const FieldResult result = field(job);
  ASSERT_GT(result.grid.by_level[1].near_blocks + result.grid.by_level[2].near_blocks, 0u);
  expect_band_of_a_cube(*grid_in(job.output), 0.02, 0.06);
}

// Flood-filled: negative in the middle, positive far outside. OpenVDB's own judgement: a level set whose gradient has length 1.
TEST(Vdb, IsALevelSetToOpenVdb) {
  const Folder folder;
  for (const double smooth : {0.0, 0.2}) {
    FieldJob job = job_for(folder, icosphere(5), 0.05);
    job.overwrite = true;
    job.options.smooth = Length{smooth, LengthUnit::model};
    job.options.mode = SmoothMode::volume;
    field(job);
    const auto grid = grid_in(job.output);
    const auto at = [&](double x) { return grid->getConstAccessor().getValue(openvdb::Coord::round(grid->worldToIndex({x, 0, 0}))); };
    EXPECT_FLOAT_EQ(at(0), -0.15f);
    EXPECT_FLOAT_EQ(at(30), 0.15f);
    EXPECT_FLOAT_EQ(at(-3), 0.15f);
    EXPECT_EQ(openvdb::tools::checkLevelSet(*grid, 8), "") << "smoothing length " << smooth;
    double worst = 0;
    for (auto v = grid->cbeginValueOn(); v; ++v) worst = std::max(worst, std::abs(static_cast<double>(*v) - (norm(world(*grid, v.getCoord())) - 1)));
    EXPECT_LT(worst, 0.003) << "smoothing length " << smooth;
  }
}

TEST(Vdb, SameBytesForAnyNumberOfThreads) {
  const Folder folder;
  FieldJob job = job_for(folder, icosphere(4), 0.04);
  std::string bytes;
  {
    const ThreadLimit one(1);
    field(job);
    bytes = folder.bytes("out.vdb");
  }
  job.overwrite = true;
  const ThreadLimit many(4);
  field(job);
  EXPECT_TRUE(folder.bytes("out.vdb") == bytes);
}

}  // namespace
}  // namespace burnish
