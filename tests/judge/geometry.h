// What takes geometry to be said of a mesh; CGAL says it.
#pragma once

#include <cstddef>
#include <optional>

#include "stl.h"

namespace judge {

struct Embedding {
  // Pairs of facets that meet other than in a shared edge or point, by exact predicates; a facet without
  // area counts as one. Nothing for a mesh that is no 2-manifold: CGAL looks at halfedge meshes only.
  std::optional<std::size_t> self_intersections;
  // Closed, oriented, without self-intersections, and its components nest with alternating orientation.
  bool bounds_volume = false;
};

// `manifold`, `closed` and `oriented` are what was counted of the mesh. O(F log F) for tame meshes.
Embedding inspect_embedding(const Mesh& mesh, bool manifold, bool closed, bool oriented);

struct Distances {
  std::size_t samples = 0;  // 0: nothing to measure
  double rms = 0, max = 0;  // in model units
  double far_share = 0;     // share of the area that is farther than `far`
};

// Distances from points of `from` to the surface of `to`. Rms and share are over `samples` points, one at
// random in each of as many strips of equal area (the same in every run); the maximum is also over up to as
// many points of the mesh. In double precision: about 1e-15 of the coordinates' size.
Distances measure(const Mesh& from, const Mesh& to, std::size_t samples, double far);

// Surface area, in model units squared.
double area(const Mesh& mesh);

}  // namespace judge
