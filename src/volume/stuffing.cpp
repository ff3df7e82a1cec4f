#include "stuffing.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "burnish/core/parallel.h"
#include "numbering.h"

namespace burnish {
namespace {

// Of pyramids on squares with moved corners: distance between the diagonals, least area of a corner and least height, in units of the side.
constexpr double kFlat = 0.2, kSquare = 0.3, kHeight = 0.3;
constexpr double kCube = 0.3;  // least determinant at a corner of a hexahedron that has moved, in units of the cell
constexpr std::size_t kCellsAtATime = 4096;

enum class CellKind : std::uint8_t { none, whole, coned };

class Stuffing {
 public:
  Stuffing(const CellLattice& lattice, const LevelSet& set, int sign, MeshFlavour flavour, const CreaseTarget& crease, Progress& progress)
      : lattice_(lattice), nodes_(lattice, set, sign, result_.points), polyhedral_(flavour == MeshFlavour::polyhedral), crease_(crease), progress_(progress) {}

  StuffedCells run() {
    classify();
    if (crease_) nodes_.move_to_creases(crease_);
    progress_.check();
    collect_cuts();
    nodes_.move_to_cuts(cuts_);
    progress_.check();
    classify();
    collect_cuts();
    place_cuts();
    progress_.check();
    emit();
    return std::move(result_);
  }

 private:
  // Nodes in the middle of its edges and faces are the cell's as well: one of them may be all that is positive.
  bool has_positive(std::size_t cell) const {
    for (int c = 0; c < 8; ++c)
      if (nodes_.sign(lattice_.corner(cell, c)) > 0) return true;
    return nodes_.sign(lattice_.centre(cell)) > 0 || (lattice_.hangs(cell) && any_on_faces(cell, [](int sign) { return sign > 0; }));
  }
  // Of the signs of all nodes on a cell's faces, those in the middle of edges and faces among them.
  template <class Is>
  bool any_on_faces(std::size_t cell, Is&& is) const {
    const auto any_of = [&](const FacePolygon& p) { return std::any_of(p.node.begin(), p.node.begin() + p.size, [&](std::uint32_t n) { return is(nodes_.sign(n)); }); };
    for (int f = 0; f < 6; ++f) {
      if (!lattice_.is_split(cell, f)) {
        if (any_of(lattice_.polygon(cell, f))) return true;
        continue;
      }
      for (const std::uint32_t other : lattice_.finer_across(cell, f))
        if (any_of(lattice_.polygon(other, f ^ 1))) return true;
    }
    return false;
  }

  // [T-HEX-5] A cell that stays a hexahedron: nothing of it is beyond the surface, what has moved is still nearly a cube, and on all sides stands something that it can share a face with.
  bool is_whole(std::size_t cell) const {
    if (nodes_.sign(lattice_.centre(cell)) <= 0 || (!polyhedral_ && lattice_.hangs(cell))) return false;
    bool moved = false;
    for (int c = 0; c < 8; ++c) {
      const int s = nodes_.sign(lattice_.corner(cell, c));
      if (s < 0) return false;
      moved = moved || s == 0;
    }
    if (moved && (lattice_.hangs(cell) || !is_nearly_cube(cell))) return false;
    if (lattice_.hangs(cell) && any_on_faces(cell, [](int sign) { return sign <= 0; })) return false;
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
        if (nodes_.sign(lattice_.centre(other)) < 0) return false;
      return true;
    }
    const std::uint32_t other = lattice_.across(cell, f);
    if (other == Octree::kNone) return true;
    const FacePolygon p = lattice_.polygon(cell, f);
    const std::uint32_t apex = lattice_.centre(other);
    if (is_flat_end(p, apex)) return true;
    return nodes_.sign(apex) >= 0 && (is_unmoved(p, apex) || is_good_pyramid(p, apex));
  }
  // A face on the surface, with nothing behind it.
  bool is_flat_end(const FacePolygon& p, std::uint32_t apex) const {
    for (int i = 0; i < p.size; ++i)
      if (nodes_.sign(p.node[static_cast<std::size_t>(i)]) != 0) return false;
    return nodes_.sign(apex) <= 0;
  }
  bool is_unmoved(const FacePolygon& p, std::uint32_t apex) const {
    for (int i = 0; i < p.size; ++i)
      if (nodes_.sign(p.node[static_cast<std::size_t>(i)]) <= 0) return false;
    return nodes_.sign(apex) > 0;
  }

