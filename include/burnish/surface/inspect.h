// Inspection: what is wrong with a triangle soup, in numbers.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/core/vec.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// Counts over a welded soup. An edge is an unordered pair of points used by a facet that has three
// different points; facets that have not take part in nothing but `degenerate_facets`. Facets that are
// degenerate because their three points are collinear keep their edges, which close the surface like any
// other's, and stay out of duplicates and self-intersections. Duplicates take part in everything, so the
// edges of a facet that comes twice in a closed surface are used by three facets.
struct Defects {
  std::size_t facets = 0;
  std::size_t points = 0;
  std::size_t components = 0;           // of facets connected through shared edges
  std::size_t degenerate_facets = 0;    // repeated point, or collinear (exactly zero area)
  std::size_t duplicate_facets = 0;     // beyond the first with the same three points
  std::size_t open_edges = 0;           // used by one facet
  std::size_t open_loops = 0;           // connected chains of open edges
  std::size_t non_manifold_edges = 0;   // used by three or more facets
  std::size_t non_manifold_points = 0;  // whose facets form more than one edge-connected fan
  std::size_t misoriented_edges = 0;    // used by two facets that run it in the same direction
  // Shells turned inside out, or solid inside a solid (surface/shells.h). Looked for only where nothing of the
  // above and no self-intersection is wrong.
  std::size_t misnested_shells = 0;
  std::size_t self_intersecting_pairs = 0;  // of facets; exact; sharing an edge or a point alone is none
  bool self_intersections_counted = false;
  double volume = 0;                    // signed; means something only when closed and oriented
  double area = 0;
  double mean_edge = 0;
  Box3 box;

  // Closed, 2-manifold, consistently oriented.
  bool closed_manifold() const {
    return facets > 0 && degenerate_facets == 0 && duplicate_facets == 0 && open_edges == 0 &&
           non_manifold_edges == 0 && non_manifold_points == 0 && misoriented_edges == 0;
  }
  // Closed, 2-manifold, oriented outwards, bounding a volume, free of self-intersections.
  bool valid_solid() const {
    return closed_manifold() && volume > 0 && misnested_shells == 0 && self_intersections_counted && self_intersecting_pairs == 0;
  }
  // What a valid sheet is: 2-manifold with open edges, consistently oriented, free of self-intersections.
  bool valid_sheet() const {
    return facets > 0 && open_edges > 0 && degenerate_facets == 0 && duplicate_facets == 0 && non_manifold_edges == 0 &&
           non_manifold_points == 0 && misoriented_edges == 0 && self_intersections_counted && self_intersecting_pairs == 0;
  }
};

// An edge of a welded soup that is defective in some way, and the first facet that uses it.
struct DefectiveEdge {
  std::array<std::uint32_t, 2> points{};  // the lower one first
  std::uint32_t facet = 0;
};

// What `Defects` counts, one by one: edges in lexicographic order of their points, the others ascending.
// As long as the counts say: 12 bytes an edge, 4 bytes a point or facet.
struct DefectiveElements {
  std::vector<DefectiveEdge> open_edges;
  std::vector<DefectiveEdge> non_manifold_edges;
  std::vector<DefectiveEdge> misoriented_edges;
  std::vector<std::uint32_t> non_manifold_points;
  std::vector<std::uint32_t> degenerate_facets;
  std::vector<std::uint32_t> duplicate_facets;
};

struct InspectOptions {
  bool self_intersections = true;
  // Also list the defective edges, points and facets, for `locate_defects`.
  bool elements = false;
  // Stop collecting (not counting) self-intersecting pairs beyond this many: the first in sorted order stay.
  std::size_t max_collected_pairs = 1u << 20;
};

struct Inspection {
  Defects defects;
  DefectiveElements elements;  // empty unless InspectOptions::elements asks for them
  // Facet pairs that intersect, each once, smaller index first, sorted. See max_collected_pairs.
  std::vector<std::array<std::uint32_t, 2>> self_intersections;
};

// Where the search for self-intersections stops, and with it the count: a soup of n facets can hold n^2 / 2
// of them. A count of exactly this many means "at least".
inline constexpr std::size_t kMaxSelfIntersections = std::size_t{1} << 24;

// The points whose facets form more than one edge-connected fan, ascending.
std::vector<std::uint32_t> non_manifold_points(const TriangleSoup& welded);

// Inspects a soup as `weld` returns it. Self-intersections are decided by CGAL's exact predicates.
Inspection inspect(const TriangleSoup& welded, const InspectOptions& options = {},
                   Progress& progress = no_progress());

// All pairs of facets that intersect other than in a shared edge or a shared point, each once, smaller
// index first, sorted. Shared points are known by their index. What counts, by the points two facets share:
//
//   none   any common point, touching included
//   one    any common point besides the shared one
//   two    folded flat onto each other: coplanar, on the same side of the shared edge
//   three  always (duplicates)
//
// Decided exactly, whatever the coordinates. Degenerate facets are left out. O((n + candidates) log n) where
// candidates are pairs whose boxes overlap; stops at max_pairs pairs, then on one
// thread: which pairs those are does not depend on the number of threads either.
std::vector<std::array<std::uint32_t, 2>> self_intersecting_pairs(
    const TriangleSoup& welded, Progress& progress = no_progress(),
    std::size_t max_pairs = kMaxSelfIntersections);

}  // namespace burnish
