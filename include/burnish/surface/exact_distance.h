// ExactDistance: distances to a set of triangles without rounding errors.
//
// TriangleIndex::closest is off by a few roundings of the coordinates, and which of two facets at nearly the same
// distance it names is up to them. Here the answer is certain: a ball that holds the closest point for sure is
// searched for facets, floating-point bounds drop those that are farther for certain, and rational arithmetic
// decides among the rest. [T-COMP-2]
#pragma once

#include <cstdint>
#include <limits>
#include <memory>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

class TriangleIndex;

class ExactDistance {
 public:
  // Builds an index of its own. `soup` must outlive the object.
  explicit ExactDistance(const TriangleSoup& soup);
  // Uses an index of the same soup that is there already; it must outlive the object as well.
  ExactDistance(const TriangleSoup& soup, const TriangleIndex& index);
  ~ExactDistance();
  ExactDistance(const ExactDistance&) = delete;
  ExactDistance& operator=(const ExactDistance&) = delete;

  struct Closest {
    // The exact squared distance from the point as given to the closest facet, rounded to the nearest double.
    double squared_distance = std::numeric_limits<double>::infinity();
    // The point of that facet; its coordinates carry rounding errors.
    Vec3 point;
    // Among facets at exactly the same distance, the one with the lowest number. kNoFacet for an empty soup.
    std::uint32_t facet = kNoFacet;
  };
  // Facets without area count as the segments or points that they are; coordinates are below 1e150. Any number of threads
  // may ask at once.
  // About 30 us near the surface of a million facets: one to six of them go through rational arithmetic.
  Closest closest(const Vec3& p) const;

  // Infinity for an empty soup. The root of it is off by one rounding.
  double squared_distance(const Vec3& p) const { return closest(p).squared_distance; }

 private:
  const TriangleSoup& soup_;
  std::unique_ptr<const TriangleIndex> own_;
  const TriangleIndex& index_;
};

}  // namespace burnish
