// Denoising of a surface by its normals: facets keep their points, points move, creases stay sharp.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/surface/noise.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

struct DenoiseOptions {
  // Standard deviation of the noise, in model units. Unset: estimate_noise.
  std::optional<double> sigma;
  // Waves shorter than this are removed, in model units. Unset: what is noise is removed, at the scale that each place needs.
  std::optional<double> length;
  // Edges with an angle between their facets' (denoised) normals of more than this stay sharp, in degrees. Unset: chosen from the noise.
  std::optional<double> crease_angle;
  // No point moves farther than this, in model units.
  std::optional<double> deviation;
  // One per point: 0 keeps the point where it is, 1 lets it move freely. Empty: 1 everywhere.
  std::vector<float> mobility;
};

struct DenoiseResult {
  TriangleSoup soup;             // facets, groups and colours as they were; points moved
  NoiseEstimate noise;           // of the input
  std::size_t outliers = 0;      // points that were displaced by more than the noise allows, and were clamped
  double rms_moved = 0;          // of the points, along their normals, in model units
  double max_moved = 0;
};

// Denoises a welded, oriented soup. It need not be closed nor a manifold: facets are neighbours across edges with exactly two uses; points of open
// edges move within the surface's rim only along its normal. A surface without noise comes back bit for bit. No facet is turned over, but
// facets may come to intersect: `inspect` the result. Deterministic for any number of threads.
// Throws Error{interrupted}.
DenoiseResult denoise(const TriangleSoup& oriented, const DenoiseOptions& options = {}, Progress& progress = no_progress());

}  // namespace burnish
