#include "stuffing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/octree/field.h"
#include "numbering.h"

namespace burnish {
namespace {

// How near to a node, as a part of an edge, a cut moves the node: Labelle & Shewchuk's, for angles of 10.7 to 164.8 degrees.
constexpr double kLong = 0.24999, kShort = 0.41189;
// Of pyramids on squares with moved corners: distance between the diagonals, least area of a corner and least height, in units of the side.
constexpr double kFlat = 0.2, kSquare = 0.3, kHeight = 0.3;
constexpr double kCube = 0.3;  // least determinant at a corner of a hexahedron that has moved, in units of the cell
constexpr double kCreaseReach = 1.2;  // half sides of a node's smallest cell: no node farther from the surface is near a crease
constexpr double kLarger = 1.5;  // of the smallest cell at a node that has larger ones too: the edge that it may move along
constexpr std::size_t kCellsAtATime = 4096;

using Tetrahedron = std::array<std::uint32_t, 4>;

std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) { return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b); }

enum class CellKind : std::uint8_t { none, whole, coned };

class Stuffing {
 public:
  Stuffing(const CellLattice& lattice, const LevelSet& set, int sign, MeshFlavour flavour, const CreaseTarget& crease, Progress& progress)
      : lattice_(lattice), set_(set), side_(sign), polyhedral_(flavour == MeshFlavour::polyhedral), crease_(crease), progress_(progress) {}

  StuffedCells run() {
    place_nodes();
    level_nodes();
    classify();
    if (crease_) move_to_creases();
    collect_cuts();
    warp();
    classify();
    collect_cuts();
    place_cuts();
    progress_.check();
    emit();
    return std::move(result_);
  }

 private:
  void place_nodes() {
    const std::size_t n = lattice_.nodes();
    phi_.resize(n), sign_.resize(n), result_.points.resize(n);
    parallel_for(n, [&](std::size_t i) {
      const std::array<std::int64_t, 3> p = lattice_.position(static_cast<std::uint32_t>(i));
      const LatticeNode node{static_cast<std::int32_t>(p[0]), static_cast<std::int32_t>(p[1]), static_cast<std::int32_t>(p[2])};
      phi_[i] = side_ * node_value(set_.octree(), set_.phi, node);
      sign_[i] = static_cast<std::int8_t>((phi_[i] > 0) - (phi_[i] < 0));
      result_.points[i] = original(static_cast<std::uint32_t>(i));
    });
  }

  // Of the smallest cell at each node.
  void level_nodes() {
    level_.assign(lattice_.nodes(), 0xff);
    for (std::size_t cell = 0; cell < lattice_.cells(); ++cell) {
      const auto level = static_cast<std::uint8_t>(lattice_.tree().level(cell));
      level_[lattice_.centre(cell)] = static_cast<std::uint8_t>(level - lattice_.hangs(cell));  // its neighbours' cells end there
      for (int c = 0; c < 8; ++c) level_[lattice_.corner(cell, c)] = std::min(level_[lattice_.corner(cell, c)], level);
    }
  }

  bool has_positive(std::size_t cell) const {
    for (int c = 0; c < 8; ++c)
      if (sign_[lattice_.corner(cell, c)] > 0) return true;
    return sign_[lattice_.centre(cell)] > 0;
  }

  // [T-HEX-5] A cell that stays a hexahedron: nothing of it is beyond the surface, what has moved is still nearly a cube, and on all sides stands something that it can share a face with.
  bool is_whole(std::size_t cell) const {
    if (sign_[lattice_.centre(cell)] <= 0 || (!polyhedral_ && lattice_.hangs(cell))) return false;
    bool moved = false;
    for (int c = 0; c < 8; ++c) {
      const int s = sign_[lattice_.corner(cell, c)];
      if (s < 0) return false;
      moved = moved || s == 0;
    }
    if (moved && (lattice_.hangs(cell) || !is_nearly_cube(cell))) return false;
    for (int f = 0; f < 6; ++f)
      if (!can_share(cell, f)) return false;
    return true;
  }

  bool is_nearly_cube(std::size_t cell) const {
    const auto at = [&](int c) { return result_.points[lattice_.corner(cell, c)]; };
    const double side = static_cast<double>(2 << lattice_.tree().level(cell));
    for (int c = 0; c < 8; ++c) {
      const auto edge = [&](int axis) { return (at(c ^ 1 << axis) - at(c)) * ((c >> axis & 1) ? -1.0 : 1.0); };
      if (dot(cross(edge(0), edge(1)), edge(2)) < kCube * side * side * side) return false;
    }
    for (const auto& face : kFaceCorners)
      if (norm(at(face[0]) + at(face[2]) - at(face[1]) - at(face[3])) * 0.5 > kFlat * side) return false;
    return true;
  }

