// How noisy a surface is: an estimate from its points alone, without knowing the truth.
#pragma once

#include <cstddef>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

// Noise is what points have and their neighbourhood does not explain: random, independent from point to point. Detail (ripples, pores,
// engraved text) is correlated between neighbours and is none.
struct NoiseEstimate {
  double sigma = 0;          // standard deviation of the points along the surface's normals, in model units; 0: no noise was found
  double mean_edge = 0;      // of the facets, in model units: what sigma is to be compared with
  double correlation = 0;    // Moran's I of the residuals over edges: about 0 for white noise, towards 1 for detail
  double outlier_share = 0;  // of the points: displaced by more than the noise allows (impulses, spikes)
  double crease_share = 0;   // of the edges: creases that stand out of the noise
};

// Estimates the noise of a welded, oriented soup; open, non-manifold and degenerate places are left out. A surface without noise, faceted or smooth,
// has sigma 0. Same bits for any number of threads. Linear in the number of facets.
NoiseEstimate estimate_noise(const TriangleSoup& oriented);

}  // namespace burnish
