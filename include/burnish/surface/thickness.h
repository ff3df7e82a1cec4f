// How thick a solid is behind its surface.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// The thickness of walls, sampled: from points spread over the surface by area (stratified, deterministic) rays run inwards
// along the normal to the first facet. Counted is what they run through where that facet faces away and is
// within 60 degrees of parallel: a wall, not a wedge. Ascending, model units; each entry stands for 1 / `samples` of the
// area, so that fewer entries than samples are usual. `oriented`: facets face outwards. 1 to 2 us a sample, and the index. [T-THICK-1]
std::vector<double> wall_thicknesses(const TriangleSoup& oriented, std::size_t samples);

// The thickness at a place of the surface: the diameter of the largest ball inside that touches the surface there and meets no facet
// that faces it, i.e. whose normal is within 60 degrees of the opposite of the place's own. Edges between faces at more than 60 degrees
// are therefore not thin: a cube of side 1 is 1 thick everywhere. A wedge of less is, down to 0 at its edge.
// The ball is found by shrinking (Ma, Bae & Choi 2012, with closest points of the facets). It never exceeds the way along the inward
// normal through the solid. From above within 1 %, exact where walls are parallel. [T-THICK-2]
struct ThicknessSample {
  Vec3 at;
  std::uint32_t facet = 0;  // it lies on
  double area = 0;          // that it stands for
  std::uint32_t opposite = 0xffffffffu;  // the facet that ended the ball; kNoFacet without any
  double thickness = 0;     // infinite where the ray meets no facet: outside of a closed surface
};

// Samples spread over every facet, the larger the more: one a facet at least, and about `more` in all besides; those of a facet stand for
// its whole area. `oriented`: closed, facets face outwards. In the order of facets; facets without area have none.
// 5 to 25 us of a core a sample. Same bits for any number of threads.
std::vector<ThicknessSample> thickness_samples(const TriangleSoup& oriented, std::size_t more, Progress& progress = no_progress());

// The same at each point: a hundredth of the way to the centroid of its largest facet, whose normal counts. Not a number for points without facets.
std::vector<double> thickness_at_points(const TriangleSoup& oriented, Progress& progress = no_progress());

// Thin samples on facets that hang together by points, and those of the other side of the wall.
struct ThinPlace {
  Vec3 position;         // of its thinnest sample
  double thickness = 0;  // there
  double area = 0;       // of its samples
  Box3 box;              // of its samples
  std::uint32_t facet = 0;  // of its thinnest sample
};

// How samples are distributed, by area.
struct ThicknessSummary {
  static constexpr std::array<double, 5> kPercentiles{1, 5, 25, 50, 95};
  double minimum = 0;
  Vec3 thinnest_at;
  double mean = 0;
  std::array<double, kPercentiles.size()> percentiles{};  // the least value that so much of the area does not exceed
  double area = 0;
  std::size_t samples = 0;
  double limit = 0;               // 0: none was given
  double thin_area = 0;           // thinner than the limit
  std::vector<ThinPlace> places;  // the thinnest first
};

// `limit` 0: no places. O(n log n).
ThicknessSummary summary_of(const TriangleSoup& welded, const std::vector<ThicknessSample>& samples, double limit);

}  // namespace burnish
