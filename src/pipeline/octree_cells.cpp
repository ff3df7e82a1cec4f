#include "octree_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/levelset/curvature.h"
#include "field_nodes.h"

namespace burnish {
namespace {

constexpr int kBlockLevels = 3;  // a block has 2^3 cells a side

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kAtSurface = 1;               // cells: from here curvatures are looked for
constexpr std::size_t kCurvedLeaves = 1 << 13;  // at once
constexpr double kCertain = 255;

LatticeNode node_of(const LatticePoint& p) { return {p[0], p[1], p[2]}; }

// The mean of the corners of a leaf's cell.
double mean_of_corners(const Octree& tree, const Field<float>& phi, std::size_t leaf, int i, int j, int k) {
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int x = i + (corner & 1), y = j + (corner >> 1 & 1), z = k + (corner >> 2 & 1);
    const bool is_own = std::max({x, y, z}) < kBlockSide;
    sum += is_own ? static_cast<double>(phi.block(leaf)[node_index(x, y, z)]) : node_value(tree, phi, lattice_node(tree, leaf, x, y, z));
  }
  return sum / 8;
}

// Cells of a leaf beside the surface, and their centres.
void find_curved(const LevelSet& set, std::size_t leaf, std::vector<float*>& cells, std::vector<Vec3>& points, Field<float>& curvature) {
  const Octree& tree = set.octree();
  const double side = 1 << tree.level(leaf), half = 0.5 * side;
  for (int n = 0; n < static_cast<int>(kBlockNodes); ++n) {
    const int i = n % kBlockSide, j = n / kBlockSide % kBlockSide, k = n / kBlockSide / kBlockSide;
    if (std::abs(mean_of_corners(tree, set.phi, leaf, i, j, k)) > kAtSurface * side) continue;
    const LatticeNode at = lattice_node(tree, leaf, i, j, k);
    cells.push_back(curvature.block(leaf) + n);
    points.push_back(Vec3{static_cast<double>(at.x), static_cast<double>(at.y), static_cast<double>(at.z)} + Vec3{half, half, half});
  }
}

}  // namespace

Field<float> curvature_of_cells(const LevelSet& set, Progress& progress) {
  const std::size_t leaves = set.octree().size();
  Field<float> curvature(layout_of(leaves, [&](std::size_t leaf) { return set.grid.near_surface(leaf); }), static_cast<float>(kNoNumber), static_cast<float>(kNoNumber));
  for (std::size_t first = 0; first < leaves; first += kCurvedLeaves) {
    std::vector<float*> cells;
    std::vector<Vec3> points;
    for (std::size_t leaf = first; leaf < std::min(first + kCurvedLeaves, leaves); ++leaf)
      if (curvature.stores(leaf)) find_curved(set, leaf, cells, points, curvature);
    const std::vector<FrontCurvature> found = front_curvature(set, points, CurvatureOrder::second, progress);
    for (std::size_t c = 0; c < cells.size(); ++c)
      if (found[c].converged) *cells[c] = static_cast<float>(found[c].mean());
  }
  return curvature;
}

OctreeCells::OctreeCells(const BuiltLevelSet& built, const std::vector<std::uint32_t>& input_facet, FieldCells cells, CellChoice choice)
    : built_(built), tree_(built.level_set.octree()), input_facet_(input_facet), cells_(cells), choice_(std::move(choice)), first_(tree_.size() + 1, 0) {
  if (choice_.within)
    choose_within(*choice_.within);
  else
    count_all();
}

bool OctreeCells::is_cut(std::size_t leaf) const {
  return cells_ == FieldCells::cells || (cells_ == FieldCells::near && built_.level_set.grid.near_surface(leaf));
}

void OctreeCells::count_all() {
  for (std::size_t leaf = 0; leaf < tree_.size(); ++leaf) first_[leaf + 1] = first_[leaf] + (is_cut(leaf) ? kBlockNodes : 1);
}

void OctreeCells::choose_within(double distance) {
  std::vector<std::vector<std::uint16_t>> chosen(tree_.size());
  parallel_for(tree_.size(), [&](std::size_t leaf) {
    for (std::uint32_t place = 0; place < (is_cut(leaf) ? kBlockNodes : 1); ++place)
      if (std::abs(phi_at(cube_of(leaf, place), static_cast<std::uint32_t>(leaf))) <= distance) chosen[leaf].push_back(static_cast<std::uint16_t>(place));
  }, 16);
  for (std::size_t leaf = 0; leaf < tree_.size(); ++leaf) {
    first_[leaf + 1] = first_[leaf] + chosen[leaf].size();
    places_.insert(places_.end(), chosen[leaf].begin(), chosen[leaf].end());
  }
}

bool OctreeCells::wants(FieldArray array) const {
  return choice_.arrays.empty() || std::find(choice_.arrays.begin(), choice_.arrays.end(), array) != choice_.arrays.end();
}

double OctreeCells::told(double phi) const {
  if (choice_.clamp) phi = std::clamp(phi, -*choice_.clamp, *choice_.clamp);
  return built_.level_set.frame.cell * phi;
}

