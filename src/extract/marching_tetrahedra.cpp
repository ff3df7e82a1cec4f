#include "burnish/extract/marching_tetrahedra.h"

#include <algorithm>
#include <array>
#include <bit>
#include <memory>
#include <utility>

#include "../levelset/leaf_sides.h"
#include "burnish/core/parallel.h"
#include "burnish/surface/weld.h"
#include "lattice_view.h"
#include "snap.h"
#include "tetrahedra.h"
#include "transition_cells.h"

namespace burnish {
namespace {

using namespace detail;

constexpr std::uint32_t kNoSlot = 0xffffffffu;
constexpr std::size_t kLeafGrain = 16;

LocalNode local_node(std::size_t n) {
  const int i = static_cast<int>(n);
  return {i % kBlockSide, i / kBlockSide % kBlockSide, i / kBlockSide / kBlockSide};
}

LocalNode corner_of(LocalNode cell, int corner) {
  return cell + Step{corner & 1, corner >> 1 & 1, corner >> 2 & 1};
}

// Without an instruction for it on every processor.
unsigned count_bits(std::uint8_t bits) {
  static constexpr auto kCounts = [] {
    std::array<std::uint8_t, 256> counts{};
    for (std::size_t i = 1; i < counts.size(); ++i) counts[i] = static_cast<std::uint8_t>(counts[i / 2] + i % 2);
    return counts;
  }();
  return kCounts[bits];
}

template <class T>
class Extractor {
 public:
  Extractor(const BasicLevelSet<T>& level_set, const ExtractOptions& options, Progress& progress)
      : set_(level_set), tree_(level_set.octree()), options_(options), progress_(progress), sides_(tree_, set_.phi) {}

  ExtractedSurface run() {
    find_cut_leaves();
    if (options_.snap) {
      move_nodes();
      add_leaves_of_moved_nodes();
    }
    make_vertices();
    cut_cells();
    return std::move(result_);
  }

 private:
  void load(std::size_t leaf, LatticeView& view) const {
    copy_same_level(tree_, set_.phi, leaf, 0.0, view.phi.data());
    copy_same_level(tree_, moves_, leaf, kStays, view.move.data());
    copy_same_level(tree_, marked_plain(), leaf, std::uint8_t{0}, view.plain.data());
  }
  const Field<std::uint8_t>& marked_plain() const {
    static const Field<std::uint8_t> none;
    return options_.plain ? options_.plain->marked : none;
  }

  // Calls visit(node) for the bits that are set in rows(y, z), in order.
  template <class Rows, class Visit>
  static void for_set_bits(Rows&& rows, Visit&& visit) {
    for (int z = 0; z < kBlockSide; ++z)
      for (int y = 0; y < kBlockSide; ++y)
        for (unsigned bits = rows(y, z); bits != 0; bits &= bits - 1) visit(node_index(std::countr_zero(bits), y, z));
  }

  // Runs body(leaf, view) for the listed leaves in parallel, with a view per chunk.
  template <class Body>
  void for_leaves(const std::vector<std::uint32_t>& leaves, Body&& body) {
    parallel_ranges(leaves.size(), kLeafGrain, [&](std::size_t begin, std::size_t end) {
      progress_.check();
      const auto view = std::make_unique<LatticeView>();
      for (std::size_t i = begin; i < end; ++i) {
        load(leaves[i], *view);
        body(i, leaves[i], *view);
      }
    });
  }