  void classify() {
    kind_.resize(lattice_.cells());
    parallel_for(lattice_.cells(), [&](std::size_t cell) {
      if (!lattice_.exists(cell)) kind_[cell] = CellKind::none;
      else if (is_whole(cell)) kind_[cell] = CellKind::whole;
      else kind_[cell] = has_positive(cell) ? CellKind::coned : CellKind::none;
    });
  }

  // Cells of kind `none` have centres too: their neighbours' tetrahedra reach into them.
  template <class Visit>
  void visit_tetrahedra(std::size_t cell, Visit&& visit) const {
    for (int f = 0; f < 6; ++f) {
      if (!lattice_.exists(cell) || !lattice_.owns(cell, f)) continue;
      const std::uint32_t other = lattice_.across(cell, f);
      if (other == Octree::kNone || !needs_tetrahedra(cell, other)) continue;
      if (!stands_as_pyramids(cell, other, lattice_.polygon(cell, f))) visit_tetrahedra_across(lattice_, cell, f, visit);
    }
  }
  bool needs_tetrahedra(std::size_t a, std::size_t b) const {
    if (kind_[a] == CellKind::whole || kind_[b] == CellKind::whole) return false;
    return kind_[a] == CellKind::coned || kind_[b] == CellKind::coned;
  }
  // Two pyramids on a square that nothing has moved.
  bool stands_as_pyramids(std::size_t a, std::size_t b, const FacePolygon& p) const {
    if (!p.is_quad() || nodes_.sign(lattice_.centre(a)) < 0 || nodes_.sign(lattice_.centre(b)) < 0) return false;
    bool moved = false;
    for (int i = 0; i < 4; ++i) {
      const int s = nodes_.sign(p.node[static_cast<std::size_t>(i)]);
      if (s < 0) return false;
      moved = moved || s == 0;
    }
    return !moved || (is_good_pyramid(p, lattice_.centre(a)) && is_good_pyramid(p, lattice_.centre(b)));
  }

  // A square with moved corners has to be nearly plane, the apex over it, and no more than one side on the surface.
  bool is_good_pyramid(const FacePolygon& p, std::uint32_t apex) const {
    if (!p.is_quad()) return false;
    const auto at = [&](int i) { return result_.points[p.node[static_cast<std::size_t>(i % 4)]]; };
    const auto zero = [&](int i) { return nodes_.sign(p.node[static_cast<std::size_t>(i % 4)]) == 0; };
    const Vec3 top = result_.points[apex], normal = cross(at(2) - at(0), at(3) - at(1)) * 0.5;
    const double area = norm(normal);
    if (norm(at(0) + at(2) - at(1) - at(3)) * 0.5 > kFlat * std::sqrt(area)) return false;
    int sides = 0;
    for (int i = 0; i < 4; ++i) {
      sides += nodes_.sign(apex) == 0 && zero(i) && zero(i + 1);
      const Vec3 corner = cross(at(i + 1) - at(i), at(i + 3) - at(i));  // twice the corner's triangle
      if (dot(corner, normal) < kSquare * area * area) return false;
      if (std::abs(dot(corner, top - at(i))) < kHeight * area * std::sqrt(area)) return false;
    }
    return sides <= 1 && !(zero(0) && zero(1) && zero(2) && zero(3));
  }

