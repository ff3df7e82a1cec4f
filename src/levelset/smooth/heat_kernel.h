// The inner loops of smoothing, in a unit of their own that is compiled for several processors: a block's nodes, and what surrounds them. The
// same bits on every processor.
#pragma once

#include <array>
#include <cstddef>

#include "burnish/octree/field.h"

namespace burnish::detail {

inline constexpr int kHeatWidth = 4;  // layers that a pass needs
inline constexpr std::size_t kHeatSide = kBlockSide + 2 * kHeatWidth, kHeatNodes = kHeatSide * kHeatSide * kHeatSide;
inline constexpr std::size_t kBendSide = kBlockSide + 2, kBendNodes = kBendSide * kBendSide * kBendSide;

// Nodes where a field of displacements is not known have this value, or what interpolation makes of it.
inline constexpr float kUnknown = 1e30f;
inline bool is_known(float v) { return v < 0.5f * kUnknown; }

// exp(time Laplacian) along an axis: the weights of nodes 1 to 4 cells away on either side. [T-SMOOTH-2]
struct HeatTaps {
  static constexpr double kLongest = 0.84;  // cells squared
  double time = 0;
  std::array<float, kHeatWidth> weight{};

  HeatTaps() = default;
  explicit HeatTaps(double time);
};

// What diffusion for the taps' time adds to distances, per node and projected to the node's closest point; unknown where |phi| >= domain.
// Values with |phi| >= limit are no distances and are not looked at. [T-SMOOTH-3]
void heat_source(const std::array<float, kHeatNodes>& phi, const HeatTaps& taps, float limit, float domain, float* out);

// Diffuses displacements; what is unknown lets nothing through. [T-SMOOTH-4]
void heat_pass(const std::array<float, kHeatNodes>& moved, const HeatTaps& taps, float* out);

// By central differences of phi: the trace of the second derivatives and of their square, k1 + k2 and k1^2 + k2^2 for a distance. Values that
// are unknown make both so.
struct Bends {
  alignas(64) std::array<float, kBlockNodes> trace, square;
};
void heat_bends(const std::array<float, kBendNodes>& phi, Bends& bends);

}  // namespace burnish::detail