  // Leaves with cells that the surface may cut, and the leaves that own these cells' upper nodes.
  void find_cut_leaves() {
    std::vector<char> cut(tree_.size(), 0);
    parallel_for(tree_.size(), [&](std::size_t leaf) { cut[leaf] = sides_.around(leaf, kUpper) == 3; }, 256);
    std::vector<char> owns = cut;
    for (std::uint32_t leaf = 0; leaf < tree_.size(); ++leaf) {
      if (!cut[leaf]) continue;
      cut_leaves_.push_back(leaf);
      for (int corner = 1; corner < 8; ++corner) {
        const int dir = direction(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
        if (tree_.neighbor_kind(leaf, dir) == NeighborKind::same) owns[tree_.neighbor(leaf, dir)] = 1;
      }
    }
    slot_.assign(tree_.size(), kNoSlot);
    for (std::uint32_t leaf = 0; leaf < tree_.size(); ++leaf)
      if (owns[leaf]) {
        slot_[leaf] = static_cast<std::uint32_t>(owners_.size());
        owners_.push_back(leaf);
      }
  }

  // Moves nodes to near crossings, then takes back what breaks the lattice until nothing does.
  void move_nodes() {
    Field<Move> wanted = Field<Move>::like(set_.phi, kStays, kStays);
    for_leaves(owners_, [&](std::size_t, std::uint32_t leaf, const LatticeView& view) {
      if (!wanted.stores(leaf)) return;  // far from the surface
      const SideRows rows(view, sides_.same(leaf));
      for_set_bits([&](int y, int z) { return rows.beside_surface(y, z); },
                   [&](std::size_t n) {
                     // Transition cells know nothing of moved nodes.
                     if (sides_.is_plain_node(leaf, n)) wanted.block(leaf)[n] = best_move(view, local_node(n));
                   });
    });
    moves_ = std::move(wanted);
    std::vector<std::uint32_t> check = owners_;
    while (!check.empty()) {
      std::vector<std::vector<std::uint16_t>> undone(check.size());
      for_leaves(check, [&](std::size_t i, std::uint32_t leaf, const LatticeView& view) {
        for (std::size_t n = 0; n < kBlockNodes; ++n)
          if (moves_.block(leaf)[n] != kStays && must_stay(view, local_node(n)))
            undone[i].push_back(static_cast<std::uint16_t>(n));
      });
      std::vector<char> again(tree_.size(), 0);
      for (std::size_t i = 0; i < check.size(); ++i) {
        if (undone[i].empty()) continue;
        for (const std::uint16_t n : undone[i]) moves_.block(check[i])[n] = kStays;
        for (int dir = 0; dir < kDirections; ++dir)
          if (tree_.neighbor_kind(check[i], dir) == NeighborKind::same) again[tree_.neighbor(check[i], dir)] = 1;
      }
      check.clear();
      for (const std::uint32_t leaf : owners_)
        if (again[leaf]) check.push_back(leaf);
    }
  }

  // A moved node can put a facet on a face of a cell that no edge crossing cuts: all leaves around it take part.
  void add_leaves_of_moved_nodes() {
    std::vector<char> cut(tree_.size(), 0);
    for (const std::uint32_t leaf : cut_leaves_) cut[leaf] = 1;
    std::vector<std::uint32_t> touched(owners_.size(), 0);
    parallel_for(owners_.size(), [&](std::size_t i) {
      const Move* moves = moves_.block(owners_[i]);
      for (std::size_t n = 0; n < kBlockNodes; ++n)
        if (moves[n] != kStays) touched[i] |= kTouched.by_cell[n];
    }, kLeafGrain);
    for (std::size_t i = 0; i < owners_.size(); ++i)
      for (int dir = 0; dir < kDirections; ++dir)
        if (touched[i] >> dir & 1) cut[tree_.neighbor(owners_[i], dir)] = 1;
    cut_leaves_.clear();
    for (std::uint32_t leaf = 0; leaf < tree_.size(); ++leaf)
      if (cut[leaf]) cut_leaves_.push_back(leaf);
  }

  // Which vertices each owner's nodes have: a bit per edge upwards that the surface crosses, bit 7 for a moved node.
  std::uint16_t number_vertices(std::size_t slot, const LatticeView& view) {
    std::uint8_t* masks = masks_.data() + slot * kBlockNodes;
    for (std::size_t d = 0; d < kEdgeSteps.size(); ++d)
      for_set_bits([&](int y, int z) { return rows_[slot].crossed(y, z, kEdgeSteps[d]); },
                   [&](std::size_t n) { masks[n] |= static_cast<std::uint8_t>(1u << d); });
    std::uint16_t rank = 0;
    for (std::size_t n = 0; n < kBlockNodes; ++n) {
      if (view.side(local_node(n)) == kOn) masks[n] |= 0x80;
      ranks_[slot * kBlockNodes + n] = rank;
      rank = static_cast<std::uint16_t>(rank + count_bits(masks[n]));
    }
    return rank;
  }

  // Lattice coordinates of a vertex. Crossings are placed from the lower node's integers, with the same rounding from
  // every leaf and in transition cells.
  Vec3 vertex_position(std::size_t leaf, const LatticeView& view, LocalNode n, std::uint8_t d) const {
    const double size = static_cast<double>(1 << tree_.level(leaf));
    const LatticeNode low = lattice_node(tree_, leaf, n.x, n.y, n.z);
    const Vec3 base{static_cast<double>(low.x), static_cast<double>(low.y), static_cast<double>(low.z)};
    if (d == 7) return base + (view.position(n) - Vec3{n.x + 0.0, n.y + 0.0, n.z + 0.0}) * size;
    const Step s = kEdgeSteps[d];
    const double t = view.kept_crossing(n, d);
    return {base.x + t * (s.x * size), base.y + t * (s.y * size), base.z + t * (s.z * size)};
  }

  void place_vertices(std::size_t slot, std::uint32_t leaf, const LatticeView& view, std::vector<Vec3>& points) {
    for (std::size_t n = 0; n < kBlockNodes; ++n) {
      const std::uint8_t mask = masks_[slot * kBlockNodes + n];
      for (std::uint8_t d = 0; mask >> d != 0; ++d)
        if (mask >> d & 1) points.push_back(vertex_position(leaf, view, local_node(n), d));
    }
  }

  void make_vertices() {
    masks_.assign(owners_.size() * kBlockNodes, 0);
    ranks_.resize(owners_.size() * kBlockNodes);
    rows_.resize(owners_.size());
    first_.assign(owners_.size() + 1, 0);
    std::vector<std::vector<Vec3>> points(owners_.size());
    for_leaves(owners_, [&](std::size_t slot, std::uint32_t leaf, const LatticeView& view) {
      rows_[slot] = SideRows(view, sides_.same(leaf));
      first_[slot] = number_vertices(slot, view);
      points[slot].reserve(first_[slot]);
      place_vertices(slot, leaf, view, points[slot]);
    });
    exclusive_scan_in_place(first_);
    result_.soup.points.resize(first_.back());
    result_.origins.resize(first_.back());
    parallel_for(owners_.size(), [&](std::size_t slot) {
      std::copy(points[slot].begin(), points[slot].end(), result_.soup.points.begin() + static_cast<std::ptrdiff_t>(first_[slot]));
      VertexOrigin* origin = result_.origins.data() + first_[slot];
      for (std::uint16_t n = 0; n < kBlockNodes; ++n)
        for (std::uint8_t d = 0, mask = masks_[slot * kBlockNodes + n]; mask >> d != 0; ++d)
          if (mask >> d & 1) *origin++ = {owners_[slot], n, d};
    }, kLeafGrain);
  }

  // The number of the vertex on edge `d` (7: the moved node itself) from node n, 0..8 along each axis.
  std::uint32_t vertex_number(std::size_t leaf, LocalNode n, int d) const {
    const auto over = [](int i) { return i == kBlockSide ? 1 : 0; };
    const int dir = direction(over(n.x), over(n.y), over(n.z));
    const std::size_t slot = slot_[tree_.neighbor(leaf, dir)];
    const std::size_t at = slot * kBlockNodes + node_index(n.x % kBlockSide, n.y % kBlockSide, n.z % kBlockSide);
    const unsigned below = masks_[at] & ((1u << d) - 1);
    return static_cast<std::uint32_t>(first_[slot] + ranks_[at] + count_bits(static_cast<std::uint8_t>(below)));
  }

  void cut_cell(std::size_t leaf, const SideRows& rows, LocalNode cell, std::vector<Facet>& out) const {
    for (const KuhnTetrahedron& t : kKuhn) {
      std::array<Side, 4> side{};
      for (std::size_t i = 0; i < 4; ++i) side[i] = rows.side(corner_of(cell, t.corners[i]));
      const auto vertex = [&](int i, int j) {
        int a = t.corners[static_cast<std::size_t>(i)], b = t.corners[static_cast<std::size_t>(j)];
        if (side[static_cast<std::size_t>(i)] == kOn) return vertex_number(leaf, corner_of(cell, a), 7);
        if (side[static_cast<std::size_t>(j)] == kOn) return vertex_number(leaf, corner_of(cell, b), 7);
        if (a > b) std::swap(a, b);
        return vertex_number(leaf, corner_of(cell, a), edge_number(a, b));
      };
      const auto opposite_out = [&](int i) {
        return rows.side(across_face(cell, t, t.corners[static_cast<std::size_t>(i)])) == kOut;
      };
      const auto shorter = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r, std::uint32_t s) {
        const auto& x = result_.soup.points;
        return squared_norm(x[p] - x[r]) <= squared_norm(x[q] - x[s]);
      };
      cut_tetrahedron(side, vertex, opposite_out, shorter,
                      [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) { out.push_back({a, b, c}); });
    }
  }

