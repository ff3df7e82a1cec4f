#include "burnish/extract/marching_tetrahedra.h"

#include <algorithm>
#include <array>
#include <bit>
#include <memory>
#include <utility>

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

// Calls check(direction) until it fails, for every direction of the neighbours beside cell n of a leaf (margin 0) or beside
// the cells around node n (margin 1).
template <class Check>
bool all_touched(LocalNode n, int margin, Check&& check) {
  const auto low = [&](int i) { return i <= margin ? -1 : 0; };
  const auto high = [](int i) { return i == kBlockSide - 1 ? 1 : 0; };
  for (int dz = low(n.z); dz <= high(n.z); ++dz)
    for (int dy = low(n.y); dy <= high(n.y); ++dy)
      for (int dx = low(n.x); dx <= high(n.x); ++dx)
        if (!check(direction(dx, dy, dz))) return false;
  return true;
}

// Fills a dense halo of byte fields, `outside` where no leaf of the same level is.
void gather_bytes(const Octree& tree, const Field<std::uint8_t>& field, std::size_t leaf, std::uint8_t outside,
                  std::uint8_t* dense) {
  if (field.empty()) {
    std::fill_n(dense, LatticeView::kNodes, outside);
    return;
  }
  constexpr int w = LatticeView::kWidth;
  for (int dir = 0; dir < kDirections; ++dir) {
    const auto [dx, dy, dz] = offset_of(dir);
    const auto begin = [](int d) { return d < 0 ? -w : d > 0 ? kBlockSide : 0; };
    const auto end = [](int d) { return d < 0 ? 0 : d > 0 ? kBlockSide + w : kBlockSide; };
    const bool same = tree.neighbor_kind(leaf, dir) == NeighborKind::same;
    const std::uint8_t* source = same ? field.block(tree.neighbor(leaf, dir)) : nullptr;
    for (int k = begin(dz); k < end(dz); ++k)
      for (int j = begin(dy); j < end(dy); ++j)
        for (int i = begin(dx); i < end(dx); ++i)
          dense[LatticeView::at({i, j, k})] =
              same ? source[node_index(i - kBlockSide * dx, j - kBlockSide * dy, k - kBlockSide * dz)] : outside;
  }
}

template <class T>
class Extractor {
 public:
  Extractor(const BasicLevelSet<T>& level_set, const ExtractOptions& options, Progress& progress)
      : set_(level_set), tree_(level_set.octree()), options_(options), progress_(progress) {}

  ExtractedSurface run() {
    find_cut_leaves();
    if (options_.snap) {
      move_nodes();
      add_leaves_of_moved_nodes();
    }
    number_vertices();
    place_vertices();
    cut_cells();
    return std::move(result_);
  }

 private:
  void load(std::size_t leaf, LatticeView& view) const {
    for (int dir = 0; dir < kDirections; ++dir) {
      const auto [dx, dy, dz] = offset_of(dir);
      if (is_same_level(leaf, dir))
        copy_same_level(tree_.neighbor(leaf, dir), {dx, dy, dz}, view);
      else if (dx >= 0 && dy >= 0 && dz >= 0 && may_be_cut_towards(leaf, dir))
        interpolate_layer(leaf, {dx, dy, dz}, view);
      else
        continue_outwards(leaf, {dx, dy, dz}, view);
    }
    gather_bytes(tree_, moves_, leaf, kStays, view.move.data());
    gather_bytes(tree_, marked_plain(), leaf, 0, view.plain.data());
  }
  const Field<std::uint8_t>& marked_plain() const {
    static const Field<std::uint8_t> none;
    return options_.plain ? options_.plain->marked : none;
  }

