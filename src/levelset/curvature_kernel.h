// Derivatives of a block's interpolants at points, and curvatures at its nodes: in a unit of its own that is compiled for several processors.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "burnish/core/vec.h"
#include "burnish/octree/field.h"

namespace burnish::detail {

// Value, gradient and second derivatives.
struct Jet {
  double value = 0;
  Vec3 gradient;
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
};

// A block and four layers around it: stencils of eight nodes per axis around any of its cells fit.
inline constexpr int kJetWidth = 4;
inline constexpr int kJetSide = kBlockSide + 2 * kJetWidth;
inline constexpr std::size_t kJetNodes = std::size_t{kJetSide} * kJetSide * kJetSide;

// The values in units of the leaf's cell, and where a stencil of 4, 6 or 8 nodes per axis meets values that are no distance.
struct JetBlock {
  static constexpr std::size_t kRowMasks = std::size_t{kJetSide} * kJetSide;
  alignas(64) std::array<double, kJetNodes + kBlockSide> phi{};  // rows are read eight nodes at a time: past the last, too
  // Bit x: some node (x, y + b, z + c), b and c < 4, 6, 8, is clamped; at y + 16 z.
  alignas(64) std::array<std::array<std::uint16_t, kRowMasks>, 3> clamped{};

  // Whether the stencil of `points` nodes per axis around the cell of p (in nodes of the array) meets none.
  bool is_free(int points, const Vec3& p) const;
};

// What nodes may have for a distance, for the nine kinds of rows (below, in, above the block; y first), per node of the row.
using JetLimits = std::array<std::array<double, kJetSide>, 9>;

// Fills a block from gathered values, multiplied by `scale`; those with |value| >= limit are clamped.
void fill(const float* gathered, double scale, const JetLimits& limits, JetBlock& block);
void fill(const double* gathered, double scale, const JetLimits& limits, JetBlock& block);

// The lowest node of the stencil of `points` nodes around coordinate p.
inline int first_node(int points, double p) {
  const int low = points / 2 - 1, high = kJetSide - 1 - points / 2;
  const int cell = static_cast<int>(p);
  return (cell < low ? low : cell > high ? high : cell) - low;
}

inline bool JetBlock::is_free(int points, const Vec3& p) const {
  const int x = first_node(points, p.x), y = first_node(points, p.y), z = first_node(points, p.z);
  const unsigned rows = clamped[static_cast<std::size_t>(points / 2 - 2)][static_cast<std::size_t>(y + kJetSide * z)];
  return ((rows >> x) & ((1u << points) - 1)) == 0;
}

// Value and gradient of the tricubic interpolant [T-REDIST-2], in nodes of the array.
void cubic(const JetBlock& block, const Vec3& p, double& value, Vec3& gradient);

// [T-CURV-4] Central differences, trilinearly between nodes (4 nodes per axis).
void jet_of_second_order(const JetBlock& block, const Vec3& p, Jet& jet);
// [T-CURV-3] Derivatives of the Lagrange polynomial through 6 and 8 nodes per axis.
void jet_of_fourth_order(const JetBlock& block, const Vec3& p, Jet& jet);
void jet_of_sixth_order(const JetBlock& block, const Vec3& p, Jet& jet);

// Jets at points of the surface, and what follows from them, in arrays by component.
struct JetBatch {
  static constexpr std::size_t kSize = 32;
  using Lanes = std::array<double, kSize>;
  std::array<Lanes, 3> gradient;
  Lanes xx, xy, xz, yy, yz, zz;

  void set(std::size_t lane, const Jet& jet) {
    for (int a = 0; a < 3; ++a) gradient[static_cast<std::size_t>(a)][lane] = jet.gradient[a];
    xx[lane] = jet.xx, xy[lane] = jet.xy, xz[lane] = jet.xz, yy[lane] = jet.yy, yz[lane] = jet.yz, zz[lane] = jet.zz;
  }
};
struct CurvatureBatch {
  JetBatch::Lanes k1, k2;  // per cell
  std::array<JetBatch::Lanes, 3> normal, direction1, direction2;

  static Vec3 at(const std::array<JetBatch::Lanes, 3>& v, std::size_t lane) { return {v[0][lane], v[1][lane], v[2][lane]}; }
};

// The shape operator's eigenvalues and eigenvectors, of the first `count` jets. [T-CURV-2]
void principal_curvatures(const JetBatch& jets, std::size_t count, CurvatureBatch& curvatures);

}  // namespace burnish::detail