  // A whole cell has no node in its centre, so a neighbour's centre beyond the surface would have no partner to be cut with: unless nothing is left there to cut.
  bool can_share(std::size_t cell, int f) const {
    if (lattice_.is_split(cell, f)) {
      for (const std::uint32_t other : lattice_.finer_across(cell, f))
        if (sign_[lattice_.centre(other)] < 0) return false;
      return true;
    }
    const std::uint32_t other = lattice_.across(cell, f);
    if (other == Octree::kNone) return true;
    const FacePolygon p = lattice_.polygon(cell, f);
    const std::uint32_t apex = lattice_.centre(other);
    if (is_flat_end(p, apex)) return true;
    return sign_[apex] >= 0 && (is_unmoved(p, apex) || is_good_pyramid(p, apex));
  }
  // A face on the surface, with nothing behind it.
  bool is_flat_end(const FacePolygon& p, std::uint32_t apex) const {
    for (int i = 0; i < p.size; ++i)
      if (sign_[p.node[static_cast<std::size_t>(i)]] != 0) return false;
    return sign_[apex] <= 0;
  }
  bool is_unmoved(const FacePolygon& p, std::uint32_t apex) const {
    for (int i = 0; i < p.size; ++i)
      if (sign_[p.node[static_cast<std::size_t>(i)]] <= 0) return false;
    return sign_[apex] > 0;
  }

  void classify() {
    kind_.resize(lattice_.cells());
    parallel_for(lattice_.cells(), [&](std::size_t cell) {
      if (!lattice_.exists(cell)) kind_[cell] = CellKind::none;
      else if (is_whole(cell)) kind_[cell] = CellKind::whole;
      else kind_[cell] = has_positive(cell) ? CellKind::coned : CellKind::none;
    });
  }

  // [T-HEX-9]
  void move_to_creases() {
    parallel_for(sign_.size(), [&](std::size_t i) {
      if (std::abs(phi_[i]) > kCreaseReach * (1 << level_[i])) return;
      const std::optional<Vec3> target = crease_(result_.points[i], level_[i]);
      if (!target) return;
      result_.points[i] = *target;
      sign_[i] = 0;
    });
  }

  // Cells of kind `none` have centres too: their neighbours' tetrahedra reach into them.
  template <class Visit>
  void visit_tetrahedra(std::size_t cell, Visit&& visit) const {
    for (int f = 0; f < 6; ++f) {
      if (!lattice_.exists(cell) || !lattice_.owns(cell, f)) continue;
      const std::uint32_t other = lattice_.across(cell, f);
      if (other == Octree::kNone || !needs_tetrahedra(cell, other)) continue;
      const FacePolygon p = lattice_.polygon(cell, f);
      if (stands_as_pyramids(cell, other, p)) continue;
      for (int i = 0; i < p.size; ++i)
        visit(Tetrahedron{lattice_.centre(cell), p.node[static_cast<std::size_t>(i)], p.node[static_cast<std::size_t>((i + 1) % p.size)], lattice_.centre(other)});
    }
  }
  bool needs_tetrahedra(std::size_t a, std::size_t b) const {
    if (kind_[a] == CellKind::whole || kind_[b] == CellKind::whole) return false;
    return kind_[a] == CellKind::coned || kind_[b] == CellKind::coned;
  }
  // Two pyramids on a square that nothing has moved.
  bool stands_as_pyramids(std::size_t a, std::size_t b, const FacePolygon& p) const {
    if (!p.is_quad() || sign_[lattice_.centre(a)] < 0 || sign_[lattice_.centre(b)] < 0) return false;
    bool moved = false;
    for (int i = 0; i < 4; ++i) {
      const int s = sign_[p.node[static_cast<std::size_t>(i)]];
      if (s < 0) return false;
      moved = moved || s == 0;
    }
    return !moved || (is_good_pyramid(p, lattice_.centre(a)) && is_good_pyramid(p, lattice_.centre(b)));
  }

