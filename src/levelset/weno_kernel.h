// The inner loops of redistancing by a PDE, in a unit of their own that is compiled for several processors.
//
// All of it works in a leaf's own units: cells of 1, phi times 2^-level. The same bits on every processor.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "burnish/octree/field.h"

namespace burnish::detail {

inline constexpr int kWenoWidth = 3;

// A block and the nodes up to three cells beyond its faces (there is nothing beyond its edges: differences run along the axes).
// Rows are spaced by 16, so that rows of eight can be loaded from any of them.
struct alignas(64) HaloBlock {
  static constexpr int kRow = 16, kSide = kBlockSide + 2 * kWenoWidth;
  std::array<double, std::size_t{kRow} * kSide * kSide> values;

  static constexpr std::size_t index(int i, int j, int k) {
    return static_cast<std::size_t>(i + 4 + kRow * ((j + kWenoWidth) + kSide * (k + kWenoWidth)));
  }
  static constexpr std::array<int, 3> kStride{1, kRow, kRow * kSide};
  double& at(int i, int j, int k) { return values[index(i, j, k)]; }
  double at(int i, int j, int k) const { return values[index(i, j, k)]; }
};

// A block and its neighbours of the same level across the faces -x, +x, -y, +y, -z, +z. Null: its own outermost nodes continue.
template <class T>
struct BlockFaces {
  const T* own;
  std::array<const T*, 6> across;
};
// Fills `width` layers (1 or 3), times `scale`.
void fill(const BlockFaces<float>& blocks, double scale, int width, HaloBlock& halo);
void fill(const BlockFaces<double>& blocks, double scale, int width, HaloBlock& halo);

// Eight nodes of a block with crossings of the surface on edges of theirs. [T-PDE-4]
struct alignas(64) CutNodes {
  std::array<std::array<double, kBlockSide>, 6> crossing;  // how far it is to it along -x, +x, ... +z, in (0, 1]; 0: none
  std::array<double, kBlockSide> step;                     // of the nodes, in parts of the stage's
  std::array<std::uint16_t, kBlockSide> node;              // where there are less than eight, one is repeated
  std::uint16_t count = 0;
};

// A stage of a Runge-Kutta method: out = keep start + (1 - keep) (phi + step S (1 - |grad phi|)), phi being the halo block's.
template <class T>
struct Stage {
  double keep;
  double step;
  double limit;               // |out| stays at it, in own units
  double counted;             // rates are summed where |out| is below this
  double scale;               // own units to those of `start` and `out`
  const std::uint8_t* still;  // a bit per node, 8 rows' bytes a layer: out = start there. May be null.
  const CutNodes* cut;        // nodes of `still` for which out is computed after all
  std::size_t cut_count;
  const T* start;
  T* out;                     // may be `start`
};

// What became of a block.
struct StageSums {
  double squared_rate = 0;  // sum of ((out - start) / step)^2 where it counts
  double least = 0;         // |out| in own units
};

StageSums weno5_stage(const HaloBlock& halo, const Stage<float>& stage);
StageSums weno5_stage(const HaloBlock& halo, const Stage<double>& stage);
StageSums first_order_stage(const HaloBlock& halo, const Stage<float>& stage);
StageSums first_order_stage(const HaloBlock& halo, const Stage<double>& stage);

}  // namespace burnish::detail
