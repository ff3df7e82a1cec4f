// A bit for each node of a block.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "burnish/octree/field.h"

namespace burnish::detail {

// Bit i of byte j + 8 k.
using NodeBits = std::array<std::uint8_t, kBlockSide * kBlockSide>;
inline bool has(const NodeBits& bits, std::size_t node) { return (bits[node / kBlockSide] >> (node % kBlockSide) & 1) != 0; }
inline void add(NodeBits& bits, std::size_t node) { bits[node / kBlockSide] |= static_cast<std::uint8_t>(1u << node % kBlockSide); }
inline void remove(NodeBits& bits, std::size_t node) { bits[node / kBlockSide] &= static_cast<std::uint8_t>(~(1u << node % kBlockSide)); }

}  // namespace burnish::detail