  // A square with moved corners has to be nearly plane, the apex over it, and no more than one side on the surface.
  bool is_good_pyramid(const FacePolygon& p, std::uint32_t apex) const {
    const auto at = [&](int i) { return result_.points[p.node[static_cast<std::size_t>(i % 4)]]; };
    const auto zero = [&](int i) { return sign_[p.node[static_cast<std::size_t>(i % 4)]] == 0; };
    const Vec3 top = result_.points[apex], normal = cross(at(2) - at(0), at(3) - at(1)) * 0.5;
    const double area = norm(normal);
    if (norm(at(0) + at(2) - at(1) - at(3)) * 0.5 > kFlat * std::sqrt(area)) return false;
    int sides = 0;
    for (int i = 0; i < 4; ++i) {
      sides += sign_[apex] == 0 && zero(i) && zero(i + 1);
      const Vec3 corner = cross(at(i + 1) - at(i), at(i + 3) - at(i));  // twice the corner's triangle
      if (dot(corner, normal) < kSquare * area * area) return false;
      if (std::abs(dot(corner, top - at(i))) < kHeight * area * std::sqrt(area)) return false;
    }
    return sides <= 1 && !(zero(0) && zero(1) && zero(2) && zero(3));
  }

  bool is_cut(std::uint32_t a, std::uint32_t b) const { return sign_[a] * sign_[b] < 0; }

