// The zero surface of a level set by Delaunay refinement: well-shaped facets of the size that is asked for.
//
// **What it is.** The restricted Delaunay triangulation of the surface phi = 0 (Boissonnat & Oudot 2005): the facets between
// tetrahedra whose circumcentres lie inside and outside of it. Points are added on the surface until all facets are small, near to it and
// well-shaped. It is the boundary of a set of tetrahedra, so it is closed and oriented whatever happens, and facets
// of one triangulation do not intersect.
//
// **What could go wrong, and what is done.** A mesher that starts from a few points finds one of 21 spheres and calls that clean. Here it starts from the
// zero crossings of the lattice, thinned to the size of facets, with several points on every component however small. Afterwards the numbers of components
// and the Euler characteristic are compared with what the signs of the level set say, as for marching tetrahedra (levelset/topology.h). If they differ, facets are made
// smaller by half, once, and only of surfaces below 25,000 facets. What then still differs is a failure, and the caller has the other extractor: within a cell the
// interpolant may have a handle where the tetrahedra have none.
//
// **It ends.** There are limits, in counts, and not in seconds: the same input gives the same result. One thread; the same bits on every run.
//
// Accuracy: points are on the zero of the trilinear interpolant (`sample`) to 1e-5 cells, facets within `distance` of it, both but for creases.
// Measured cost: see docs/theory.md [T-DELAUNAY-5].
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/levelset/level_set.h"
#include "burnish/levelset/topology.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// Lengths are cells of the finest level.
struct DelaunayOptions {
  double edge = 1;  // mean length of edges, where nothing else asks for shorter ones
  // > 0: edges are as long as `largest_edge` where the surface is flat enough for their chords to stay this near to it, `edge` where it is not.
  // In between they grow by at most 0.3 of the distance along the surface.
  double edge_tolerance = 0;
  double largest_edge = 8;
  double distance = 0.1;   // largest distance between a facet's circumcentre and the surface along its normal
  double min_angle = 25;   // degrees, of facets away from creases; more than 30 is not promised to end within the limits
  // Polylines to be edges of the result, near the surface; closed if first == last. They may be jagged, meet, and come near to each other. Where they come nearer
  // than half an edge without meeting, and at angles below 20 degrees, they are not protected. Each is followed within an edge's chord.
  std::vector<std::vector<Vec3>> creases = {};
  // Limits; 0: derived from the surface's area, so that no surface which these options describe meets them.
  std::size_t max_points = 0;
  std::size_t max_oracle_calls = 0;  // evaluations of the interpolant
};

struct DelaunaySurface {
  TriangleSoup soup;                    // lattice coordinates, welded; facets face from inside (phi > 0) to outside
  std::vector<std::uint8_t> on_crease;  // 1 for points that are on a protected polyline; one per point
  LevelSetTopology wanted;              // the level set's, if it has a surface
  std::size_t points = 0;               // that the mesher used, over all attempts
  std::size_t oracle_calls = 0;         // over all attempts
  int attempts = 0;
  std::string failure;                  // empty: the soup is closed, 2-manifold and has the level set's components. Otherwise there is no soup
};

// Meshes phi = 0. Values that are not numbers count as outside, as does everything beyond the domain; a level set without a surface gives an empty
// soup. Throws Error{interrupted}, Error{time_limit} from `progress`.
DelaunaySurface extract_delaunay(const LevelSet& level_set, const DelaunayOptions& options = {}, Progress& progress = no_progress());

// About how many facets that will have, from the number of lattice edges that the surface crosses: within 25 % without `edge_tolerance`
// and creases. With `edge_tolerance` an upper bound. Costs a pass over the stored nodes.
std::size_t predicted_facets(const LevelSet& level_set, const DelaunayOptions& options = {});

}  // namespace burnish
