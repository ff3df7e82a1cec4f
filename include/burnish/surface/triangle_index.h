// TriangleIndex: closest-point queries and fast winding numbers on a set of triangles.
//
// A binary bounding-volume hierarchy over the facets, split at the median of the longest side of the
// centroids' box: O(n log n) to build, the same tree for any number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "burnish/core/large_array.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// The point of triangle abc closest to p. Robust for slivers: a triangle without area is its longest edge.
Vec3 closest_point_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

// The signed solid angle of triangle abc seen from p, over 4 pi: in [-1/2, 1/2], positive when the triangle
// turns its back to p, i.e. when p is on the side of an outward-oriented facet's interior.
// Van Oosterom & Strackee 1983, eq. (8). 0 for p in the triangle's plane.
double solid_angle_fraction(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

class TriangleIndex {
 public:
  // Holds copies of what it needs; `soup` may be gone afterwards.
  explicit TriangleIndex(const TriangleSoup& soup);

  struct Closest {
    Vec3 point;
    double squared_distance = std::numeric_limits<double>::infinity();
    std::uint32_t facet = 0xffffffffu;
  };
  // The closest facet within sqrt(`within_squared`); among equals, the one the tree meets first.
  // Without any, `facet` is 0xffffffff. 1 to 2 us near the surface of a million facets.
  Closest closest(const Vec3& p, double within_squared = std::numeric_limits<double>::infinity()) const;

  // The closest of the facets that `accept(facet)` holds for, nearer than sqrt(`within_squared`); among equals, the first in
  // the tree's order, i.e. that of facets_near.
  template <class Accept>
  Closest closest_of(const Vec3& p, double within_squared, Accept&& accept) const;
  // The same, where `accept` holds for no facet below a node that `enter(node)` does not hold for. With a `spread` less than 1 any facet whose
  // squared distance is the least one's at most 1 / spread times may be found, nothing only if there is nothing.
  template <class Accept, class Enter>
  Closest closest_of(const Vec3& p, double within_squared, Accept&& accept, Enter&& enter, double spread = 1) const;

  // What a box holds, for all nodes of the tree: the box of `point(facet)` of the facets below each.
  template <class Point>
  std::vector<Box3> boxes_of_nodes(Point&& point) const;

  // Appends every facet within sqrt(`within_squared`) of p to `facets`, and others from the same leaves of the tree,
  // in the tree's order.
  void facets_near(const Vec3& p, double within_squared, std::vector<std::uint32_t>& facets) const;

  struct Hit {
    double distance = std::numeric_limits<double>::infinity();
    std::uint32_t facet = 0xffffffffu;
  };
  // The first facet that a ray meets, from either side; a ray through an edge may pass between its facets by rounding.
  // Moeller & Trumbore 1997. `direction` has length 1.
  Hit first_hit(const Vec3& origin, const Vec3& direction) const;
  // The same, of facets nearer than `within`.
  Hit first_hit(const Vec3& origin, const Vec3& direction, double within) const;

  // The generalised winding number (Jacobson et al. 2013) by the hierarchy of Barill et al. 2018: exact solid
  // angles of near facets, first-order Taylor expansions of the dipole field for groups farther than
  // `kBeta` radii. Error up to 0.03 (measured, in a ball); an integer for closed surfaces up to that.
  double winding_number(const Vec3& p) const;

  std::size_t facet_count() const { return facet_ids_.size(); }
  std::size_t bytes() const;

 private:
  struct Node {
    Vec3 lower, upper;
    std::uint32_t first = 0;   // leaf: first facet slot; inner: index of the right child (left is next)
    std::uint32_t count = 0;   // leaf: facets; inner: 0
  };
  // Expansion of a node's dipole field about its area-weighted centre.
  struct Moments {
    Vec3 center;
    double radius_squared = 0;          // of a ball about `center` that holds all its facets, times kBeta^2
    Vec3 area_normal;                   // sum of vector areas
    std::array<double, 9> first{};      // sum of (centroid - center) outer vector area, row-major
  };

  struct Subtree {
    std::uint32_t root = 0, begin = 0, end = 0;  // first node; facet slots
  };

  struct Entry {
    std::uint32_t node;
    double bound;  // of the squared distance, from below
  };

  double bound(std::uint32_t node, const Vec3& p) const {
    const Vec3 d = max(max(nodes_[node].lower - p, p - nodes_[node].upper), Vec3{});
    return squared_norm(d);
  }
  // Calls `visit(first slot, last)` for every leaf whose box is within the squared distance `limit()`, which may become less, nearer ones before
  // farther ones where boxes do not overlap. Nothing below nodes that `enter(node)` does not hold for.
  template <class Limit, class Visit, class Enter>
  void visit_leaves(const Vec3& p, Limit&& limit, Visit&& visit, Enter&& enter) const;
  template <class Limit, class Visit>
  void visit_leaves(const Vec3& p, Limit&& limit, Visit&& visit) const {
    visit_leaves(p, limit, visit, [](std::uint32_t) { return true; });
  }
  // The closest point of one facet, and its squared distance; infinity if it is surely above `limit`.
  double closest_in_slot(const Vec3& p, std::uint32_t slot, double limit, Vec3& q) const;

  static std::size_t nodes_in_subtree(std::size_t facets);
  std::array<Subtree, 2> split(const Subtree& tree, const LargeArray<Vec3>& centroids);
  void build(const Subtree& tree, const LargeArray<Vec3>& centroids);
  void summarise(std::size_t node, std::vector<double>& area);
  void join_moments(std::size_t node, std::size_t left, std::size_t right, const std::vector<double>& area);
  double sum_moments(std::size_t leaf);

  static constexpr double kBeta = 3.0;
  static constexpr double kRounding = 1 + 1e-12;  // of the distance to a box against that to what is in it
  LargeArray<Node> nodes_;
  LargeArray<Moments> moments_;
  std::vector<std::uint32_t> facet_ids_;          // slot -> facet of the soup
  LargeArray<std::array<Vec3, 3>> corners_;      // slot -> triangle
};

template <class Accept>
TriangleIndex::Closest TriangleIndex::closest_of(const Vec3& p, double within_squared, Accept&& accept) const {
  return closest_of(p, within_squared, accept, [](std::uint32_t) { return true; });
}

template <class Point>
std::vector<Box3> TriangleIndex::boxes_of_nodes(Point&& point) const {
  std::vector<Box3> boxes(nodes_.size());
  for (std::size_t i = nodes_.size(); i-- > 0;) {  // children stand behind their parents
    const Node& node = nodes_[i];
    for (std::uint32_t s = node.first; s < node.first + node.count; ++s) boxes[i].extend(point(facet_ids_[s]));
    if (node.count > 0) continue;
    boxes[i].lower = min(boxes[i + 1].lower, boxes[node.first].lower);
    boxes[i].upper = max(boxes[i + 1].upper, boxes[node.first].upper);
  }
  return boxes;
}

template <class Accept, class Enter>
TriangleIndex::Closest TriangleIndex::closest_of(const Vec3& p, double within_squared, Accept&& accept, Enter&& enter, double spread) const {
  Closest best;
  best.squared_distance = within_squared;
  std::uint32_t best_slot = 0xffffffffu;
  double limit = within_squared * kRounding;
  visit_leaves(p, [&] { return limit; }, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t s = begin; s < end; ++s) {
      if (!accept(facet_ids_[s])) continue;
      Vec3 q;
      const double d2 = closest_in_slot(p, s, best.squared_distance, q);
      if (!(d2 < best.squared_distance || (d2 == best.squared_distance && best_slot != 0xffffffffu && s < best_slot))) continue;
      best = {q, d2, facet_ids_[s]};
      best_slot = s;
      limit = d2 * kRounding * spread;
    }
  }, enter);
  return best;
}

template <class Limit, class Visit, class Enter>
void TriangleIndex::visit_leaves(const Vec3& p, Limit&& limit, Visit&& visit, Enter&& enter) const {
  if (nodes_.empty()) return;
  std::array<Entry, 128> stack;  // depth is log2(n / 4) and each step down pushes one
  std::size_t top = 0;
  Entry here{0, bound(0, p)};
  while (true) {
    if (here.bound <= limit() && enter(here.node)) {
      const Node& node = nodes_[here.node];
      if (node.count == 0) {
        Entry near{here.node + 1, bound(here.node + 1, p)}, far{node.first, bound(node.first, p)};
        if (far.bound < near.bound) std::swap(near, far);
        if (far.bound <= limit()) stack[top++] = far;
        here = near;
        continue;
      }
      visit(node.first, node.first + node.count);
    }
    if (top == 0) return;
    here = stack[--top];
  }
}

}  // namespace burnish
