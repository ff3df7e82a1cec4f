// Pairing facets across edges, so that a soup falls into 2-manifold pieces.
#pragma once

#include <cstdint>
#include <vector>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

struct ManifoldPieces {
  TriangleSoup soup;                    // same facets in the same order; points doubled where fans share them
  std::vector<std::uint32_t> original;  // point of the input behind each point
  std::size_t points_split = 0;         // doubles made
  std::size_t cut_edges = 0;            // edges with more than two uses, or misoriented
  bool manifold = false;                // no edge of `soup` has more than two uses or is misoriented
};

// Splits the points of an oriented, welded soup so that around each there is one fan of facets, joined across edges
// with one facet on each side. At an edge with more than two facets, those pair up that bound the same wedge of
// material: bodies that touch along an edge come apart there, and a sheet that ends on a body is cut off. A one-sided
// surface is cut along the seam where its orientation changes. `manifold` is false for what cannot be cut that way: an
// edge with more than two facets around both ends of which the same facets join. Linear in the number of facets.
ManifoldPieces split_into_manifold_pieces(const TriangleSoup& oriented);

}  // namespace burnish
