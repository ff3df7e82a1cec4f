// The connected pieces into which facets cut the lattice nodes of single blocks, and the regions these form together.
#pragma once

#include <cstdint>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/core/progress.h"
#include "burnish/octree/field.h"
#include "burnish/octree/grow.h"

namespace burnish::detail {

// Pieces are numbered through all leaves: those of leaf b are [first[b], first[b + 1]). A leaf that no facet is near to is one
// piece. [T-SIGN-2]
struct Pieces {
  Field<std::uint16_t> label;        // of a node within its leaf
  std::vector<std::uint32_t> first;  // number of a leaf's first piece; size: leaves + 1
  std::vector<std::uint32_t> region;  // of every piece
  std::size_t regions = 0;

  std::uint32_t of(std::size_t leaf, std::size_t node) const { return first[leaf] + label.block(leaf)[node]; }
  std::uint32_t count(std::size_t leaf) const { return first[leaf + 1] - first[leaf]; }
};

// Throws Error{memory_limit} unless 32 bits number them.
inline void require_pieces(std::uint64_t pieces) {
  if (pieces > 0xffffffffu) throw Error(ErrorCode::memory_limit, "the surface cuts the lattice into more than 2^32 pieces", "choose a larger --cell");
}

// Nodes are connected by the lattice edges that no facet crosses, within leaves and between them. Same result for any number
// of threads.
Pieces find_pieces(const SurfaceOctree& grid, const Field<std::uint8_t>& crossed, Progress& progress);

// Labels one block's 512 nodes by piece, in the order of their first nodes; returns the number of pieces. Three bits a node say which edges
// upwards are crossed.
std::uint16_t label_block(const std::uint8_t* crossed, std::uint16_t* label);

}  // namespace burnish::detail
