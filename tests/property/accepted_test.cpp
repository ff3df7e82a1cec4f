#include "burnish/levelset/accepted.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "burnish/core/parallel.h"
#include "burnish/levelset/distance.h"
#include "burnish/levelset/from_triangles.h"
#include "burnish/octree/refine.h"
#include "burnish/surface/example_shapes.h"
#include "support/level_sets.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

constexpr int kDepth = 3;
constexpr int kVoxels = 8 << kDepth;  // finest cells a side

Vec3 random_point(std::mt19937& random, double low, double high) {
  std::uniform_real_distribution<double> any(low, high);
  const double x = any(random), y = any(random), z = any(random);
  return {x, y, z};
}

// A few facets of all sizes in a domain of 64 cells, some with whole coordinates: they touch cells they do not run through.
TriangleSoup random_facets(std::mt19937& random) {
  TriangleSoup soup;
  const auto count = static_cast<std::uint32_t>(1 + random() % 4);
  for (std::uint32_t f = 0; f < count; ++f) {
    const Vec3 a = random_point(random, 24, 40);
    const double size = std::exp(std::uniform_real_distribution<double>(-1, 2)(random));
    for (int i = 0; i < 3; ++i) {
      Vec3 p = max(min(a + random_point(random, -size, size), {44, 44, 44}), {20, 20, 20});
      if (random() % 4 == 0) p = {std::round(p.x), std::round(p.y), std::round(p.z)};
      soup.points.push_back(p);
    }
    soup.facets.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  return soup;
}

struct Case {
  TriangleSoup soup;
  LevelSet set;
  std::vector<char> active;
};

// Leaves of several levels meet the facets; with `dense`, every leaf stores values.
Case random_case(unsigned seed) {
  std::mt19937 random(seed);
  Case c{random_facets(random), {}, {}};
  RefinementLimits limits;
  limits.max_face_limit = static_cast<std::uint32_t>(random() % 2);
  limits.refine_tol = std::exp(std::uniform_real_distribution<double>(-1, 1)(random));
  const auto criteria = criteria_of(limits);
  std::vector<const RefinementCriterion*> asked;
  for (const auto& criterion : criteria) asked.push_back(criterion.get());
  c.set.band = accepted_band(true);
  c.set.grid = grow_adaptive(c.soup, kDepth, {kBlockSide, static_cast<int>(random() % 3), c.set.band}, asked).grid;
  if (seed % 2) c.set.grid.layout = layout_of(c.set.octree().size(), [&](std::size_t leaf) { return c.set.grid.near_surface(leaf); });
  if (seed % 3 == 0) {
    c.active.assign(c.soup.facets.size(), 1);
    c.active[random() % c.active.size()] = 0;
  }
  c.set.frame.depth = kDepth;
  c.set.phi = exact_distances(c.soup, c.set.grid, c.set.band, c.active).distance;
  return c;
}

struct Cell {
  std::size_t leaf, place;
  LatticeNode low;
  int side;
  AcceptedMark mark = AcceptedMark::none;
};

// All cells, and which of them each finest cell of the domain belongs to.
struct Cells {
  std::vector<Cell> all;
  std::vector<std::uint32_t> of_voxel = std::vector<std::uint32_t>(std::size_t{kVoxels} * kVoxels * kVoxels);

  explicit Cells(const Octree& tree) {
    for (std::size_t leaf = 0; leaf < tree.size(); ++leaf)
      for (int n = 0; n < static_cast<int>(kBlockNodes); ++n) {
        all.push_back({leaf, static_cast<std::size_t>(n), lattice_node(tree, leaf, n % 8, n / 8 % 8, n / 64), 1 << tree.level(leaf)});
        for_voxels(all.back(), 0, [&](std::uint32_t& cell) { cell = static_cast<std::uint32_t>(all.size() - 1); });
      }
  }

  // The finest cells of a cell, and `around` layers about them.
  template <class Visit>
  void for_voxels(const Cell& c, int around, Visit&& visit) {
    const auto low = [&](int x) { return std::max(0, x - around); };
    const auto high = [&](int x) { return std::min(kVoxels, x + c.side + around); };
    for (int z = low(c.low.z); z < high(c.low.z); ++z)
      for (int y = low(c.low.y); y < high(c.low.y); ++y)
        for (int x = low(c.low.x); x < high(c.low.x); ++x) visit(of_voxel[voxel(x, y, z)]);
  }

  static std::size_t voxel(int x, int y, int z) { return static_cast<std::size_t>(x + kVoxels * (y + kVoxels * z)); }
};

Cells marked_by_brute_force(const Case& c) {
  Cells cells(c.set.octree());
  for (Cell& cell : cells.all)
    for (std::uint32_t f = 0; f < c.soup.facets.size(); ++f)
      if ((c.active.empty() || c.active[f]) &&
          triangle_overlaps_cube(c.soup.corner(f, 0), c.soup.corner(f, 1), c.soup.corner(f, 2), to_vec(cell.low) + Vec3{1, 1, 1} * (0.5 * cell.side), 0.5 * cell.side))
        cell.mark = AcceptedMark::cut;
  // Cells that touch have finest cells that do.
  for (std::size_t i = 0; i < cells.all.size(); ++i)
    if (cells.all[i].mark == AcceptedMark::cut)
      cells.for_voxels(Cell(cells.all[i]), 1, [&](std::uint32_t other) { cells.all[other].mark = std::max(cells.all[other].mark, AcceptedMark::neighbor); });
  return cells;
}

TEST(AcceptedCells, AreThoseThatFacetsCutAndTheirNeighborsAcrossLevels) {
  int several_levels = 0;
  double farthest_uniform = 0, farthest = 0;
  for (unsigned seed = 1; seed <= 24; ++seed) {
    SCOPED_TRACE(seed);
    const Case c = random_case(seed);
    const Octree& tree = c.set.octree();
    const AcceptedCells accepted = accepted_cells(c.soup, c.set, c.active);
    Cells cells = marked_by_brute_force(c);
    std::uint64_t cut = 0, marked = 0;
    std::vector<char> levels(kDepth + 1);
    for (const Cell& cell : cells.all) {
      ASSERT_EQ(accepted.cells.block(cell.leaf)[cell.place], static_cast<std::uint8_t>(cell.mark)) << "leaf " << cell.leaf << ", cell " << cell.place;
      cut += cell.mark == AcceptedMark::cut;
      marked += cell.mark != AcceptedMark::none;
      if (cell.mark != AcceptedMark::none) levels[static_cast<std::size_t>(tree.level(cell.leaf))] = 1;
    }
    EXPECT_EQ(accepted.cells_cut, cut);
    EXPECT_EQ(accepted.cells_accepted, marked);
    const bool jumps = std::count(levels.begin(), levels.end(), 1) > 1;
    several_levels += jumps;

    std::uint64_t nodes = 0;
    for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) {
      std::array<double, kBlockNodes> squared;
      std::array<std::uint32_t, kBlockNodes> nearest;
      std::vector<std::uint32_t> facets;
      for (std::uint32_t f = 0; f < c.soup.facets.size(); ++f)
        if (c.active.empty() || c.active[f]) facets.push_back(f);
      bool has_one_level = true;
      for (int dir = 0; dir < kDirections; ++dir) has_one_level &= dir == kSelf || tree.neighbor_kind(leaf, dir) == NeighborKind::same;
      squared_distances_to(c.soup, facets, tree, leaf, squared.data(), nearest.data());
      for (int n = 0; n < static_cast<int>(kBlockNodes); ++n) {
        const LatticeNode node = lattice_node(tree, leaf, n % 8, n / 8 % 8, n / 64);
        bool held = false;
        cells.for_voxels({leaf, 0, node, 0}, 1, [&](std::uint32_t cell) { held |= cells.all[cell].mark != AcceptedMark::none; });
        ASSERT_EQ(accepted.nodes.block(leaf)[n] != 0, held) << "leaf " << leaf << ", node " << n;
        nodes += held;
        const double distance = facets.empty() ? 1e9 : std::sqrt(squared[static_cast<std::size_t>(n)]), cell = std::ldexp(1.0, tree.level(leaf));
        if (has_one_level) {
          ASSERT_TRUE(held || distance >= 2 * cell) << distance;
        }
        if (!held) continue;
        ASSERT_NEAR(c.set.phi.block(leaf)[n], distance, 1e-6) << "leaf " << leaf << ", node " << n;
        ASSERT_LE(distance / cell, accepted_band(true));
        (jumps ? farthest : farthest_uniform) = std::max(jumps ? farthest : farthest_uniform, distance / cell);
      }
    }
    EXPECT_EQ(accepted.nodes_accepted, nodes);
  }
  EXPECT_GE(several_levels, 5) << "the test takes level jumps at facets";
  EXPECT_LE(farthest_uniform, accepted_band(false) + 1e-12);
  EXPECT_GT(farthest_uniform, 3) << "a ring of cells is not enough, nor is a band of three";
  RecordProperty("farthest_node_in_cells", std::to_string(farthest_uniform) + ", across levels " + std::to_string(farthest));
}

