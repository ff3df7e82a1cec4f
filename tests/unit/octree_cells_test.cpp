#include "octree_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
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

TEST(OctreeCells, OnlyThoseThatAreChosen) {
  const BuiltLevelSet built = linear_field(Octree::build(2, all_blocks(2)));
  const std::vector<std::uint32_t> no_facets;
  CellChoice choice;
  choice.arrays = {FieldArray::level, FieldArray::phi};
  choice.at_points = false;
  choice.within = 2;
  const OctreeCells every(built, no_facets, FieldCells::near), some(built, no_facets, FieldCells::near, choice);
  const CellGrid all = every.grid(), grid = some.grid();
  EXPECT_TRUE(grid.point_arrays.empty());
  ASSERT_EQ(grid.cell_arrays.size(), 2u);
  std::vector<LatticeCube> cubes(all.count), chosen(grid.count), expected;
  all.cubes(0, cubes);
  grid.cubes(0, chosen);
  const auto phi = values_of(all, "phi", cubes);
  for (std::size_t c = 0; c < cubes.size(); ++c)
    if (std::abs(phi[c]) <= 0.5 * 2) expected.push_back(cubes[c]);  // a cell is half a unit wide
  ASSERT_EQ(chosen.size(), expected.size());
  EXPECT_GT(chosen.size(), 1000u);
  for (std::size_t c = 0; c < chosen.size(); ++c) ASSERT_EQ(chosen[c].corner, expected[c].corner);
  choice.within.reset();
  choice.clamp = 2;
  const OctreeCells ending(built, no_facets, FieldCells::near, choice);
  const auto clamped = values_of(ending.grid(), "phi", cubes);
  for (std::size_t c = 0; c < cubes.size(); ++c) ASSERT_EQ(clamped[c], std::clamp(phi[c], -1.0, 1.0));
}

// Of a ball 1 / R, in the model's units, at cells that the surface is in or beside, and nowhere else.
TEST(OctreeCells, MeanCurvatureIsThatOfTheSurface) {
  BuiltLevelSet built;
  const Vec3 center{32.2, 31.7, 32.4};
  constexpr double kRadius = 20;
  built.level_set = level_set_of<float>(Octree::build(3, all_blocks(3)), [&](const LatticeNode& n) { return kRadius - norm(to_vec(n) - center); });
  built.level_set.frame.cell = 0.25;
  built.level_set.band = 1e9;
  const Field<float> curvature = curvature_of_cells(built.level_set, no_progress());
  const std::vector<std::uint32_t> no_facets;
  CellChoice choice;
  choice.curvature = &curvature;
  const OctreeCells cells(built, no_facets, FieldCells::near, choice);
  const CellGrid grid = cells.grid();
  std::vector<LatticeCube> cubes(grid.count);
  grid.cubes(0, cubes);
  const auto found = values_of(grid, "mean_curvature", cubes), confidence = values_of(grid, "sign_confidence", cubes);
  std::size_t near = 0;
  for (std::size_t c = 0; c < cubes.size(); ++c) {
    ASSERT_EQ(confidence[c], 1);
    const double phi = kRadius - norm(center_of(cubes[c]) - center);
    if (std::abs(phi) < 0.98) {
      ASSERT_NEAR(found[c], 1 / (kRadius * 0.25), 0.01 / (kRadius * 0.25));
      ++near;
    } else if (std::abs(phi) > 1.05) {
      ASSERT_TRUE(std::isnan(found[c]));
    }
  }
  EXPECT_GT(near, 5000u);
}

TEST(OctreeCells, ConfidenceIsThatOfTheLeastCertainCorner) {
  BuiltLevelSet built = linear_field(Octree::build(1, all_blocks(1)));
  built.certainty = Field<std::uint8_t>(8, 255);
  built.certainty.block(1)[node_index(0, 3, 3)] = 51;  // lattice node (8, 3, 3)
  const std::vector<std::uint32_t> no_facets;
  const OctreeCells cells(built, no_facets, FieldCells::near);
  const std::vector<LatticeCube> cubes{{{7, 2, 2}, 0}, {{8, 3, 3}, 0}, {{9, 3, 3}, 0}, {{8, 0, 0}, 3}, {{0, 0, 0}, 3}, {{15, 15, 15}, 0}};
  const auto confidence = values_of(cells.grid(), "sign_confidence", cubes);
  EXPECT_EQ(confidence, (std::vector<double>{0.2, 0.2, 1, 0.2, 1, 1}));
}

}  // namespace
}  // namespace burnish
