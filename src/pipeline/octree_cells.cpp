#include "octree_cells.h"

#include <algorithm>
#include <array>

#include "burnish/core/parallel.h"

namespace burnish {
namespace {

constexpr int kBlockLevels = 3;  // a block has 2^3 cells a side

bool is_cut(const SurfaceOctree& grid, std::size_t leaf, FieldCells cells) {
  return cells == FieldCells::cells || (cells == FieldCells::near && grid.near_surface(leaf));
}

LatticeNode node_of(const LatticePoint& p) { return {p[0], p[1], p[2]}; }

}  // namespace

OctreeCells::OctreeCells(const BuiltLevelSet& built, const std::vector<std::uint32_t>& input_facet, FieldCells cells, const Field<std::uint8_t>* accepted)
    : built_(built), tree_(built.level_set.octree()), input_facet_(input_facet), accepted_(accepted), first_(tree_.size() + 1, 0) {
  for (std::size_t leaf = 0; leaf < tree_.size(); ++leaf)
    first_[leaf + 1] = first_[leaf] + (is_cut(built.level_set.grid, leaf, cells) ? kBlockNodes : 1);
}

CellGrid OctreeCells::grid() const {
  const GridFrame& frame = built_.level_set.frame;
  CellGrid grid{frame.origin, frame.cell, frame.depth + kBlockLevels, count(), {}, {}, {}};
  grid.cubes = [this](std::size_t first, std::span<LatticeCube> cubes) { fill_cubes(first, cubes); };
  const auto cells = [&](const char* name, NumberType type, auto&& value) {
    grid.cell_arrays.push_back({name, type, [this, value](std::span<const LatticeCube> cubes, double* values) { fill(cubes, values, value); }});
  };
  const double h = frame.cell;
  cells("phi", NumberType::float32, [this, h](const LatticeCube& c, std::uint32_t leaf) { return h * phi_at(c, leaf); });
  cells("level", NumberType::uint8, [](const LatticeCube& c, std::uint32_t) { return static_cast<double>(c.level); });
  cells("inside", NumberType::uint8, [this](const LatticeCube& c, std::uint32_t leaf) { return phi_at(c, leaf) >= 0 ? 1.0 : 0.0; });
  cells("block", NumberType::int64, [](const LatticeCube&, std::uint32_t leaf) { return leaf == Octree::kNone ? -1.0 : static_cast<double>(leaf); });
  if (!built_.nearest.empty())
    cells("facet", NumberType::int64, [this](const LatticeCube& c, std::uint32_t leaf) { return facet_of(c, leaf); });
  if (accepted_ != nullptr)
    cells("accepted", NumberType::uint8, [this](const LatticeCube& c, std::uint32_t leaf) { return is_accepted(c, leaf); });
  grid.point_arrays.push_back({"phi", NumberType::float32, [this, h](std::span<const LatticePoint> points, double* values) {
                                 for (const LatticePoint& p : points) *values++ = h * node_value(tree_, built_.level_set.phi, node_of(p));
                               }});
  return grid;
}

void OctreeCells::fill_cubes(std::size_t first, std::span<LatticeCube> cubes) const {
  auto leaf = static_cast<std::size_t>(std::upper_bound(first_.begin(), first_.end(), first) - first_.begin()) - 1;
  for (std::size_t c = first; c < first + cubes.size(); ++c) {
    while (c >= first_[leaf + 1]) ++leaf;
    const int level = tree_.level(leaf);
    const bool is_block = first_[leaf + 1] - first_[leaf] == 1;
    const morton::Position p = morton::deinterleave(is_block ? 0 : c - first_[leaf]);
    const LatticeNode n = lattice_node(tree_, leaf, static_cast<int>(p.x), static_cast<int>(p.y), static_cast<int>(p.z));
    cubes[c - first] = {{n.x, n.y, n.z}, is_block ? level + kBlockLevels : level};
  }
}

template <class Value>
void OctreeCells::fill(std::span<const LatticeCube> cubes, double* values, Value&& value) const {
  std::uint32_t leaf = Octree::kNone;
  morton::Position last;
  for (const LatticeCube& cube : cubes) {
    const auto block = [&](std::size_t a) { return static_cast<std::uint32_t>(cube.corner[a]) / kBlockSide; };
    const morton::Position at{block(0), block(1), block(2)};
    if (leaf == Octree::kNone || !(at == last)) leaf = tree_.find(at);
    last = at;
    *values++ = value(cube, cube.level > tree_.level(leaf) + kBlockLevels ? Octree::kNone : leaf);
  }
}

// At the centre: a node of the block, or of one that it holds, unless the cube is one of the block's cells.
double OctreeCells::phi_at(const LatticeCube& cube, std::uint32_t leaf) const {
  const Field<float>& phi = built_.level_set.phi;
  const std::int32_t half = (1 << cube.level) / 2;
  if (leaf == Octree::kNone || cube.level > tree_.level(leaf))
    return node_value(tree_, phi, {cube.corner[0] + half, cube.corner[1] + half, cube.corner[2] + half});
  const LatticeNode first = lattice_node(tree_, leaf, 0, 0, 0);
  const int i = (cube.corner[0] - first.x) >> cube.level, j = (cube.corner[1] - first.y) >> cube.level, k = (cube.corner[2] - first.z) >> cube.level;
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int x = i + (corner & 1), y = j + (corner >> 1 & 1), z = k + (corner >> 2 & 1);
    const bool is_own = std::max({x, y, z}) < kBlockSide;
    sum += is_own ? static_cast<double>(phi.block(leaf)[node_index(x, y, z)]) : node_value(tree_, phi, lattice_node(tree_, leaf, x, y, z));
  }
  return sum / 8;
}

// The block's middle stands for a whole block, the lower corner for a cell.
std::size_t OctreeCells::place_of(const LatticeCube& cube, std::uint32_t leaf) const {
  const LatticeNode corner = lattice_node(tree_, leaf, 0, 0, 0);
  const int level = tree_.level(leaf), shift = cube.level > level ? 1 << (cube.level - 1) : 0;
  const auto step = [&](std::size_t a, std::int32_t from) { return (cube.corner[a] + shift - from) >> level; };
  return node_index(step(0, corner.x), step(1, corner.y), step(2, corner.z));
}

// Of a whole block: whether some cell of it is.
double OctreeCells::is_accepted(const LatticeCube& cube, std::uint32_t leaf) const {
  if (leaf == Octree::kNone) return 0;
  const std::uint8_t* marks = accepted_->block(leaf);
  if (cube.level > tree_.level(leaf)) return std::any_of(marks, marks + kBlockNodes, [](std::uint8_t m) { return m != 0; }) ? 1 : 0;
  return marks[place_of(cube, leaf)] != 0 ? 1 : 0;
}

double OctreeCells::facet_of(const LatticeCube& cube, std::uint32_t leaf) const {
  if (leaf == Octree::kNone) return -1;
  const std::uint32_t f = built_.nearest.block(leaf)[place_of(cube, leaf)];
  return f == kNoFacet || input_facet_[f] == kNoFacet ? -1.0 : static_cast<double>(input_facet_[f]);
}

}  // namespace burnish
