// Inside or outside: one decision per region, taken from winding numbers.
//
// Lattice nodes joined by edges that no facet crosses form *regions*; the surface as given separates them,
// however it is oriented or doubled. Each region is sampled with the generalised winding number (one sample
// per cube of 2 x 2 x 2 blocks, at the node farthest from the surface). After the boundary has been
// capped (surface/boundary_caps.h) samples agree to a few hundredths and the region gets one sign. A region whose
// samples disagree leaks: its blocks are decided one by one, and node by node where a block disagrees with
// itself too.
#pragma once

#include <cstddef>
#include <cstdint>

#include "burnish/core/progress.h"
#include "burnish/octree/field.h"
#include "burnish/octree/grow.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

struct InsideField {
  Field<std::uint8_t> inside;         // 1 inside (winding number > 1/2), 0 outside
  std::size_t regions = 0;
  std::size_t ambiguous_regions = 0;  // that leaked
  std::size_t evaluations = 0;        // of the winding number
  // How clear the winding number w was that decided a node's side: |2 w - 1|, at most 1, times 255. 255 wherever the samples of a node's region
  // agree; of a block's part that was decided as a whole, that of its least clear node. In inside's layout; empty: no region is ambiguous.
  Field<std::uint8_t> certainty;
};

// `lattice_soup`: the capped soup in lattice coordinates; `distance` and `crossed` are fields over `grid`. A soup that is a closed chain
// of shared points (surface/winding.h) is judged by whole winding numbers, any other by fast ones from a TriangleIndex. Same result for any number of threads.
InsideField classify_nodes(const SurfaceOctree& grid, const Field<float>& distance,
                           const Field<std::uint8_t>& crossed, const TriangleSoup& lattice_soup,
                           Progress& progress = no_progress());

}  // namespace burnish
