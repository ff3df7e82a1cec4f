// EdgeTable: the edges of a welded soup, each with the facets that use it.
//
// An edge is an unordered pair of points {a, b}, stored with a < b. A facet with three different points
// uses three edges; a facet that repeats a point uses none. Nothing else is assumed: an edge may be used
// once (open), twice, or any number of times, in either direction.
//
// Example, all open edges:
//
//   const EdgeTable table(welded);
//   for (std::size_t e = 0; e < table.size(); ++e)
//     if (table.uses(e).size() == 1) mark(table.edge(e)[0], table.edge(e)[1]);
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

// One facet's use of an edge: side i of a facet runs from its corner i to its corner (i + 1) mod 3.
struct EdgeUse {
  std::uint32_t facet = 0;
  std::uint8_t side = 0;   // 0, 1 or 2
  bool forward = false;    // the facet runs from the edge's lower point to its upper one
};

// The points of an edge, lower index first.
using Edge = std::array<std::uint32_t, 2>;

class EdgeTable {
 public:
  // Linear in the number of facets: a counting sort by the lower point, then small sorts by the upper.
  // 24 bytes a facet for the uses and 12 bytes an edge. At most 2^32 / 3 facets.
  explicit EdgeTable(const TriangleSoup& welded);

  // Edges are numbered in lexicographic order of their points.
  std::size_t size() const { return edges_.size(); }
  const Edge& edge(std::size_t e) const { return edges_[e]; }
  // The uses of an edge: at least one, sorted by facet.
  std::span<const EdgeUse> uses(std::size_t e) const {
    return {uses_.data() + first_use_[e], first_use_[e + 1] - first_use_[e]};
  }

  // Used by one facet only: the surface ends here.
  bool is_open(std::size_t e) const { return uses(e).size() == 1; }
  // Used by three facets or more.
  bool is_non_manifold(std::size_t e) const { return uses(e).size() > 2; }
  // Used by two facets that run it in the same direction.
  bool is_misoriented(std::size_t e) const {
    const auto u = uses(e);
    return u.size() == 2 && u[0].forward == u[1].forward;
  }

  // The transposed table: the edge on each side of each facet, kNoEdge for facets that repeat a point.
  std::vector<std::array<std::uint32_t, 3>> edges_of_facets() const;
  static constexpr std::uint32_t kNoEdge = 0xffffffffu;

 private:
  std::size_t facet_count_ = 0;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> first_use_;  // CSR: uses of edge e are [first_use_[e], first_use_[e + 1])
  std::vector<EdgeUse> uses_;
};

// True if two of the facet's indices are equal.
inline bool repeats_point(const Facet& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; }

}  // namespace burnish
