// The union of bodies that overlap, exactly: facets are cut where they meet, and what lies inside goes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

struct SolidUnion {
  TriangleSoup soup;                  // welded; the surface of {winding number >= 1}
  std::vector<std::uint32_t> source;  // facet of the input with the same points, or kNoFacet
  std::vector<std::uint32_t> parent;  // a facet of the input that it is a part of
  std::size_t facets_cut = 0;         // of the input, that meet others
  std::size_t facets_absorbed = 0;    // of the input, that are no part of the union's surface at all
};

// The surface of the points around which `closed` winds at least once. `closed` is a closed chain, welded, its facets
// oriented; `intersecting` are its pairs of facets that intersect (self_intersecting_pairs).
//
// Facets that intersect are cut along their intersections, with exact constructions; facets that overlap in one plane are
// cut together. Pieces and uncut facets that are joined across edges with just two of them lie on one side of everything, so
// one ray decides for all of them. Facets that nothing touches come out bit for bit. New points are rounded to double
// precision, which may turn facets by as much; what a file holds is to be inspected. After Zhou et al., Mesh
// Arrangements for Solid Geometry, 2016. [T-UNION-1]
// Cost: some 50 us a pair. Deterministic.
SolidUnion unite(const TriangleSoup& closed, const std::vector<std::array<std::uint32_t, 2>>& intersecting,
                 Progress& progress = no_progress());

}  // namespace burnish
