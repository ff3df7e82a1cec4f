// What all methods end with.
#pragma once

#include "burnish/volume/volume_fraction.h"

namespace burnish {

// `result.alpha` into [0, 1], and the sums and counts over it.
void clamp_and_sum(const CellGeometry& geometry, VolumeFractions& result);

}  // namespace burnish