  void collect_cuts() {
    const std::size_t chunks = (lattice_.cells() + kCellsAtATime - 1) / kCellsAtATime;
    std::vector<std::vector<std::uint64_t>> found(chunks);
    parallel_ranges(lattice_.cells(), kCellsAtATime, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint64_t>& cuts = found[begin / kCellsAtATime];
      for (std::size_t cell = begin; cell < end; ++cell)
        visit_tetrahedra(cell, [&](const Tetrahedron& t) {
          for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = i + 1; j < 4; ++j)
              if (is_cut(t[i], t[j])) cuts.push_back(edge_key(t[i], t[j]));
        });
      std::sort(cuts.begin(), cuts.end());
      cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
    });
    cuts_.clear();
    for (const auto& part : found) cuts_.insert(cuts_.end(), part.begin(), part.end());
    parallel_sort(cuts_);
    cuts_.erase(std::unique(cuts_.begin(), cuts_.end()), cuts_.end());
  }

  // As a part of the edge, from a.
  double cut_at(std::uint32_t a, std::uint32_t b) const { return phi_[a] / (phi_[a] - phi_[b]); }
  // Measured by the smallest cell at the node: what a large cell can bear may turn a small one over. [T-HEX-3]
  double limit(std::uint32_t a, std::uint32_t b) const {
    const bool is_long = lattice_.is_centre(a) == lattice_.is_centre(b);
    const double edge = kLarger * (is_long ? 2 : std::numbers::sqrt3) * (1 << level_[a]);
    return (is_long ? kLong : kShort) * std::min(1.0, edge / norm(original(b) - original(a)));
  }

  // One node after the other: which goes first does not matter to the bounds.
  void warp() {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> ends;  // node, the other end
    for (const std::uint64_t cut : cuts_) {
      const auto a = static_cast<std::uint32_t>(cut >> 32), b = static_cast<std::uint32_t>(cut);
      if (cut_at(a, b) < limit(a, b)) ends.emplace_back(a, b);
      else if (cut_at(b, a) < limit(b, a)) ends.emplace_back(b, a);
    }
    parallel_sort(ends);
    for (std::size_t i = 0; i < ends.size();) {
      const std::uint32_t node = ends[i].first;
      std::optional<Vec3> nearest;
      for (; i < ends.size() && ends[i].first == node; ++i) {
        if (sign_[ends[i].second] == 0) continue;
        const Vec3 step = (original(ends[i].second) - original(node)) * cut_at(node, ends[i].second);
        if (!nearest || squared_norm(step) < squared_norm(*nearest)) nearest = step;
      }
      if (!nearest) continue;
      sign_[node] = 0;
      result_.points[node] += *nearest;
    }
  }
  Vec3 original(std::uint32_t node) const {
    const std::array<std::int64_t, 3> p = lattice_.position(node);
    return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
  }

  void place_cuts() {
    const std::size_t nodes = lattice_.nodes();
    require_numbers(nodes + cuts_.size(), "points");
    result_.points.resize(nodes + cuts_.size());
    result_.on_surface.assign(result_.points.size(), 0);
    for (std::size_t i = 0; i < nodes; ++i) result_.on_surface[i] = sign_[i] == 0;
    parallel_for(cuts_.size(), [&](std::size_t i) {
      const auto a = static_cast<std::uint32_t>(cuts_[i] >> 32), b = static_cast<std::uint32_t>(cuts_[i]);
      result_.points[nodes + i] = result_.points[a] + (result_.points[b] - result_.points[a]) * cut_at(a, b);
      result_.on_surface[nodes + i] = 1;
    });
  }
  std::uint32_t cut_point(std::uint32_t a, std::uint32_t b) const {
    return static_cast<std::uint32_t>(lattice_.nodes() + static_cast<std::size_t>(std::lower_bound(cuts_.begin(), cuts_.end(), edge_key(a, b)) - cuts_.begin()));
  }

  void emit() {
    const std::size_t chunks = (lattice_.cells() + kCellsAtATime - 1) / kCellsAtATime;
    std::vector<CellList> parts(chunks);
    parallel_ranges(lattice_.cells(), kCellsAtATime, [&](std::size_t begin, std::size_t end) {
      for (std::size_t cell = begin; cell < end; ++cell) emit_cell(cell, parts[begin / kCellsAtATime]);
    });
    for (CellList& part : parts) append(part);
    emit_ends();
  }

  void append(CellList& part) {
    CellList& all = result_.cells;
    all.shape.insert(all.shape.end(), part.shape.begin(), part.shape.end());
    const std::uint64_t start = all.corners.size();
    for (std::size_t i = 1; i < part.first.size(); ++i) all.first.push_back(start + part.first[i]);
    all.corners.insert(all.corners.end(), part.corners.begin(), part.corners.end());
    part = {};
  }

  void emit_cell(std::size_t cell, CellList& out) const {
    if (!lattice_.exists(cell)) return;
    if (kind_[cell] == CellKind::whole) emit_whole(cell, out);
    for (int f = 0; f < 6; ++f)
      if (lattice_.owns(cell, f)) emit_across(cell, f, out);
    visit_tetrahedra(cell, [&](const Tetrahedron& t) { emit_cut(t, out); });
  }

  // Pyramids on both sides of a face, where they are.
  void emit_across(std::size_t cell, int f, CellList& out) const {
    const std::uint32_t other = lattice_.across(cell, f);
    if (other == Octree::kNone) return;
    const FacePolygon p = lattice_.polygon(cell, f);
    const bool both = kind_[cell] != CellKind::whole && kind_[other] != CellKind::whole;
    if (both && !(needs_tetrahedra(cell, other) && stands_as_pyramids(cell, other, p))) return;
    const auto is_end = [&](std::uint32_t c) { return is_flat_end(p, lattice_.centre(c)); };
    if (is_end(static_cast<std::uint32_t>(cell)) || is_end(other)) return;
    if (kind_[cell] != CellKind::whole) emit_pyramid(p, true, lattice_.centre(cell), out);
    if (kind_[other] != CellKind::whole) emit_pyramid(p, false, lattice_.centre(other), out);
  }

  // Over a polygon whose normal points away from the apex (`reversed`) or towards it.
  void emit_pyramid(const FacePolygon& p, bool reversed, std::uint32_t apex, CellList& out) const {
    std::array<std::uint32_t, 8> base = p.node;
    if (reversed) std::reverse(base.begin(), base.begin() + p.size);
    if (p.is_quad()) return out.add(CellShape::pyramid, {base[0], base[1], base[2], base[3], apex});
    const auto n = static_cast<std::uint32_t>(p.size);
    out.shape.push_back(CellShape::polyhedron);
    out.corners.insert(out.corners.end(), {n + 1, n});
    for (std::uint32_t i = n; i-- > 0;) out.corners.push_back(base[i]);
    for (std::uint32_t i = 0; i < n; ++i) out.corners.insert(out.corners.end(), {3, base[i], base[(i + 1) % n], apex});
    out.first.push_back(out.corners.size());
  }

  void emit_whole(std::size_t cell, CellList& out) const {
    const auto c = [&](int i) { return lattice_.corner(cell, i); };
    if (!lattice_.hangs(cell)) return out.add(CellShape::hexahedron, {c(0), c(1), c(3), c(2), c(4), c(5), c(7), c(6)});
    emit_polyhedron(cell, out);
  }

  void emit_polyhedron(std::size_t cell, CellList& out) const {
    const std::size_t count_at = out.corners.size();
    out.shape.push_back(CellShape::polyhedron);
    out.corners.push_back(0);
    const auto add_face = [&](const FacePolygon& p, bool reversed) {
      ++out.corners[count_at];
      out.corners.push_back(static_cast<std::uint32_t>(p.size));
      for (int i = 0; i < p.size; ++i) out.corners.push_back(p.node[static_cast<std::size_t>(reversed ? p.size - 1 - i : i)]);
    };
    for (int f = 0; f < 6; ++f) {
      if (!lattice_.is_split(cell, f)) {
        add_face(lattice_.polygon(cell, f), false);
        continue;
      }
      for (const std::uint32_t finer : lattice_.finer_across(cell, f)) add_face(lattice_.polygon(finer, f ^ 1), true);
    }
    out.first.push_back(out.corners.size());
  }

  // [T-HEX-4] Even permutations bring the positive corners to the front.
  void emit_cut(Tetrahedron t, CellList& out) const {
    int positive = 0, negative = 0;
    for (const std::uint32_t v : t) positive += sign_[v] > 0, negative += sign_[v] < 0;
    if (positive == 0) return;
    if (negative == 0) return out.add(CellShape::tetrahedron, {t[0], t[1], t[2], t[3]});
    order(t);
    const auto cut = [&](std::size_t i, std::size_t j) { return cut_point(t[i], t[j]); };
    const auto kept = [&](std::size_t i) { return sign_[t[i]] == 0 ? t[i] : cut(0, i); };
    if (positive == 1) return out.add(CellShape::tetrahedron, {t[0], kept(1), kept(2), kept(3)});
    if (positive == 3) return out.add(CellShape::wedge, {t[0], t[2], t[1], cut(0, 3), cut(2, 3), cut(1, 3)});
    if (negative == 2) return out.add(CellShape::wedge, {t[0], cut(0, 3), cut(0, 2), t[1], cut(1, 3), cut(1, 2)});
    out.add(CellShape::pyramid, {t[0], t[1], cut(1, 2), cut(0, 2), t[3]});
  }

  // Positive corners first, then negative ones, then those on the surface, by an even permutation. With two positive and two negative ones any order of each
  // will do; with one corner on the surface it comes last.
  void order(Tetrahedron& t) const {
    const auto rank = [&](std::uint32_t v) { return sign_[v] > 0 ? 0 : sign_[v] < 0 ? 1 : 2; };
    bool odd = false;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j + 1 < 4 - i; ++j)
        if (rank(t[j]) > rank(t[j + 1])) std::swap(t[j], t[j + 1]), odd = !odd;
    if (!odd) return;
    for (std::size_t j = 0; j < 3; ++j)
      if (rank(t[j]) == rank(t[j + 1])) return std::swap(t[j], t[j + 1]);
  }

  // Cells at the end of the domain are closed by cones over what is left of their faces there.
  void emit_ends() {
    for (std::size_t cell = 0; cell < lattice_.cells(); ++cell) {
      if (kind_[cell] != CellKind::coned) continue;
      for (int f = 0; f < 6; ++f)
        if (lattice_.owns(cell, f) && lattice_.across(cell, f) == Octree::kNone) emit_end(cell, f);
    }
  }

  void emit_end(std::size_t cell, int f) {
    const FacePolygon p = lattice_.polygon(cell, f);
    for (int i = 0; i < p.size; ++i)
      if (sign_[p.node[static_cast<std::size_t>(i)]] <= 0 || sign_[lattice_.centre(cell)] <= 0)
        throw Error(ErrorCode::guarantee_unmet, "the surface reaches the end of the domain", "choose a larger --domain");
    if (p.is_quad() || polyhedral_) return emit_pyramid(p, true, lattice_.centre(cell), result_.cells);
    Vec3 middle;
    for (const int c : kFaceCorners[static_cast<std::size_t>(f)]) middle += result_.points[lattice_.corner(cell, c)] * 0.25;
    const auto m = static_cast<std::uint32_t>(result_.points.size());
    result_.points.push_back(middle);
    result_.on_surface.push_back(0);
    for (int i = 0; i < p.size; ++i)
      result_.cells.add(CellShape::tetrahedron, {lattice_.centre(cell), p.node[static_cast<std::size_t>(i)], p.node[static_cast<std::size_t>((i + 1) % p.size)], m});
  }

  const CellLattice& lattice_;
  const LevelSet& set_;
  const int side_;
  const bool polyhedral_;
  const CreaseTarget& crease_;
  Progress& progress_;
  std::vector<double> phi_;
  std::vector<std::int8_t> sign_;
  std::vector<std::uint8_t> level_;
  std::vector<CellKind> kind_;
  std::vector<std::uint64_t> cuts_;  // edges that the surface cuts, ascending
  StuffedCells result_;
};

}  // namespace

StuffedCells stuff(const CellLattice& lattice, const LevelSet& set, int sign, MeshFlavour flavour, const CreaseTarget& crease, Progress& progress) {
  return Stuffing(lattice, set, sign, flavour, crease, progress).run();
}

}  // namespace burnish
