// Shells: the pieces of a soup that are connected through shared edges, and which of them lies inside which.
//
// A shell whose directed edges cancel (a closed chain) has an integer winding number everywhere off itself:
// how often it wraps around a point, counted positive where it is oriented outwards. What the other shells wrap
// around a shell says what it is:
//
//   others wrap it 0 times, volume > 0     a body of its own
//   others wrap it once, volume < 0        the wall of a cavity
//   others wrap it once, volume > 0        a body inside a body: solid on solid
//   others wrap it 0 times, volume < 0     a body that is turned inside out
//
// Winding numbers are counted along vertical rays, with one rule for both facets of a shared edge, so that no
// ray slips between two facets or meets an edge twice. Same bits for any number of threads.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "burnish/core/union_find.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

struct Shell {
  std::size_t facets = 0;
  double area = 0;
  double volume = 0;      // signed; means something only if `closed`
  Box3 box;
  Vec3 at;                // a point on it: the centroid of its largest facet
  bool closed = false;    // its directed edges cancel
  // How often the closed shells other than itself wrap around it, summed; and those that do, by number, with their
  // winding numbers (never 0), ascending. Where it straddles others, those count that most of its samples are in.
  int wrapped = 0;
  std::vector<std::pair<std::uint32_t, int>> around;
};

struct Shells {
  std::vector<std::uint32_t> of_facet;  // the shell of each facet
  std::vector<Shell> shells;            // in the order of their first facets
};

// The shells of a welded soup. A facet that repeats a point is a shell of its own. Cost: linear, and a few
// microseconds per shell; with one shell nothing is wrapped and no ray is cast.
Shells find_shells(const TriangleSoup& welded);

// Whether a shell is neither of the first two kinds above.
bool is_misnested(const Shell& shell);

// Shells of a closed, self-intersection-free surface whose orientation contradicts where they lie: those that are
// misnested. CGAL's does_bound_a_volume is false exactly when there are any.
std::size_t count_misnested(const Shells& shells);

// The soup's points, joined by its facets: pieces that touch in a point alone are one set, where they are several shells. Points that no facet
// uses are sets of their own.
UnionFind connected_points(const TriangleSoup& soup);

// How many sets the points of its facets are. As many as there are shells, if no two of them share a point.
std::size_t count_connected(const TriangleSoup& soup);

}  // namespace burnish
