// Validation: is a surface worth keeping? The shape of its facets, and its topology, beside what inspection finds.
//
// `inspect` says whether a surface is a valid solid. Two valid solids can still differ in what a solver makes of
// them, by slivers, and in what they are, by a handle more. These are the numbers for that.
//
// Linear in the number of facets; same bits for any number of threads.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// Angles in degrees, lengths in units of the points, all in double. A facet counts as flat if its smallest altitude is
// below 1e-12 of its longest edge: its corners are collinear but for rounding. `inspect` decides the same exactly.
// The smallest angle of a facet is off by 1e-13 degrees at most, but for rounding of the coordinates themselves.
struct FacetShapes {
  std::size_t facets = 0;
  std::size_t flat_facets = 0;     // no area, or a repeated point; they have angle 0 and no ratio
  // Of the smallest angles of all facets; percentiles by nearest rank, to single precision.
  double smallest_angle = 0;
  double angle_of_thousandth = 0;  // 0.1 % of the facets have a smaller one
  double angle_of_hundredth = 0;   // 1 %
  double median_angle = 0;
  double share_below_10 = 0;       // of facets whose smallest angle is below 10 degrees
  double share_below_25 = 0;
  double largest_angle = 0;        // of any facet
  double largest_ratio = 0;        // of circumradius to twice the inradius: 1 for an equilateral facet
  double shortest_edge = 0;        // every facet's three edges count
  double mean_edge = 0;
  double longest_edge = 0;
};

FacetShapes facet_shapes(const TriangleSoup& soup);

// One component of the facets connected through edges. Points at which several fans of facets touch count once a fan, as if the
// surface was pulled apart there.
struct ComponentTopology {
  std::size_t facets = 0;
  std::int64_t euler_characteristic = 0;  // V - E + F
  bool closed = false;                    // every edge has two facets, which run it in opposite directions
  bool cavity = false;                    // closed, and its volume negative: the wall of a hole within a solid
  std::optional<std::int64_t> genus;      // handles, 1 - chi / 2; only of a closed component
};

struct SurfaceTopology {
  std::vector<ComponentTopology> components;  // in the order of their first facets
  std::size_t cavities = 0;
  std::int64_t euler_characteristic = 0;      // of all
  std::optional<std::int64_t> genus;          // of all, if all are closed
};

// Of a soup as `weld` returns it. Facets that repeat a point are left out.
SurfaceTopology surface_topology(const TriangleSoup& welded);

// The largest angle between the normals of two facets that share an edge, in degrees: near 180 the surface is folded onto
// itself. Edges with other than two facets, and flat facets, are left out; 0 if nothing is left.
double largest_fold(const TriangleSoup& welded);

struct Validation {
  Inspection inspection;
  FacetShapes shapes;
  SurfaceTopology topology;
  double largest_fold = 0;  // degrees
};

// All of the above.
Validation validate(const TriangleSoup& welded, const InspectOptions& options = {}, Progress& progress = no_progress());

}  // namespace burnish
