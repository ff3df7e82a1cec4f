// Curvatures of level sets at all nodes of a block, in a unit of its own that is compiled for several processors.
#pragma once

#include "burnish/octree/field.h"

namespace burnish::detail {

inline constexpr int kNodalWidth = 2;  // layers around the block
inline constexpr std::size_t kNodalNodes = std::size_t{kBlockSide + 2 * kNodalWidth} * (kBlockSide + 2 * kNodalWidth) * (kBlockSide + 2 * kNodalWidth);

// curvatures[n] = k1 + k2, per cell, of the level set through node n, by central differences of second or fourth order; `gathered` times `scale` is phi
// in cells. [T-CURV-6]
void nodal_curvatures(const float* gathered, double scale, int order, double* curvatures);
void nodal_curvatures(const double* gathered, double scale, int order, double* curvatures);

}  // namespace burnish::detail