  // The apex of the tetrahedron on the other side of the face opposite to `corner`.
  static LocalNode across_face(LocalNode cell, const KuhnTetrahedron& t, int corner) {
    std::array<LocalNode, 4> v{};
    std::size_t m = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      v[i] = corner_of(cell, t.path[i]);
      if (t.path[i] == corner) m = i;
    }
    const auto combine = [](LocalNode a, LocalNode plus, LocalNode less) {
      return LocalNode{a.x + plus.x - less.x, a.y + plus.y - less.y, a.z + plus.z - less.z};
    };
    switch (m) {
      case 0: return combine(v[3], v[1], v[0]);
      case 1: return combine(v[0], v[2], v[1]);
      case 2: return combine(v[1], v[3], v[2]);
      default: return combine(v[0], v[2], v[3]);
    }
  }

  // Cells of a leaf with hanging nodes, or beside them, that the surface may cut: the leaves that hold its nodes are on both sides.
  void find_transition_cells(std::uint32_t leaf, std::vector<std::uint16_t>& cells) const {
    for (std::size_t n = 0; n < kBlockNodes; ++n)
      if (!sides_.is_plain_cell(leaf, n) && sides_.around(leaf, kTouched.by_cell[n] & kUpper) == 3) cells.push_back(static_cast<std::uint16_t>(n));
  }

