#include "cell_lattice.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "numbering.h"

namespace burnish {
namespace {

using Cells = std::vector<std::uint64_t>;  // interleaved positions in units of some level

constexpr double kReach = 0.5;  // cells of the level set beyond the ball about a cell, within which it is one of the surface's
constexpr std::uint64_t kMostCells = std::uint64_t{1} << 31;

constexpr int kPackedBits = 21;
std::uint64_t packed(std::int64_t x, std::int64_t y, std::int64_t z) {
  return static_cast<std::uint64_t>(x) | static_cast<std::uint64_t>(y) << kPackedBits | static_cast<std::uint64_t>(z) << 2 * kPackedBits;
}
std::array<std::int64_t, 3> unpacked(std::uint64_t key) {
  constexpr std::uint64_t kMask = (std::uint64_t{1} << kPackedBits) - 1;
  return {static_cast<std::int64_t>(key & kMask), static_cast<std::int64_t>(key >> kPackedBits & kMask), static_cast<std::int64_t>(key >> 2 * kPackedBits)};
}

void sort_unique(Cells& cells) {
  parallel_sort(cells);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

// A cell that the surface may pass, and where the surface there faces.
struct SurfaceCell {
  std::uint64_t cell = 0;  // interleaved position in cells of some level
  Vec3 normal;             // of any length
};
bool before(const SurfaceCell& a, const SurfaceCell& b) { return a.cell < b.cell; }

// Appends those of a level, which are in the level set's leaves of that level, to those that come of smaller ones; all of them ascending.
void append_surface_cells(const LevelSet& set, int level, std::vector<SurfaceCell>& found) {
  constexpr int kHalf = kBlockSide / 2;
  const double reach = (std::numbers::sqrt3 + kReach) * static_cast<double>(1u << level);
  for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf) {
    if (set.octree().level(leaf) != level || !set.grid.near_surface(leaf)) continue;
    const float* phi = set.phi.block(leaf);
    const morton::Position block = morton::deinterleave(morton::interleave(set.octree().corner(leaf)) >> 3 * level);
    for (int k = 0; k < kHalf; ++k)
      for (int j = 0; j < kHalf; ++j)
        for (int i = 0; i < kHalf; ++i) {
          const auto value = [&](int x, int y, int z) { return phi[node_index(2 * i + x, 2 * j + y, 2 * k + z)]; };
          const float centre = value(1, 1, 1);
          if (std::abs(centre) > reach) continue;
          const auto at = [&](std::uint32_t c, int n) { return c * kHalf + static_cast<std::uint32_t>(n); };
          found.push_back({morton::interleave({at(block.x, i), at(block.y, j), at(block.z, k)}), {centre - value(0, 1, 1), centre - value(1, 0, 1), centre - value(1, 1, 0)}});
        }
  }
  std::sort(found.begin(), found.end(), before);
}

Vec3 unit(const Vec3& n) { return norm(n) > 0 ? n / norm(n) : n; }

// The octants of the next level that hold the cells, ascending, with their mean normals.
std::vector<SurfaceCell> octants_of(const std::vector<SurfaceCell>& cells) {
  std::vector<SurfaceCell> octants;
  for (const SurfaceCell& c : cells) {
    if (octants.empty() || octants.back().cell != c.cell >> 3) octants.push_back({c.cell >> 3, {}});
    octants.back().normal += unit(c.normal);
  }
  return octants;
}

// Octants of the next level around the cells, ascending; those about which the surface is flat go to `flat`, the cells of all others to `rest`. [T-HEX-10]
void sort_out_flat(const std::vector<SurfaceCell>& cells, std::uint32_t side, double cosine, std::vector<SurfaceCell>& flat, Cells& rest) {
  std::vector<std::size_t> first;  // of each octant's cells
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (i == 0 || cells[i].cell >> 3 != cells[i - 1].cell >> 3) first.push_back(i);
  const std::size_t octants = first.size();
  first.push_back(cells.size());
  std::vector<SurfaceCell> mean = octants_of(cells);
  for (SurfaceCell& m : mean) m.normal = unit(m.normal);
  const auto is_within = [&](std::size_t o, const Vec3& n) {
    for (std::size_t i = first[o]; i < first[o + 1]; ++i)
      if (dot(unit(cells[i].normal), n) < cosine) return false;
    return true;
  };
  std::vector<std::uint8_t> is_flat(octants);
  parallel_for(octants, [&](std::size_t o) {
    const morton::Position p = morton::deinterleave(mean[o].cell);
    bool same = true;
    for (int d = 0; d < kDirections && same; ++d) {
      const std::array<int, 3> by = offset_of(d);
      const morton::Position q{p.x + static_cast<std::uint32_t>(by[0]), p.y + static_cast<std::uint32_t>(by[1]), p.z + static_cast<std::uint32_t>(by[2])};
      if (q.x >= side || q.y >= side || q.z >= side) continue;
      const std::uint64_t key = morton::interleave(q);
      const auto found = std::lower_bound(mean.begin(), mean.end(), key, [](const SurfaceCell& c, std::uint64_t k) { return c.cell < k; });
      if (found != mean.end() && found->cell == key) same = is_within(static_cast<std::size_t>(found - mean.begin()), mean[o].normal);
    }
    is_flat[o] = same;
  });
  for (std::size_t o = 0; o < octants; ++o) {
    if (is_flat[o]) flat.push_back(mean[o]);
    else
      for (std::size_t i = first[o]; i < first[o + 1]; ++i) rest.push_back(cells[i].cell);
  }
}

// Appends the octants of the next level that hold a cell within `rows` of one of these.
void append_parents(const Cells& cells, int rows, std::uint32_t side, Cells& parents) {
  for (const std::uint64_t cell : cells) {
    const morton::Position p = morton::deinterleave(cell);
    const auto lower = [&](std::uint32_t x) { return (x > static_cast<std::uint32_t>(rows) ? x - static_cast<std::uint32_t>(rows) : 0u) / 2; };
    const auto upper = [&](std::uint32_t x) { return std::min(x + static_cast<std::uint32_t>(rows), side - 1) / 2; };
    for (std::uint32_t z = lower(p.z); z <= upper(p.z); ++z)
      for (std::uint32_t y = lower(p.y); y <= upper(p.y); ++y)
        for (std::uint32_t x = lower(p.x); x <= upper(p.x); ++x) parents.push_back(morton::interleave({x, y, z}));
  }
}

void require_countable(double cells) {
  if (cells > static_cast<double>(kMostCells)) throw Error(ErrorCode::memory_limit, "the mesh would have more than 2^31 cells", "choose a larger --cell, or larger cells in boxes");
}

// Appends the octants of a level that meet a box of the lattice.
void append_box(const LatticeBox& box, int level, Cells& octants, Progress& progress) {
  require_countable(8 * (static_cast<double>(octants.size()) + box.octants(level)));
  const auto first = [&](std::size_t a) { return static_cast<std::uint32_t>(box.lower[a] >> level); };
  const auto last = [&](std::size_t a) { return static_cast<std::uint32_t>((box.upper[a] - 1) >> level); };
  for (std::uint32_t z = first(2); z <= last(2); ++z)
    for (std::uint32_t y = first(1); y <= last(1); ++y) {
      progress.check();
      for (std::uint32_t x = first(0); x <= last(0); ++x) octants.push_back(morton::interleave({x, y, z}));
    }
}

struct Edge12 {
  int corner, axis;  // the lower end
};

// Edge e: along axis e / 4, from the corner with the other two bits e % 4.
constexpr Edge12 edge_of(int e) {
  const int axis = e / 4, low = e % 2, high = e / 2 % 2;
  const int first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2;
  return {low << first | high << second, axis};
}
constexpr int edge_between(int a, int b) {
  const int axis = (a ^ b) == 1 ? 0 : (a ^ b) == 2 ? 1 : 2, corner = a & b;
  const int first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2;
  return axis * 4 + (corner >> first & 1) + 2 * (corner >> second & 1);
}

// The direction from a cell across a face.
constexpr int face_direction(int face) {
  const int step = face % 2 == 0 ? -1 : 1, axis = face / 2;
  return direction(axis == 0 ? step : 0, axis == 1 ? step : 0, axis == 2 ? step : 0);
}

}  // namespace

CellLattice::CellLattice(const LevelSet& set, const FlowMeshOptions& options, std::span<const LatticeRefinement> refinements, int surface_level, const LatticeBox& region, Progress& progress) {
  choose_cells(set, options, refinements, surface_level, region, progress);
  progress.check();
  mark_existing(region);
  mark_splits();
  progress.check();
  number_nodes();
}

// [T-HEX-2]
void CellLattice::choose_cells(const LevelSet& set, const FlowMeshOptions& options, std::span<const LatticeRefinement> refinements, int surface_level, const LatticeBox& region, Progress& progress) {
  const int depth = set.frame.depth + 2;
  if (depth > morton::kMaxDepth) throw Error(ErrorCode::memory_limit, "the mesh would have more than 2^20 cells along a side", "choose a larger --cell, or larger cells in boxes");
  Cells keys, below;  // below: what has to be there at the level below
  std::vector<SurfaceCell> surface;
  append_surface_cells(set, 0, surface);
  for (int level = 1; level <= depth; ++level) {
    progress.check();
    const std::uint32_t side = 1u << (depth - level);
    std::vector<SurfaceCell> larger;
    if (level <= surface_level) {
      larger = octants_of(surface);
      append_surface_cells(set, level, larger);
    } else if (level <= surface_level + options.flat_levels) {
      sort_out_flat(surface, side, std::cos(options.flat_angle * std::numbers::pi / 180), larger, below);
      for (const SurfaceCell& c : larger) keys.push_back(morton::key(c.cell, level));
    } else {
      for (const SurfaceCell& c : surface) below.push_back(c.cell);
    }
    Cells divided;
    append_parents(below, options.cells_between_levels, 2 * side, divided);
    surface = std::move(larger);
    for (const LatticeRefinement& r : refinements)
      if (r.level + 1 == level) append_box(r.box, level, divided, progress);
    if (level == surface_level + options.coarsest_level + 1) append_box(region, level, divided, progress);
    sort_unique(divided);
    for (const std::uint64_t octant : divided) keys.push_back(morton::key(octant << 3, level - 1));
    require_countable(8 * static_cast<double>(keys.size()));
    below = std::move(divided);
  }
  tree_ = Octree::build_graded(depth, std::move(keys));
}

void CellLattice::mark_existing(const LatticeBox& region) {
  exists_.resize(tree_.size());
  parallel_for(tree_.size(), [&](std::size_t cell) {
    const morton::Position p = tree_.corner(cell);
    const std::array<std::int64_t, 3> at{p.x, p.y, p.z};
    bool within = true;
    for (std::size_t a = 0; a < 3; ++a) within = within && at[a] >= region.lower[a] && at[a] < region.upper[a];
    exists_[cell] = within;
  });
}

void CellLattice::number_nodes() {
  using Named = std::pair<std::uint64_t, std::uint64_t>;  // key, place
  std::vector<Named> named(tree_.size() * 8);
  parallel_for(tree_.size(), [&](std::size_t cell) {
    const morton::Position p = tree_.corner(cell);
    const std::int64_t side = std::int64_t{1} << tree_.level(cell);
    for (std::size_t c = 0; c < 8; ++c)
      named[cell * 8 + c] = {packed(p.x + (c & 1 ? side : 0), p.y + (c & 2 ? side : 0), p.z + (c & 4 ? side : 0)), cell * 8 + c};
  });
  parallel_sort(named);
  corners_.resize(named.size());
  for (const Named& n : named) {
    if (keys_.empty() || keys_.back() != n.first) keys_.push_back(n.first);
    corners_[n.second] = static_cast<std::uint32_t>(keys_.size() - 1);
  }
  require_nodes(keys_.size() + tree_.size());
}

void CellLattice::mark_splits() {
  split_edges_.assign(tree_.size(), 0);
  split_faces_.assign(tree_.size(), 0);
  const auto finer = [&](std::size_t cell, int dx, int dy, int dz) {
    const int d = direction(dx, dy, dz);
    return tree_.neighbor_kind(cell, d) == NeighborKind::finer && exists(tree_.neighbors(cell, d).front());
  };
  parallel_for(tree_.size(), [&](std::size_t cell) {
    if (tree_.level(cell) == 0 || !exists(cell)) return;
    for (int e = 0; e < 12; ++e) {
      const Edge12 edge = edge_of(e);
      std::array<int, 3> out{};
      for (int a = 0; a < 3; ++a) out[static_cast<std::size_t>(a)] = a == edge.axis ? 0 : (edge.corner >> a & 1) ? 1 : -1;
      const int first = edge.axis == 0 ? 1 : 0;
      std::array<int, 3> one{}, other = out;
      one[static_cast<std::size_t>(first)] = out[static_cast<std::size_t>(first)], other[static_cast<std::size_t>(first)] = 0;
      if (finer(cell, out[0], out[1], out[2]) || finer(cell, one[0], one[1], one[2]) || finer(cell, other[0], other[1], other[2]))
        split_edges_[cell] = static_cast<std::uint16_t>(split_edges_[cell] | 1u << e);
    }
    for (int f = 0; f < 6; ++f) {
      const std::array<int, 3> d = offset_of(face_direction(f));
      if (finer(cell, d[0], d[1], d[2])) split_faces_[cell] = static_cast<std::uint8_t>(split_faces_[cell] | 1u << f);
    }
  });
}

int CellLattice::level_at(const Vec3& p) const {
  const auto place = [&](double x) { return static_cast<std::uint32_t>(std::clamp(x / 2, 0.0, static_cast<double>(tree_.side() - 1))); };
  return tree_.level(tree_.find({place(p.x), place(p.y), place(p.z)}));
}

std::uint32_t CellLattice::find(std::uint64_t key) const {
  return static_cast<std::uint32_t>(std::lower_bound(keys_.begin(), keys_.end(), key) - keys_.begin());
}

std::array<std::int64_t, 3> CellLattice::position(std::uint32_t node) const {
  if (!is_centre(node)) {
    const std::array<std::int64_t, 3> p = unpacked(keys_[node]);
    return {2 * p[0], 2 * p[1], 2 * p[2]};
  }
  const std::size_t cell = node - keys_.size();
  const morton::Position p = tree_.corner(cell);
  const std::int64_t half = std::int64_t{1} << tree_.level(cell);
  return {2 * std::int64_t{p.x} + half, 2 * std::int64_t{p.y} + half, 2 * std::int64_t{p.z} + half};
}

FacePolygon CellLattice::polygon(std::size_t cell, int face) const {
  FacePolygon result;
  const std::array<int, 4>& corners = kFaceCorners[static_cast<std::size_t>(face)];
  for (std::size_t i = 0; i < 4; ++i) {
    const int a = corners[i], b = corners[(i + 1) % 4];
    result.node[static_cast<std::size_t>(result.size++)] = corner(cell, a);
    if (!(split_edges_[cell] >> edge_between(a, b) & 1)) continue;
    const std::array<std::int64_t, 3> p = unpacked(keys_[corner(cell, a)]), q = unpacked(keys_[corner(cell, b)]);
    result.node[static_cast<std::size_t>(result.size++)] = find(packed((p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2));
  }
  return result;
}

std::uint32_t CellLattice::across(std::size_t cell, int face) const {
  const int d = face_direction(face);
  const NeighborKind kind = tree_.neighbor_kind(cell, d);
  if (kind != NeighborKind::same && kind != NeighborKind::coarser) return Octree::kNone;
  const std::uint32_t other = tree_.neighbor(cell, d);
  return exists(other) ? other : Octree::kNone;
}

std::span<const std::uint32_t> CellLattice::finer_across(std::size_t cell, int face) const { return tree_.neighbors(cell, face_direction(face)); }

bool CellLattice::owns(std::size_t cell, int face) const {
  if (is_split(cell, face)) return false;
  const std::uint32_t other = across(cell, face);
  return other == Octree::kNone || tree_.level(other) > tree_.level(cell) || face % 2 == 1;
}

}  // namespace burnish