CellGrid OctreeCells::grid() const {
  const GridFrame& frame = built_.level_set.frame;
  CellGrid grid{frame.origin, frame.cell, frame.depth + kBlockLevels, count(), {}, {}, {}};
  grid.cubes = [this](std::size_t first, std::span<LatticeCube> cubes) { fill_cubes(first, cubes); };
  const auto cells = [&](FieldArray array, NumberType type, auto&& value) {
    if (!wants(array)) return;
    grid.cell_arrays.push_back({std::string(name(array)), type, [this, value](std::span<const LatticeCube> cubes, double* values) { fill(cubes, values, value); }});
  };
  using Leaf = std::uint32_t;
  cells(FieldArray::phi, NumberType::float32, [this](const LatticeCube& c, Leaf leaf) { return told(phi_at(c, leaf)); });
  cells(FieldArray::level, NumberType::uint8, [](const LatticeCube& c, Leaf) { return static_cast<double>(c.level); });
  cells(FieldArray::inside, NumberType::uint8, [this](const LatticeCube& c, Leaf leaf) { return phi_at(c, leaf) >= 0 ? 1.0 : 0.0; });
  cells(FieldArray::block, NumberType::int64, [](const LatticeCube&, Leaf leaf) { return leaf == Octree::kNone ? -1.0 : static_cast<double>(leaf); });
  if (!built_.nearest.empty()) cells(FieldArray::facet, NumberType::int64, [this](const LatticeCube& c, Leaf leaf) { return facet_of(c, leaf); });
  if (choice_.curvature != nullptr) cells(FieldArray::curvature, NumberType::float32, [this](const LatticeCube& c, Leaf leaf) { return curvature_at(c, leaf); });
  cells(FieldArray::sign_confidence, NumberType::float32, [this](const LatticeCube& c, Leaf leaf) { return confidence_at(c, leaf); });
  if (choice_.accepted != nullptr) cells(FieldArray::accepted, NumberType::uint8, [this](const LatticeCube& c, Leaf leaf) { return is_accepted(c, leaf); });
  if (choice_.at_points && wants(FieldArray::phi))
    grid.point_arrays.push_back({"phi", NumberType::float32, [this](std::span<const LatticePoint> points, double* values) {
                                   for (const LatticePoint& p : points) *values++ = told(node_value(tree_, built_.level_set.phi, node_of(p)));
                                 }});
  return grid;
}

void OctreeCells::fill_cubes(std::size_t first, std::span<LatticeCube> cubes) const {
  auto leaf = static_cast<std::size_t>(std::upper_bound(first_.begin(), first_.end(), first) - first_.begin()) - 1;
  for (std::size_t c = first; c < first + cubes.size(); ++c) {
    while (c >= first_[leaf + 1]) ++leaf;
    cubes[c - first] = cube_of(leaf, places_.empty() ? static_cast<std::uint32_t>(c - first_[leaf]) : places_[c]);
  }
}

LatticeCube OctreeCells::cube_of(std::size_t leaf, std::uint32_t place) const {
  const morton::Position p = morton::deinterleave(place);
  const LatticeNode n = lattice_node(tree_, leaf, static_cast<int>(p.x), static_cast<int>(p.y), static_cast<int>(p.z));
  return {{n.x, n.y, n.z}, tree_.level(leaf) + (is_cut(leaf) ? 0 : kBlockLevels)};
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
  return mean_of_corners(tree_, phi, leaf, i, j, k);
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
  const std::uint8_t* marks = choice_.accepted->block(leaf);
  if (cube.level > tree_.level(leaf)) return std::any_of(marks, marks + kBlockNodes, [](std::uint8_t m) { return m != 0; }) ? 1 : 0;
  return marks[place_of(cube, leaf)] != 0 ? 1 : 0;
}

// The level set's, in the model's units.
double OctreeCells::curvature_at(const LatticeCube& cube, std::uint32_t leaf) const {
  if (leaf == Octree::kNone || cube.level > tree_.level(leaf)) return kNoNumber;
  return static_cast<double>(choice_.curvature->block(leaf)[place_of(cube, leaf)]) / built_.level_set.frame.cell;
}

// Of a cell the least of its corners, of a block that of all its nodes.
double OctreeCells::confidence_at(const LatticeCube& cube, std::uint32_t leaf) const {
  if (built_.certainty.empty()) return 1;
  if (leaf == Octree::kNone) return kNoNumber;
  const std::uint8_t* own = built_.certainty.block(leaf);
  if (cube.level > tree_.level(leaf)) return *std::min_element(own, own + kBlockNodes) / kCertain;
  std::uint8_t least = own[place_of(cube, leaf)];
  for (int corner = 0; corner < 8; ++corner) {
    const auto at = [&](std::size_t a) { return cube.corner[a] + ((corner >> a & 1) << cube.level); };
    const StoredNode node = node_at_or_below(tree_, {at(0), at(1), at(2)}, leaf);
    if (node.leaf != Octree::kNone) least = std::min(least, built_.certainty.block(node.leaf)[node.node]);
  }
  return least / kCertain;
}

double OctreeCells::facet_of(const LatticeCube& cube, std::uint32_t leaf) const {
  if (leaf == Octree::kNone) return -1;
  const std::uint32_t f = built_.nearest.block(leaf)[place_of(cube, leaf)];
  return f == kNoFacet || input_facet_[f] == kNoFacet ? -1.0 : static_cast<double>(input_facet_[f]);
}

}  // namespace burnish
