// On which side of the closest facet a point is.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "burnish/surface/triangle_soup.h"

namespace burnish::detail {

// Pseudonormals of a soup with shared points (Baerentzen & Aanaes 2005): of a facet its normal, of an edge the sum of its two
// facets' unit normals, of a vertex the sum of its facets' weighted by their angles. An edge with one facet, or with more
// than two, takes that of the facet asked about.
class PseudoNormals {
 public:
  explicit PseudoNormals(const TriangleSoup& soup);
  // Whether p is behind facet f, which is closest to it.
  bool is_behind(const Vec3& p, std::uint32_t f) const;

 private:
  const TriangleSoup& soup_;
  std::vector<Vec3> of_points_;
  std::vector<std::array<std::uint32_t, 3>> across_;  // the facet across each side, or kNoFacet
};

}  // namespace burnish::detail
