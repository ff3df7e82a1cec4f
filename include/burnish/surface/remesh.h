// Isotropic remeshing: facets of one size and good shape, on the same surface.
//
// Guarantees: a valid surface gives a valid one of the same topology, looked at with exact predicates. Shells are remeshed each on its own. One that
// intersects itself or another is done again with the facets there left as they are, from the second time on with rings of the result's facets around
// them, one more each time; those that are wrong at the sixth attempt or later stay whole. Points lie on the given surface, to rounding; creases and
// borders stay chains of edges and their corners stay bit for bit; same bits on every run and for any number of threads.
//
// Accuracy: the distance to the given surface is that of chords, about edge^2 / 8 over the radius of curvature. 99 % of the facets have no angle below
// 30 degrees, but where creases meet at smaller ones or facets are held. Method: Botsch & Kobbelt 2004 as in CGAL:
// edges longer than 4/3 are split and shorter than 4/5 collapsed, edges flipped towards six neighbours, points moved to their neighbours' centre in the
// tangent plane and projected.
#pragma once

#include <cstddef>
#include <string>

#include "burnish/core/progress.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

struct RemeshOptions {
  double edge = 0;           // the length aimed at, in the soup's units
  double crease_angle = 40;  // degrees between normals: sharper edges are creases
  int rounds = 3;            // of splits, collapses, flips and moves
};

struct RemeshedSurface {
  TriangleSoup soup;             // welded; shells in the order of their first facets; no groups, no colours
  std::size_t held_facets = 0;   // of the given surface, that stayed as they are because they would intersect or have no area when remeshed
  std::string why_not;           // one sentence if all facets had to stay: then the given surface is the result
};

// Remeshes a surface that is valid: 2-manifold, consistently oriented, without self-intersections; closed or not.
// Throws Error{usage} unless `edge` is positive and finite, Error{guarantee_unmet} if the soup is no oriented 2-manifold.
// Cost: about 15 us a facet of the larger one of both surfaces, on one thread; 1 KB of memory a facet.
RemeshedSurface remesh(const TriangleSoup& manifold, const RemeshOptions& options, Progress& progress = no_progress());

}  // namespace burnish
