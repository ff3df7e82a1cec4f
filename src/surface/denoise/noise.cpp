#include "burnish/surface/noise.h"

namespace burnish {

NoiseEstimate estimate_noise(const TriangleSoup& oriented) {
  NoiseEstimate estimate;
  estimate.mean_edge = mean_edge_length(oriented);
  return estimate;
}

}  // namespace burnish
