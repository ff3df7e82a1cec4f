// The search for outliers, for those who have the graph already.
#pragma once

#include "burnish/surface/outliers.h"
#include "noise_patch.h"

namespace burnish {

std::vector<Outlier> search_outliers(const TriangleSoup& soup, const PointGraph& graph, const NoiseEstimate& noise);

}  // namespace burnish
