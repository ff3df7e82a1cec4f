// Which facets of a soup carry nothing: degenerate ones, and copies of earlier ones.
#pragma once

#include <cstdint>
#include <vector>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

enum class FacetKind : std::uint8_t {
  proper,
  degenerate,  // repeats a point, or has exactly zero area
  duplicate,   // not degenerate; the same three points as an earlier facet that is not, in any order
};

// The kind of each facet of a welded soup. Linear in the number of facets.
std::vector<FacetKind> facet_kinds(const TriangleSoup& welded);

}  // namespace burnish
