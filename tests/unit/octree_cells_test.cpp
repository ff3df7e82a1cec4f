#include "octree_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/level_sets.h"
#include "support/random_octree.h"

namespace burnish {
namespace {

using namespace test;

// Halves and quarters, so that means of corners and interpolation between nodes are exact in float.
double linear(double x, double y, double z) { return 0.5 * x - 0.25 * y + z - 3; }

BuiltLevelSet linear_field(Octree tree) {
  BuiltLevelSet built;
  built.level_set = level_set_of<float>(std::move(tree), [](const LatticeNode& n) { return linear(n.x, n.y, n.z); });
  built.level_set.frame.origin = {1, 2, 3};
  built.level_set.frame.cell = 0.5;
  return built;
}

Vec3 center_of(const LatticeCube& cube) {
  const double half = 0.5 * static_cast<double>(1 << cube.level);
  return {cube.corner[0] + half, cube.corner[1] + half, cube.corner[2] + half};
}

// Whether the cube is so near to the domain's upper walls that a corner lies between nodes, one of which is beyond:
// values are continued there, not linear.
bool at_wall(const LatticeCube& cube, int depth) {
  for (const std::int32_t c : cube.corner)
    if (c + (4 << cube.level) > 1 << depth) return true;
  return false;
}

std::vector<double> values_of(const CellGrid& grid, const std::string& name, const std::vector<LatticeCube>& cubes) {
  for (const auto& array : grid.cell_arrays) {
    if (array.name != name) continue;
    std::vector<double> values(cubes.size());
    array.fill(cubes, values.data());
    return values;
  }
  ADD_FAILURE() << "no array " << name;
  return std::vector<double>(cubes.size());
}

// Leaves of all levels are cut into cells here, as an adaptive octree's are near a surface.
TEST(OctreeCells, OfSeveralLevelsTileTheDomainInMortonOrder) {
  std::mt19937 random(5);
  const std::vector<std::uint32_t> no_facets;
  for (int run = 0; run < 20; ++run) {
    const BuiltLevelSet built = linear_field(random_octree(random, 3, 12));
    for (const FieldCells choice : {FieldCells::near, FieldCells::blocks}) {
      const OctreeCells cells(built, no_facets, choice);
      const CellGrid grid = cells.grid();
      ASSERT_EQ(grid.count, built.level_set.octree().size() * (choice == FieldCells::near ? kBlockNodes : 1));
      EXPECT_EQ(grid.depth, 6);
      std::vector<LatticeCube> cubes(grid.count);
      grid.cubes(0, cubes);
      double volume = 0;
      for (const LatticeCube& cube : cubes) volume += std::pow(8.0, cube.level);
      EXPECT_EQ(volume, std::pow(8.0, grid.depth));
      for (std::size_t i = 1; i < cubes.size(); ++i) {
        const auto key = [&](std::size_t c) {
          const LatticePoint& p = cubes[c].corner;
          return morton::interleave({static_cast<std::uint32_t>(p[0]), static_cast<std::uint32_t>(p[1]), static_cast<std::uint32_t>(p[2])});
        };
        ASSERT_LT(key(i - 1), key(i));
      }
      std::vector<LatticeCube> some(std::min<std::size_t>(700, cubes.size() - 1));
      grid.cubes(1, some);
      EXPECT_EQ(some.back().corner, cubes[some.size()].corner);

      const auto phi = values_of(grid, "phi", cubes), inside = values_of(grid, "inside", cubes), level = values_of(grid, "level", cubes);
      const auto block = values_of(grid, "block", cubes);
      for (std::size_t i = 0; i < cubes.size(); ++i) {
        const Vec3 at = center_of(cubes[i]);
        if (!at_wall(cubes[i], grid.depth)) {
          ASSERT_EQ(phi[i], 0.5 * linear(at.x, at.y, at.z));
        }
        ASSERT_EQ(inside[i], phi[i] >= 0);
        ASSERT_EQ(level[i], cubes[i].level);
        ASSERT_EQ(block[i], static_cast<double>(choice == FieldCells::near ? i / kBlockNodes : i));
      }
    }
  }
}

TEST(OctreeCells, OctantsAboveBlocksHaveTheValueOfTheirMiddle) {
  const BuiltLevelSet built = linear_field(Octree::build(2, all_blocks(2)));
  const std::vector<std::uint32_t> no_facets;
  const OctreeCells cells(built, no_facets, FieldCells::blocks);
  const CellGrid grid = cells.grid();
  const std::vector<LatticeCube> octants{{{0, 0, 0}, 5}, {{16, 0, 16}, 4}, {{8, 8, 0}, 3}};
  const auto phi = values_of(grid, "phi", octants), block = values_of(grid, "block", octants);
  for (std::size_t i = 0; i < octants.size(); ++i) {
    const Vec3 at = center_of(octants[i]);
    EXPECT_EQ(phi[i], 0.5 * linear(at.x, at.y, at.z));
  }
  EXPECT_EQ(block, (std::vector<double>{-1, -1, 3}));
}

TEST(OctreeCells, FacetsAreThoseOfTheInput) {
  BuiltLevelSet built = linear_field(Octree::build(1, all_blocks(1)));
  built.nearest = Field<std::uint32_t>(8, kNoFacet);
  built.nearest.block(0)[node_index(0, 0, 0)] = 0;
  built.nearest.block(0)[node_index(4, 4, 4)] = 1;
  built.nearest.block(7)[node_index(7, 6, 5)] = 2;
  const std::vector<std::uint32_t> input_facet{20, 10, kNoFacet};
  const OctreeCells cells(built, input_facet, FieldCells::near);
  const std::vector<LatticeCube> cubes{{{0, 0, 0}, 0}, {{0, 0, 0}, 3}, {{15, 14, 13}, 0}, {{0, 1, 0}, 0}, {{0, 0, 0}, 4}};
  EXPECT_EQ(values_of(cells.grid(), "facet", cubes), (std::vector<double>{20, 10, -1, -1, -1}));
}

}  // namespace
}  // namespace burnish
