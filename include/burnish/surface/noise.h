// How noisy a surface is: an estimate from its points alone, without knowing the truth.
//
// Noise is what points have and their neighbourhood does not explain: random, independent from point to point, and everywhere. Detail
// (ripples, pores, engraved text) is correlated between neighbours; creases and coarse places are not everywhere. Neither is noise.
//
// 1. Around each point (at most 10,000 of them, evenly spread over the numbering) a quadric is fitted to two rings of neighbours, or to more until they reach
//    3.5 sigma far. Of white noise, the sum of squared residuals is sigma^2 times a chi-squared variable with n - 6 degrees of freedom. [T-NOISE-1]
// 2. Its lower quantiles (10, 25, 50 %) each give sigma; the least is the residual level: creases and what is coarse are in the upper part. [T-NOISE-2]
// 3. Neighbours' residuals are correlated where it is the shape that a quadric does not follow: that part is taken off. [T-NOISE-3]
// 4. Where quantiles disagree (the level is not the same everywhere), or edges lie flat, there is no noise, and sigma is 0. [T-NOISE-4, 5]
// 5. Outliers are found, and if there are many, all is done again without them. Creases are found on filtered normals. [T-NOISE-6]
//
// Accuracy: 10 % from 0.05 to 0.7 mean edges, if the shape's curvature radii and facets are larger than the noise; too little (by 10 to 50 %, or nothing found) where
// most facets are thinner than it, as on parts with needles.
#pragma once

#include <cstddef>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

struct NoiseEstimate {
  double sigma = 0;          // standard deviation of the points along the surface's normals, in model units; 0: no noise was found
  double residual = 0;       // the level before it was judged whether it is noise, in model units: an upper bound of sigma
  double mean_edge = 0;      // of the facets, in model units: what sigma is to be compared with
  double correlation = 0;    // Moran's I of the residuals over edges, less what white noise has: 0 for noise, 0.15 to 0.4 for shape
  double evenness = 0;       // of the residual level over the surface: 1 for noise, below 0.62 for detail: sigma is 0 then
  double outlier_share = 0;  // of the points: displaced by more than the noise allows (impulses, spikes)
  double crease_share = 0;   // of the edges: creases that stand out of the noise
  double crease_bending = 0; // of the surface's bending (angle times length, summed over edges): what creases hold
  std::size_t fits = 0;      // neighbourhoods that sigma rests on. Fewer than kFewestFits: sigma is 0 for want of neighbours, not of noise

  static constexpr std::size_t kFewestFits = 100;
  // Facets that share no points have no neighbourhoods: weld first.
  bool has_neighborhoods() const { return fits >= kFewestFits; }
  // Worth removing: a fortieth of an edge turns a facet by about 4 degrees. Without it, a smoother chosen by the estimate leaves the surface alone.
  bool noisy() const { return sigma > 0.025 * mean_edge; }
  // As rough as that, but neighbours share it, or it is not everywhere: the staircase of a tomography, ripples, coarse detail. What looks like creases may be it.
  bool rough_otherwise() const { return !noisy() && residual > 0.025 * mean_edge; }
  // Piecewise smooth, as machined parts are: what keeps creases (`feature`) suits it. Otherwise organic: `volume`.
  bool creased() const { return crease_bending > 0.5; }
};

// Estimates the noise of a welded, oriented soup; open, non-manifold and degenerate places are left out. A surface without noise, faceted or smooth,
// has sigma 0. Multiplying the points by a power of two multiplies lengths by it, bit for bit. Same bits for any number of threads. Linear.
NoiseEstimate estimate_noise(const TriangleSoup& oriented);

}  // namespace burnish
