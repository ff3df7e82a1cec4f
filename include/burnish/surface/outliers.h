// Points and pieces that do not belong to the surface around them: impulses, spikes, stray fragments.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "burnish/surface/noise.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

struct Outlier {
  std::uint32_t point = 0;
  Vec3 position;   // in the soup
  Vec3 fitted;     // on the surface that the points around it make without it
  double distance = 0;  // between the two, in model units, always positive
};

// Points far from a quadric that is fitted to their neighbourhood (two rings, without the point itself) so that a minority of displaced neighbours has no
// say: farther than 5 standard deviations, of the noise and of what the neighbours themselves are off by, and than half an edge
// (0.2 edges where there is noise). [T-OUTLIER-1]
// Corners, creases and tips of cones are none: some part of the surface around goes through them. [T-OUTLIER-2] In ascending order of points. Linear; open,
// non-manifold and degenerate places are left out. `noise`: of the same soup. Same bits for any number of threads.
std::vector<Outlier> find_outliers(const TriangleSoup& oriented, const NoiseEstimate& noise);

// Moves outliers to where the points around them say.
void clamp_outliers(const std::vector<Outlier>& outliers, TriangleSoup& soup);

// Facets of components (connected by points) with less than 1e-4 of the largest component's area and a box of less than 2 % of its diagonal: dirt of scanning,
// not parts. Ascending. Linear.
std::vector<std::uint32_t> find_fragments(const TriangleSoup& welded);

}  // namespace burnish
