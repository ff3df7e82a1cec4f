#include "lattice_nodes.h"

#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/octree/field.h"

namespace burnish {
namespace {

// How near to a node, as a part of an edge, a cut moves the node: Labelle & Shewchuk's, for angles of 10.7 to 164.8 degrees.
constexpr double kLong = 0.24999, kShort = 0.41189;
constexpr double kLarger = 1.5;       // of the smallest cell at a node that has larger ones too: the edge that it may move along
constexpr double kCreaseReach = 1.2;  // half sides of a node's smallest cell: no node farther from the surface is near a crease
constexpr double kCrowded = 0.1;      // of a tetrahedron's volume: less may not be left of it when its nodes have moved
constexpr double kFar = 6;            // half sides of a cell: its tetrahedra reach 3 of them, to nodes that are within 2.4 of the surface if they have moved
constexpr double kLastOfAll = 1e-9;   // what a way to a corner counts, so that another node goes back first
constexpr std::size_t kCellsAtATime = 4096;

// What `list(cell, found)` finds in all cells, ascending.
template <class T, class List>
std::vector<T> listed(std::size_t cells, List&& list) {
  std::vector<std::vector<T>> found((cells + kCellsAtATime - 1) / kCellsAtATime);
  parallel_ranges(cells, kCellsAtATime, [&](std::size_t begin, std::size_t end) {
    for (std::size_t cell = begin; cell < end; ++cell) list(cell, found[begin / kCellsAtATime]);
  });
  std::vector<T> all;
  for (const std::vector<T>& part : found) all.insert(all.end(), part.begin(), part.end());
  std::sort(all.begin(), all.end());
  return all;
}

template <class Visit>
void visit_tetrahedra(const CellLattice& lattice, std::size_t cell, Visit&& visit) {
  for (int f = 0; lattice.exists(cell) && f < 6; ++f)
    if (lattice.owns(cell, f) && lattice.across(cell, f) != Octree::kNone) visit_tetrahedra_across(lattice, cell, f, visit);
}

}  // namespace

LatticeNodes::LatticeNodes(const CellLattice& lattice, const LevelSet& set, int sign, std::vector<Vec3>& points)
    : lattice_(lattice), points_(points), phi_(lattice.nodes()), sign_(lattice.nodes()), moved_(lattice.nodes()), at_corner_(lattice.nodes()) {
  points_.resize(lattice.nodes());
  parallel_for(lattice.nodes(), [&](std::size_t i) {
    const LatticePlace p = lattice_.position(static_cast<std::uint32_t>(i));
    const LatticeNode node{static_cast<std::int32_t>(p[0]), static_cast<std::int32_t>(p[1]), static_cast<std::int32_t>(p[2])};
    phi_[i] = sign * node_value(set.octree(), set.phi, node);
    put_back(static_cast<std::uint32_t>(i));
  });
  find_levels();
}

void LatticeNodes::find_levels() {
  level_.assign(lattice_.nodes(), 0xff);
  for (std::size_t cell = 0; cell < lattice_.cells(); ++cell) {
    const auto level = static_cast<std::uint8_t>(lattice_.tree().level(cell));
    level_[lattice_.centre(cell)] = static_cast<std::uint8_t>(level - lattice_.hangs(cell));  // its neighbours' cells end there
    for (int c = 0; c < 8; ++c) level_[lattice_.corner(cell, c)] = std::min(level_[lattice_.corner(cell, c)], level);
  }
}

Vec3 LatticeNodes::place_in_lattice(std::uint32_t node) const {
  const LatticePlace p = lattice_.position(node);
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

void LatticeNodes::put_back(std::uint32_t node) {
  points_[node] = place_in_lattice(node);
  sign_[node] = static_cast<std::int8_t>((phi_[node] > 0) - (phi_[node] < 0));
  moved_[node] = at_corner_[node] = 0;
}

void LatticeNodes::move(std::uint32_t node, const Vec3& to) {
  points_[node] = to;
  sign_[node] = 0;
  moved_[node] = 1;
}

void LatticeNodes::move_to_creases(const CreaseTarget& target) {
  std::vector<std::optional<PlaceOnCrease>> place(size());
  parallel_for(size(), [&](std::size_t i) {
    if (std::abs(phi_[i]) <= kCreaseReach * (1 << level_[i])) place[i] = target(lattice_.position(static_cast<std::uint32_t>(i)), level_[i]);
  });
  std::vector<std::tuple<Vec3, double, std::uint32_t>> wishes;  // place, square of the way there, node
  for (std::uint32_t i = 0; i < size(); ++i)
    if (place[i]) wishes.emplace_back(place[i]->at, squared_norm(place[i]->at - points_[i]), i);
  std::sort(wishes.begin(), wishes.end());
  for (std::size_t w = 0; w < wishes.size(); ++w) {
    const auto& [at, way, node] = wishes[w];
    if (w > 0 && std::get<0>(wishes[w - 1]) == at) continue;
    move(node, at);
    at_corner_[node] = place[node]->is_corner;
  }
  stays_ = deepest_at_corners();
  for (const std::uint32_t node : stays_) put_back(node);
  take_back();
}

// A corner of the solid that sticks out is lost if all that is left around it is on the surface: of the neighbours of a node at a corner the deepest one stays where it is.
std::vector<std::uint32_t> LatticeNodes::deepest_at_corners() const {
  using Neighbour = std::tuple<std::uint32_t, double, std::uint32_t>;  // of a corner: the corner, minus phi, the node
  if (std::find(at_corner_.begin(), at_corner_.end(), 1) == at_corner_.end()) return {};
  const std::vector<Neighbour> all = listed<Neighbour>(lattice_.cells(), [&](std::size_t cell, std::vector<Neighbour>& found) {
    visit_tetrahedra(lattice_, cell, [&](const LatticeTetrahedron& t) {
      for (const std::uint32_t a : t) {
        if (!at_corner_[a]) continue;
        for (const std::uint32_t b : t)
          if (!at_corner_[b] && phi_[b] > 0) found.emplace_back(a, -phi_[b], b);
      }
    });
  });
  std::vector<std::uint32_t> deepest;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (i == 0 || std::get<0>(all[i]) != std::get<0>(all[i - 1])) deepest.push_back(std::get<2>(all[i]));
  std::sort(deepest.begin(), deepest.end());
  return deepest;
}

// [T-HEX-3] A tetrahedron that has lost nearly all of its volume has the node back that moved farthest; one at a corner of the creases last of all.
void LatticeNodes::take_back() {
  const std::vector<std::uint32_t> cells = listed<std::uint32_t>(lattice_.cells(), [&](std::size_t cell, std::vector<std::uint32_t>& found) {
    if (std::abs(phi_[lattice_.centre(cell)]) > kFar * (1 << lattice_.tree().level(cell))) return;
    bool any = false;
    visit_tetrahedra(lattice_, cell, [&](const LatticeTetrahedron& t) { any = any || std::any_of(t.begin(), t.end(), [&](std::uint32_t node) { return moved_[node] != 0; }); });
    if (any) found.push_back(static_cast<std::uint32_t>(cell));
  });
  for (std::vector<std::uint32_t> back = crowded(cells); !back.empty(); back = crowded(cells))
    for (const std::uint32_t node : back) put_back(node);
}

std::vector<std::uint32_t> LatticeNodes::crowded(const std::vector<std::uint32_t>& cells) const {
  return listed<std::uint32_t>(cells.size(), [&](std::size_t i, std::vector<std::uint32_t>& found) {
    visit_tetrahedra(lattice_, cells[i], [&](const LatticeTetrahedron& t) {
      if (const std::optional<std::uint32_t> node = farthest_of_crowded(t)) found.push_back(*node);
    });
  });
}

std::optional<std::uint32_t> LatticeNodes::farthest_of_crowded(const LatticeTetrahedron& t) const {
  if (std::none_of(t.begin(), t.end(), [&](std::uint32_t node) { return moved_[node] != 0; })) return std::nullopt;
  const auto way = [&](std::uint32_t node) { return norm(points_[node] - place_in_lattice(node)) / (1 << level_[node]) * (at_corner_[node] ? kLastOfAll : 1); };
  const std::uint32_t node = *std::max_element(t.begin(), t.end(), [&](std::uint32_t a, std::uint32_t b) { return std::pair(way(a), a) < std::pair(way(b), b); });
  if (!(way(node) > 0)) return std::nullopt;
  const auto volume = [&](auto&& at) { return dot(cross(at(t[1]) - at(t[0]), at(t[2]) - at(t[0])), at(t[3]) - at(t[0])); };
  const double now = volume([&](std::uint32_t n) { return points_[n]; }), before = volume([&](std::uint32_t n) { return place_in_lattice(n); });
  if (now * (before < 0 ? -1 : 1) >= kCrowded * std::abs(before)) return std::nullopt;
  return node;
}

// Measured by the smallest cell at the node: what a large cell can bear may turn a small one over.
double LatticeNodes::limit(std::uint32_t a, std::uint32_t b) const {
  const bool is_long = lattice_.is_centre(a) == lattice_.is_centre(b);
  const double edge = kLarger * (is_long ? 2 : std::numbers::sqrt3) * (1 << level_[a]);
  return (is_long ? kLong : kShort) * std::min(1.0, edge / norm(place_in_lattice(b) - place_in_lattice(a)));
}

void LatticeNodes::move_to_cuts(const std::vector<std::uint64_t>& cuts) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends;  // node, the other end
  for (const std::uint64_t cut : cuts) {
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
      const Vec3 step = (place_in_lattice(ends[i].second) - place_in_lattice(node)) * cut_at(node, ends[i].second);
      if (!nearest || squared_norm(step) < squared_norm(*nearest)) nearest = step;
    }
    if (!nearest || std::binary_search(stays_.begin(), stays_.end(), node)) continue;
    move(node, points_[node] + *nearest);
  }
  take_back();
}

}  // namespace burnish