  // Calls visit(i, j, k) for the halo nodes in a direction, in `layers` layers.
  template <class Visit>
  static void for_halo(const std::array<int, 3>& d, int layers, Visit&& visit) {
    const auto begin = [&](int a) { return a < 0 ? -layers : a > 0 ? kBlockSide : 0; };
    const auto end = [&](int a) { return a < 0 ? 0 : a > 0 ? kBlockSide + layers : kBlockSide; };
    for (int k = begin(d[2]); k < end(d[2]); ++k)
      for (int j = begin(d[1]); j < end(d[1]); ++j)
        for (int i = begin(d[0]); i < end(d[0]); ++i) visit(i, j, k);
  }
  void copy_same_level(std::size_t other, const std::array<int, 3>& d, LatticeView& view) const {
    const T* source = set_.phi.block(other);
    for_halo(d, LatticeView::kWidth, [&](int i, int j, int k) {
      view.phi[LatticeView::at({i, j, k})] = source[node_index(i - kBlockSide * d[0], j - kBlockSide * d[1], k - kBlockSide * d[2])];
    });
  }
  // Whether cells that have nodes in a neighbour of another level, upwards, may be cut there.
  bool may_be_cut_towards(std::size_t leaf, int dir) const {
    const auto [dx, dy, dz] = offset_of(dir);
    std::uint8_t seen = 0;
    for (const std::uint32_t other : tree_.neighbors(leaf, dir)) seen |= sides_[other];
    const T* phi = set_.phi.block(leaf);
    const auto begin = [](int a) { return a > 0 ? kBlockSide - 1 : 0; };
    for (int k = begin(dz); k < kBlockSide && seen != 3; ++k)
      for (int j = begin(dy); j < kBlockSide; ++j)
        for (int i = begin(dx); i < kBlockSide; ++i) seen |= static_cast<std::uint8_t>(phi[node_index(i, j, k)] >= 0 ? 1 : 2);
    return seen == 3;
  }
  // Only the first layer belongs to cells of the leaf. No move looks at it.
  void interpolate_layer(std::size_t leaf, const std::array<int, 3>& d, LatticeView& view) const {
    for_halo(d, 1, [&](int i, int j, int k) {
      view.phi[LatticeView::at({i, j, k})] = static_cast<T>(node_value(tree_, set_.phi, lattice_node(tree_, leaf, i, j, k)));
    });
  }
  // The nearest node's value: where nothing is cut, it only has to have the right sign.
  void continue_outwards(std::size_t leaf, const std::array<int, 3>& d, LatticeView& view) const {
    const T* phi = set_.phi.block(leaf);
    const auto inside = [](int i) { return std::clamp(i, 0, kBlockSide - 1); };
    for_halo(d, LatticeView::kWidth, [&](int i, int j, int k) { view.phi[LatticeView::at({i, j, k})] = phi[node_index(inside(i), inside(j), inside(k))]; });
  }

