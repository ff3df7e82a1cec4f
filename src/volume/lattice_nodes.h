// Nodes of a lattice of cells and where they move: to corners and creases of the surface, then onto the surface along edges that it cuts near them. [T-HEX-3] [T-HEX-9]
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "burnish/core/vec.h"
#include "cell_lattice.h"

namespace burnish {

using LatticePlace = std::array<std::int64_t, 3>;
struct PlaceOnCrease {
  Vec3 at;
  bool is_corner = false;
};
// Where a node has to go that is near to a crease of the surface, seen by the size of its smallest cell (2^level finest ones); nothing where none is near. Called from many threads.
using CreaseTarget = std::function<std::optional<PlaceOnCrease>(const LatticePlace& node, int level)>;

// An edge between two nodes, as one number that does not depend on their order.
inline std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) { return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b); }

// [T-HEX-1] A tetrahedron of the lattice: the centre of a cell, an edge of one of its faces, the centre of the cell behind the face.
using LatticeTetrahedron = std::array<std::uint32_t, 4>;
template <class Visit>
void visit_tetrahedra_across(const CellLattice& lattice, std::size_t cell, int f, Visit&& visit) {
  const FacePolygon p = lattice.polygon(cell, f);
  for (int i = 0; i < p.size; ++i)
    visit(LatticeTetrahedron{lattice.centre(cell), p.node[static_cast<std::size_t>(i)], p.node[static_cast<std::size_t>((i + 1) % p.size)], lattice.centre(lattice.across(cell, f))});
}

class LatticeNodes {
 public:
  // At their places in the lattice. `sign`: 1 or -1 for the side of the surface that counts as positive. Places are kept in `points`, by reference, for the caller to add to.
  LatticeNodes(const CellLattice& lattice, const LevelSet& set, int sign, std::vector<Vec3>& points);

  std::size_t size() const { return sign_.size(); }
  // 0 for a node that has been moved to the surface.
  int sign(std::size_t node) const { return sign_[node]; }
  bool is_cut(std::uint32_t a, std::uint32_t b) const { return sign_[a] * sign_[b] < 0; }
  // As a part of the edge, from a.
  double cut_at(std::uint32_t a, std::uint32_t b) const { return phi_[a] / (phi_[a] - phi_[b]); }

  // [T-HEX-9] A place takes one node, the nearest: several have the same where a crease ends.
  void move_to_creases(const CreaseTarget& target);
  // [T-HEX-3] `cuts`: keys of the edges that the surface cuts, ascending. One node after the other: which goes first does not matter to the bounds.
  void move_to_cuts(const std::vector<std::uint64_t>& cuts);

 private:
  Vec3 place_in_lattice(std::uint32_t node) const;
  void find_levels();
  void put_back(std::uint32_t node);
  void move(std::uint32_t node, const Vec3& to);
  std::vector<std::uint32_t> deepest_at_corners() const;
  void take_back();
  std::vector<std::uint32_t> crowded(const std::vector<std::uint32_t>& cells) const;
  std::optional<std::uint32_t> farthest_of_crowded(const LatticeTetrahedron& t) const;
  double limit(std::uint32_t a, std::uint32_t b) const;

  const CellLattice& lattice_;
  std::vector<Vec3>& points_;
  std::vector<double> phi_;
  std::vector<std::int8_t> sign_;
  std::vector<std::uint8_t> level_;      // of the smallest cell at the node
  std::vector<std::uint8_t> moved_;
  std::vector<std::uint8_t> at_corner_;  // moved to a corner of the creases
  std::vector<std::uint32_t> stays_;     // deepest neighbours of these, ascending
};

}  // namespace burnish