// The thesis' sphere, in blocks: every cell that is counted as cut, distances that are exact, and the number of ACCEPTED cells that a shell has.
TEST(AcceptedCells, OfTheThesisSphere) {
  const TriangleSoup sphere = make_example(ExampleShape::sphere, {}).dirty;
  const Box3 box = bounding_box(sphere);
  const double cell = box.longest_side() / 80;
  const GridFrame frame = make_frame(box, cell, 14);
  const LevelSetFromTriangles built = level_set_from_triangles(sphere, frame, {.band = accepted_band(false), .far_field = false});
  const LevelSet& set = built.level_set;
  const TriangleSoup lattice = to_lattice(sphere, frame);
  const AcceptedCells accepted = accepted_cells(lattice, set);
  std::uint64_t cut = 0;
  for (const LevelCount& level : count_cells(lattice, set.grid, kBlockSide)) cut += level.cells_cut;
  EXPECT_EQ(accepted.cells_cut, cut);
  // Cubes of side 1 that a plane with unit normal n cuts: |n_x| + |n_y| + |n_z| a unit of area, 3/2 on average over a sphere, one and a half cells. Three
  // of side 1 about them: 3 (|n_x| + |n_y| + |n_z|) - 2 at least, with the same average of cubes in columns.
  const double area = burnish::area(lattice);
  EXPECT_NEAR(static_cast<double>(accepted.cells_cut) / area, 1.5, 0.05);
  EXPECT_GT(static_cast<double>(accepted.cells_accepted) / area, 3.5);
  EXPECT_LT(static_cast<double>(accepted.cells_accepted) / area, 4.7);
  RecordProperty("cells_cut", static_cast<int>(accepted.cells_cut));
  RecordProperty("cells_accepted", static_cast<int>(accepted.cells_accepted));
  double largest = 0;
  for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf)
    for (std::size_t n = 0; n < kBlockNodes; ++n)
      if (accepted.nodes.block(leaf)[n]) largest = std::max(largest, static_cast<double>(std::abs(set.phi.block(leaf)[n])));
  EXPECT_LE(largest, accepted_band(false));
  RecordProperty("farthest_node", std::to_string(largest));
}

TEST(AcceptedCells, AreTheSameForAnyNumberOfThreads) {
  const Case c = random_case(5);
  AcceptedCells one, four;
  {
    const ThreadLimit limit(1);
    one = accepted_cells(c.soup, c.set, c.active);
  }
  {
    const ThreadLimit limit(4);
    four = accepted_cells(c.soup, c.set, c.active);
  }
  EXPECT_TRUE(std::equal(one.cells.values().begin(), one.cells.values().end(), four.cells.values().begin()));
  EXPECT_TRUE(std::equal(one.nodes.values().begin(), one.nodes.values().end(), four.nodes.values().begin()));
}

TEST(NodesWithinBand, AreExactAndMoreThanTheAccepted) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    const Case c = random_case(seed);
    const Field<std::uint8_t> within = nodes_within_band(c.set);
    const AcceptedCells accepted = accepted_cells(c.soup, c.set, c.active);
    for (std::size_t leaf = 0; leaf < c.set.octree().size(); ++leaf)
      for (std::size_t n = 0; n < kBlockNodes; ++n) EXPECT_LE(accepted.nodes.block(leaf)[n], within.block(leaf)[n]);
  }
}

}  // namespace
}  // namespace burnish