  SideRows rows_of(std::uint32_t leaf) const {
    if (slot_[leaf] != kNoSlot) return rows_[slot_[leaf]];
    const auto view = std::make_unique<LatticeView>();
    load(leaf, *view);
    return {*view, sides_.same(leaf)};
  }

  void cut_cells() {
    std::vector<std::vector<Facet>> facets(cut_leaves_.size());
    std::vector<std::vector<std::uint16_t>> transition(cut_leaves_.size());
    parallel_for(cut_leaves_.size(), [&](std::size_t i) {
      const std::uint32_t leaf = cut_leaves_[i];
      facets[i].reserve(kUsualFacets);
      const SideRows rows = rows_of(leaf);
      for_set_bits([&](int y, int z) { return rows.cut_cells(y, z); },
                   [&](std::size_t n) {
                     if (sides_.is_plain_cell(leaf, n)) cut_cell(leaf, rows, local_node(n), facets[i]);
                   });
      if (sides_.same(leaf) != kAllSame) find_transition_cells(leaf, transition[i]);
    }, kLeafGrain);
    join_facets(facets);
    cut_transition_cells(transition);
  }

  void join_facets(const std::vector<std::vector<Facet>>& facets) {
    std::vector<std::size_t> first(facets.size());
    for (std::size_t i = 0; i < facets.size(); ++i) first[i] = facets[i].size();
    result_.soup.facets.resize(exclusive_scan_in_place(first));
    parallel_for(facets.size(), [&](std::size_t i) {
      std::copy(facets[i].begin(), facets[i].end(), result_.soup.facets.begin() + static_cast<std::ptrdiff_t>(first[i]));
    }, kLeafGrain);
  }