  void collect_cuts() {
    const std::size_t chunks = (lattice_.cells() + kCellsAtATime - 1) / kCellsAtATime;
    std::vector<std::vector<std::uint64_t>> found(chunks);
    parallel_ranges(lattice_.cells(), kCellsAtATime, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint64_t>& cuts = found[begin / kCellsAtATime];
      for (std::size_t cell = begin; cell < end; ++cell)
        visit_tetrahedra(cell, [&](const LatticeTetrahedron& t) {
          for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = i + 1; j < 4; ++j)
              if (nodes_.is_cut(t[i], t[j])) cuts.push_back(edge_key(t[i], t[j]));
        });
      std::sort(cuts.begin(), cuts.end());
      cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
    });
    cuts_.clear();
    for (const auto& part : found) cuts_.insert(cuts_.end(), part.begin(), part.end());
    parallel_sort(cuts_);
    cuts_.erase(std::unique(cuts_.begin(), cuts_.end()), cuts_.end());
  }

  void place_cuts() {
    const std::size_t nodes = lattice_.nodes();
    require_numbers(nodes + cuts_.size(), "points");
    result_.points.resize(nodes + cuts_.size());
    result_.on_surface.assign(result_.points.size(), 0);
    for (std::size_t i = 0; i < nodes; ++i) result_.on_surface[i] = nodes_.sign(i) == 0;
    parallel_for(cuts_.size(), [&](std::size_t i) {
      const auto a = static_cast<std::uint32_t>(cuts_[i] >> 32), b = static_cast<std::uint32_t>(cuts_[i]);
      result_.points[nodes + i] = result_.points[a] + (result_.points[b] - result_.points[a]) * nodes_.cut_at(a, b);
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
    visit_tetrahedra(cell, [&](const LatticeTetrahedron& t) { emit_cut(t, out); });
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
  void emit_cut(LatticeTetrahedron t, CellList& out) const {
    int positive = 0, negative = 0;
    for (const std::uint32_t v : t) positive += nodes_.sign(v) > 0, negative += nodes_.sign(v) < 0;
    if (positive == 0) return;
    if (negative == 0) return out.add(CellShape::tetrahedron, {t[0], t[1], t[2], t[3]});
    order(t);
    const auto cut = [&](std::size_t i, std::size_t j) { return cut_point(t[i], t[j]); };
    const auto kept = [&](std::size_t i) { return nodes_.sign(t[i]) == 0 ? t[i] : cut(0, i); };
    if (positive == 1) return out.add(CellShape::tetrahedron, {t[0], kept(1), kept(2), kept(3)});
    if (positive == 3) return out.add(CellShape::wedge, {t[0], t[2], t[1], cut(0, 3), cut(2, 3), cut(1, 3)});
    if (negative == 2) return out.add(CellShape::wedge, {t[0], cut(0, 3), cut(0, 2), t[1], cut(1, 3), cut(1, 2)});
    out.add(CellShape::pyramid, {t[0], t[1], cut(1, 2), cut(0, 2), t[3]});
  }

  // Positive corners first, then negative ones, then those on the surface, by an even permutation. With two positive and two negative ones any order of each
  // will do; with one corner on the surface it comes last.
  void order(LatticeTetrahedron& t) const {
    const auto rank = [&](std::uint32_t v) { return nodes_.sign(v) > 0 ? 0 : nodes_.sign(v) < 0 ? 1 : 2; };
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
    // FlowMesher leaves room between the surface and the domain's sides.
    assert(nodes_.sign(lattice_.centre(cell)) > 0 && std::all_of(p.node.begin(), p.node.begin() + p.size, [&](std::uint32_t n) { return nodes_.sign(n) > 0; }));
    if (p.is_quad() || polyhedral_) return emit_pyramid(p, true, lattice_.centre(cell), result_.cells);
    Vec3 middle;
    for (const int c : kFaceCorners[static_cast<std::size_t>(f)]) middle += result_.points[lattice_.corner(cell, c)] * 0.25;
    const auto m = static_cast<std::uint32_t>(result_.points.size());
    result_.points.push_back(middle);
    result_.on_surface.push_back(0);
    for (int i = 0; i < p.size; ++i)
      result_.cells.add(CellShape::tetrahedron, {lattice_.centre(cell), p.node[static_cast<std::size_t>(i)], p.node[static_cast<std::size_t>((i + 1) % p.size)], m});
  }

  StuffedCells result_;
  const CellLattice& lattice_;
  LatticeNodes nodes_;
  const bool polyhedral_;
  const CreaseTarget& crease_;
  Progress& progress_;
  std::vector<CellKind> kind_;
  std::vector<std::uint64_t> cuts_;  // edges that the surface cuts, ascending
};

}  // namespace

StuffedCells stuff(const CellLattice& lattice, const LevelSet& set, int sign, MeshFlavour flavour, const CreaseTarget& crease, Progress& progress) {
  return Stuffing(lattice, set, sign, flavour, crease, progress).run();
}

}  // namespace burnish
