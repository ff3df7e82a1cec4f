// DefectMap: where the defects of a soup are, gathered into what a person would call one defect.
//
// An inspection counts edges, facets and pairs; a hole of 44 open edges is 44 of them. The map gathers
// them into places to look at, the largest first:
//
//   kind                 one defect is                                  sorted by
//   -------------------  ---------------------------------------------  ----------------------
//   open_loop            a connected chain of open edges: a hole, rim   perimeter
//   non_manifold_edge    a connected chain of non-manifold edges        length
//   non_manifold_point   one point                                      facets that meet there
//   misoriented_edge     a connected chain of misoriented edges         length
//   degenerate_facet     one facet                                      longest side
//   duplicate_facet      one facet, beyond the first with its points    area
//   self_intersection    pairs of facets whose facets are connected     pairs
//                        through pairs or through shared points
//
// Chains are connected through points, so two holes that touch in a point are one defect, as they are in
// Defects::open_loops.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "burnish/surface/inspect.h"

namespace burnish {

enum class DefectKind : std::uint8_t {
  open_loop,
  non_manifold_edge,
  non_manifold_point,
  misoriented_edge,
  degenerate_facet,
  duplicate_facet,
  self_intersection,
};
inline constexpr std::size_t kDefectKinds = 7;
inline constexpr std::array<DefectKind, kDefectKinds> kAllDefectKinds = {
    DefectKind::open_loop,        DefectKind::non_manifold_edge, DefectKind::non_manifold_point,
    DefectKind::misoriented_edge, DefectKind::degenerate_facet,  DefectKind::duplicate_facet,
    DefectKind::self_intersection};

// The name of a kind in reports and files, e.g. "open_loop".
std::string_view name(DefectKind kind);

// One place to look at. Lengths and areas are in the model's units and their square.
struct LocatedDefect {
  DefectKind kind = DefectKind::open_loop;
  // Chains: mean of the edges' middles, weighted by length. Facets: the centroid. Self-intersections: mean
  // over the pairs of the middle of where the two facets' boxes overlap. Always inside `box`.
  Vec3 position;
  // Of the chain, the point or the facet; of a self-intersection, of where its pairs' boxes overlap.
  Box3 box;
  // Chains: edges. Points: facets that use it. Facets: 1. Self-intersections: pairs.
  std::size_t count = 0;
  // Chains: length of all edges, for an open loop its perimeter. Facets: the longest side. Otherwise 0.
  double length = 0;
  // Open loops: of the cone from `position` over its edges, exact for a flat loop that `position` sees
  // whole, larger otherwise. Duplicate facets: theirs. Self-intersections: of all facets that take part.
  // Otherwise 0.
  double area = 0;
  // The lowest index of a facet that takes part.
  std::uint32_t facet = 0;
};

struct DefectMap {
  // In the order of kinds; those of a kind the largest first, equal ones in the order of their points or
  // facets.
  std::vector<LocatedDefect> defects;
  // The facets that intersect others, ascending: the elements of DefectKind::self_intersection.
  std::vector<std::uint32_t> intersecting_facets;
  // For each kind, the index into `defects` of each of its elements, which are those of DefectiveElements
  // (open edges, ..., duplicate facets, in the order of kinds) and `intersecting_facets`.
  std::array<std::vector<std::uint32_t>, kDefectKinds> defect_of_element;

  // The defects of one kind. O(log n).
  std::span<const LocatedDefect> of(DefectKind kind) const;
};

// Locates what `inspection`, made of the same soup with InspectOptions::elements, has found; of
// self-intersecting pairs, those it collected. The same bits on any number of threads.
//
// Linear in points, facets and elements, n log n in the number of defects. 8 bytes a point and up to 9
// bytes a facet while it runs, next to nothing for kinds without elements; about 110 bytes a defect and 4
// bytes an element stay.
DefectMap locate_defects(const TriangleSoup& welded, const Inspection& inspection);

}  // namespace burnish
