// What can be said of a mesh by counting alone.
#pragma once

#include <cstddef>

#include "stl.h"

namespace judge {

struct Topology {
  std::size_t components = 0;           // of facets connected through edges
  std::size_t open_edges = 0;           // used by one facet
  std::size_t open_loops = 0;           // connected chains of them
  std::size_t non_manifold_edges = 0;   // used by three facets or more, or twice by one
  std::size_t non_manifold_points = 0;  // facets around them form more than one fan
  std::size_t misoriented_edges = 0;    // two facets run them the same way
  std::size_t repeating_facets = 0;     // facets that repeat a point

  bool closed() const { return open_edges == 0; }
  bool oriented() const { return misoriented_edges == 0; }
  // A 2-manifold, with a boundary where edges are open.
  bool manifold() const { return non_manifold_edges + non_manifold_points + repeating_facets == 0; }
};

// Counts over all facets, in O(F log F).
Topology count_topology(const Mesh& mesh);

// Volume in model units cubed, negative when turned inside out; meant for closed, oriented meshes.
double signed_volume(const Mesh& mesh);

// Diagonal of the bounding box of all points, in model units.
double diagonal(const Mesh& mesh);

}  // namespace judge
