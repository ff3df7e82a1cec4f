// Creases that stand out of the noise, and how much of the surface's bending they hold.
#pragma once

#include "burnish/surface/edge_table.h"
#include "burnish/surface/noise.h"

namespace burnish {

// Sets crease_share and crease_bending; sigma and mean_edge are known. Linear.
void set_creases(const TriangleSoup& soup, const EdgeTable& edges, NoiseEstimate& estimate);

}  // namespace burnish