  void cut_transition_cells(const std::vector<std::vector<std::uint16_t>>& cells) {
    std::vector<TriangleSoup> parts(cells.size());
    std::vector<std::vector<VertexOrigin>> origins(cells.size());
    std::vector<std::size_t> counts(cells.size(), 0);
    parallel_for(cells.size(), [&](std::size_t i) {
      const std::uint32_t leaf = cut_leaves_[i];
      for (const std::uint16_t n : cells[i]) {
        const LocalNode cell = local_node(n);
        cut_transition_cell(tree_, set_.phi, marked_plain(), leaf, lattice_node(tree_, leaf, cell.x, cell.y, cell.z), parts[i]);
        counts[i] += parts[i].points.size() > origins[i].size();
        origins[i].resize(parts[i].points.size(), {leaf, n, 7});
      }
    }, kLeafGrain);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const auto first = static_cast<std::uint32_t>(result_.soup.points.size());
      result_.transition_cells += counts[i];
      result_.soup.points.insert(result_.soup.points.end(), parts[i].points.begin(), parts[i].points.end());
      result_.origins.insert(result_.origins.end(), origins[i].begin(), origins[i].end());
      for (const Facet& f : parts[i].facets) result_.soup.facets.push_back({f[0] + first, f[1] + first, f[2] + first});
    }
    if (result_.transition_cells > 0) weld_with_origins();
  }

  // Both kinds of cells compute the vertices they share alike, so exact coordinates join them.
  void weld_with_origins() {
    TriangleSoup joined = weld(result_.soup);
    std::vector<VertexOrigin> origins(joined.points.size());
    for (std::size_t f = joined.facets.size(); f-- > 0;)
      for (std::size_t i = 3; i-- > 0;) origins[joined.facets[f][i]] = result_.origins[result_.soup.facets[f][i]];
    result_.soup = std::move(joined);
    result_.origins = std::move(origins);
  }

  static constexpr std::size_t kUsualFacets = 256;  // of a leaf

  const BasicLevelSet<T>& set_;
  const Octree& tree_;
  const ExtractOptions& options_;
  Progress& progress_;
  const LeafSides sides_;
  std::vector<std::uint32_t> cut_leaves_;  // with cells that the surface cuts
  std::vector<std::uint32_t> owners_;      // with nodes that own vertices
  std::vector<std::uint32_t> slot_;        // leaf -> place among the owners
  Field<Move> moves_;
  std::vector<std::uint8_t> masks_;
  std::vector<std::uint16_t> ranks_;
  std::vector<SideRows> rows_;             // of owners
  std::vector<std::uint64_t> first_;
  ExtractedSurface result_;
};

}  // namespace

template <class T>
ExtractedSurface extract_surface(const BasicLevelSet<T>& level_set, const ExtractOptions& options, Progress& progress) {
  return Extractor<T>(level_set, options, progress).run();
}

template ExtractedSurface extract_surface(const BasicLevelSet<float>&, const ExtractOptions&, Progress&);
template ExtractedSurface extract_surface(const BasicLevelSet<double>&, const ExtractOptions&, Progress&);

namespace {

// Marks the stored node at or below a lattice node of the domain.
void mark_node(const Octree& tree, const LatticeNode& at, Field<std::uint8_t>& marked) {
  const auto side = static_cast<std::int32_t>(tree.side()) * kBlockSide;
  if (std::min({at.x, at.y, at.z}) < 0 || std::max({at.x, at.y, at.z}) >= side) return;
  const auto block = [](std::int32_t x) { return static_cast<std::uint32_t>(x) / kBlockSide; };
  const std::uint32_t leaf = tree.find({block(at.x), block(at.y), block(at.z)});
  const LatticeNode first = lattice_node(tree, leaf, 0, 0, 0);
  const int level = tree.level(leaf);
  marked.block(leaf)[node_index((at.x - first.x) >> level, (at.y - first.y) >> level, (at.z - first.z) >> level)] = 1;
}

}  // namespace

void mark_plain(const Octree& tree, const std::vector<VertexOrigin>& vertices, PlainNodes& plain) {
  if (plain.marked.empty()) plain.marked = Field<std::uint8_t>(tree.size(), 0);
  for (const VertexOrigin& v : vertices) {
    const LocalNode n = local_node(v.node);
    // Finer neighbours have nodes half a cell apart.
    const int half = std::max(1, (1 << tree.level(v.leaf)) / 2);
    const LatticeNode low = lattice_node(tree, v.leaf, n.x - 1, n.y - 1, n.z - 1), high = lattice_node(tree, v.leaf, n.x + 2, n.y + 2, n.z + 2);
    for (int z = low.z; z <= high.z; z += half)
      for (int y = low.y; y <= high.y; y += half)
        for (int x = low.x; x <= high.x; x += half) mark_node(tree, {x, y, z}, plain.marked);
  }
}

}  // namespace burnish