  bool is_same_level(std::size_t leaf, int dir) const { return tree_.neighbor_kind(leaf, dir) == NeighborKind::same; }
  // Whether a cell is cut here, in Kuhn tetrahedra; the others are transition cells.
  bool is_plain_cell(std::size_t leaf, LocalNode cell) const {
    return all_touched(cell, 0, [&](int dir) { return is_same_level(leaf, dir); });
  }
  // Transition cells know nothing of moved nodes.
  bool may_move(std::size_t leaf, LocalNode n) const {
    return all_touched(n, 1, [&](int dir) { return is_same_level(leaf, dir); });
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

  // Bit 0: the leaf stores an inside node, bit 1: an outside one.
  std::vector<std::uint8_t> sides_of_leaves() const {
    std::vector<std::uint8_t> sides(tree_.size(), 0);
    parallel_for(
        tree_.size(),
        [&](std::size_t leaf) {
          const T* phi = set_.phi.block(leaf);
          for (std::size_t n = 0; n < kBlockNodes && sides[leaf] != 3; ++n) sides[leaf] |= phi[n] >= 0 ? 1 : 2;
        },
        256);
    return sides;
  }

  // Leaves with cells that the surface may cut, and the leaves that own these cells' upper nodes.
  void find_cut_leaves() {
    sides_ = sides_of_leaves();
    std::vector<char> cut(tree_.size(), 0);
    for (std::size_t leaf = 0; leaf < tree_.size(); ++leaf) {
      std::uint8_t seen = sides_[leaf];
      for (int corner = 1; corner < 8; ++corner)
        for (const std::uint32_t other : tree_.neighbors(leaf, direction(corner & 1, corner >> 1 & 1, corner >> 2 & 1)))
          seen |= sides_[other];
      cut[leaf] = seen == 3;
    }
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
      for (std::size_t n = 0; n < kBlockNodes; ++n)
        if (may_move(leaf, local_node(n))) wanted.block(leaf)[n] = best_move(view, local_node(n));
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
    for (const std::uint32_t leaf : owners_)
      for (std::size_t n = 0; n < kBlockNodes; ++n) {
        if (moves_.block(leaf)[n] == kStays) continue;
        all_touched(local_node(n), 0, [&](int dir) {
          cut[tree_.neighbor(leaf, dir)] = 1;
          return true;
        });
      }
    cut_leaves_.clear();
    for (std::uint32_t leaf = 0; leaf < tree_.size(); ++leaf)
      if (cut[leaf]) cut_leaves_.push_back(leaf);
  }

  // Which vertices each owner's nodes have: a bit per edge upwards that the surface crosses, bit 7 for a moved node.
  void number_vertices() {
    masks_.assign(owners_.size() * kBlockNodes, 0);
    ranks_.assign(owners_.size() * kBlockNodes, 0);
    first_.assign(owners_.size() + 1, 0);
    for_leaves(owners_, [&](std::size_t slot, std::uint32_t, const LatticeView& view) {
      std::uint16_t rank = 0;
      for (std::size_t n = 0; n < kBlockNodes; ++n) {
        const LocalNode here = local_node(n);
        const Side side = view.side(here);
        std::uint8_t mask = side == kOn ? 0x80 : 0;
        for (std::size_t d = 0; d < kEdgeSteps.size() && side != kOn; ++d)
          if (view.side(here + kEdgeSteps[d]) == -side) mask |= static_cast<std::uint8_t>(1u << d);
        masks_[slot * kBlockNodes + n] = mask;
        ranks_[slot * kBlockNodes + n] = rank;
        rank = static_cast<std::uint16_t>(rank + std::popcount(mask));
      }
      first_[slot] = rank;
    });
    exclusive_scan_in_place(first_);
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

  void place_vertices() {
    result_.soup.points.resize(first_.back());
    result_.origins.resize(first_.back());
    for_leaves(owners_, [&](std::size_t slot, std::uint32_t leaf, const LatticeView& view) {
      std::size_t v = first_[slot];
      for (std::size_t n = 0; n < kBlockNodes; ++n) {
        const std::uint8_t mask = masks_[slot * kBlockNodes + n];
        for (std::uint8_t d = 0; d < 8; ++d) {
          if (!(mask >> d & 1)) continue;
          const LocalNode here = local_node(n);
          result_.soup.points[v] = vertex_position(leaf, view, here, d);
          result_.origins[v++] = {leaf, static_cast<std::uint16_t>(n), d};
        }
      }
    });
  }

  // The number of the vertex on edge `d` (7: the moved node itself) from node n, 0..8 along each axis.
  std::uint32_t vertex_number(std::size_t leaf, LocalNode n, int d) const {
    const auto over = [](int i) { return i == kBlockSide ? 1 : 0; };
    const int dir = direction(over(n.x), over(n.y), over(n.z));
    const std::size_t slot = slot_[tree_.neighbor(leaf, dir)];
    const std::size_t at = slot * kBlockNodes + node_index(n.x % kBlockSide, n.y % kBlockSide, n.z % kBlockSide);
    const unsigned below = masks_[at] & ((1u << d) - 1);
    return static_cast<std::uint32_t>(first_[slot] + ranks_[at] + static_cast<unsigned>(std::popcount(below)));
  }

  void cut_cell(std::size_t leaf, const LatticeView& view, LocalNode cell, std::vector<Facet>& out) const {
    for (const KuhnTetrahedron& t : kKuhn) {
      std::array<Side, 4> side{};
      for (std::size_t i = 0; i < 4; ++i) side[i] = view.side(corner_of(cell, t.corners[i]));
      const auto vertex = [&](int i, int j) {
        int a = t.corners[static_cast<std::size_t>(i)], b = t.corners[static_cast<std::size_t>(j)];
        if (side[static_cast<std::size_t>(i)] == kOn) return vertex_number(leaf, corner_of(cell, a), 7);
        if (side[static_cast<std::size_t>(j)] == kOn) return vertex_number(leaf, corner_of(cell, b), 7);
        if (a > b) std::swap(a, b);
        return vertex_number(leaf, corner_of(cell, a), edge_number(a, b));
      };
      const auto opposite_out = [&](int i) {
        return view.side(across_face(cell, t, t.corners[static_cast<std::size_t>(i)])) == kOut;
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

  static bool is_cut(const LatticeView& view, LocalNode cell) {
    const Side first = view.side(cell);
    for (int c = 1; c < 8; ++c)
      if (view.side(corner_of(cell, c)) != first) return true;
    return false;
  }

  // By direction: the sides (1 inside, 2 outside) of the nodes that finer leaves store on this leaf's upper boundary.
  // These are its hanging nodes with values of their own; all others are interpolated between corners of cells.
  std::array<std::uint8_t, kDirections> sides_of_hanging_nodes(std::size_t leaf) const {
    std::array<std::uint8_t, kDirections> sides{};
    for (int corner = 1; corner < 8; ++corner) {
      const std::array<int, 3> d{corner & 1, corner >> 1 & 1, corner >> 2 & 1};
      const int dir = direction(d[0], d[1], d[2]);
      if (tree_.neighbor_kind(leaf, dir) != NeighborKind::finer) continue;
      std::uint8_t seen = 0;
      for (const std::uint32_t finer : tree_.neighbors(leaf, dir))
        for (int k = 0; k < (d[2] ? 1 : kBlockSide); ++k)
          for (int j = 0; j < (d[1] ? 1 : kBlockSide); ++j)
            for (int i = 0; i < (d[0] ? 1 : kBlockSide); ++i)
              seen |= static_cast<std::uint8_t>(set_.phi.block(finer)[node_index(i, j, k)] >= 0 ? 1 : 2);
      sides[static_cast<std::size_t>(dir)] = seen;
    }
    return sides;
  }

  // Whether the surface may cut a transition cell: its corners, or hanging nodes it may have, are on both sides.
  static bool may_be_cut(const LatticeView& view, LocalNode cell, const std::array<std::uint8_t, kDirections>& hanging) {
    if (is_cut(view, cell)) return true;
    std::uint8_t seen = view.side(cell) == kIn ? 1 : 2;
    all_touched(cell, 0, [&](int dir) {
      seen |= hanging[static_cast<std::size_t>(dir)];
      return true;
    });
    return seen == 3;
  }

  void cut_cells() {
    std::vector<std::vector<Facet>> facets(cut_leaves_.size());
    std::vector<std::vector<LatticeNode>> transition(cut_leaves_.size());
    for_leaves(cut_leaves_, [&](std::size_t i, std::uint32_t leaf, const LatticeView& view) {
      const auto hanging = sides_of_hanging_nodes(leaf);
      for (std::size_t n = 0; n < kBlockNodes; ++n) {
        const LocalNode cell = local_node(n);
        if (is_plain_cell(leaf, cell)) {
          if (is_cut(view, cell)) cut_cell(leaf, view, cell, facets[i]);
        } else if (may_be_cut(view, cell, hanging)) {
          transition[i].push_back(lattice_node(tree_, leaf, cell.x, cell.y, cell.z));
        }
      }
    });
    std::size_t total = 0;
    for (const auto& part : facets) total += part.size();
    result_.soup.facets.reserve(total);
    for (const auto& part : facets) result_.soup.facets.insert(result_.soup.facets.end(), part.begin(), part.end());
    for (std::size_t i = 0; i < transition.size(); ++i)
      for (const LatticeNode& cell : transition[i]) {
        const std::size_t before = result_.soup.facets.size();
        cut_transition_cell(tree_, set_.phi, marked_plain(), cut_leaves_[i], cell, result_.soup);
        result_.transition_cells += result_.soup.facets.size() > before;
      }
    if (result_.transition_cells == 0) return;
    // Both kinds of cells compute the vertices they share alike, so exact coordinates join them.
    result_.soup = weld(std::move(result_.soup));
    result_.origins.clear();
  }

  const BasicLevelSet<T>& set_;
  const Octree& tree_;
  const ExtractOptions& options_;
  Progress& progress_;
  std::vector<std::uint8_t> sides_;        // of each leaf: which signs its nodes have
  std::vector<std::uint32_t> cut_leaves_;  // with cells that the surface cuts
  std::vector<std::uint32_t> owners_;      // with nodes that own vertices
  std::vector<std::uint32_t> slot_;        // leaf -> place among the owners
  Field<Move> moves_;
  std::vector<std::uint8_t> masks_;
  std::vector<std::uint16_t> ranks_;
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

void mark_plain(const Octree& tree, const std::vector<VertexOrigin>& vertices, PlainNodes& plain) {
  if (plain.marked.empty()) plain.marked = Field<std::uint8_t>(tree.size(), 0);
  for (const VertexOrigin& v : vertices) {
    const LocalNode n = local_node(v.node);
    for (int dz = -1; dz <= 2; ++dz)
      for (int dy = -1; dy <= 2; ++dy)
        for (int dx = -1; dx <= 2; ++dx) {
          const std::array<int, 3> at{n.x + dx, n.y + dy, n.z + dz};
          const auto over = [](int i) { return i < 0 ? -1 : i >= kBlockSide ? 1 : 0; };
          const int dir = direction(over(at[0]), over(at[1]), over(at[2]));
          if (tree.neighbor_kind(v.leaf, dir) != NeighborKind::same) continue;
          const auto wrap = [](int i) { return (i + kBlockSide) % kBlockSide; };
          plain.marked.block(tree.neighbor(v.leaf, dir))[node_index(wrap(at[0]), wrap(at[1]), wrap(at[2]))] = 1;
        }
  }
}

}  // namespace burnish
