// What is more than numbers of 32 bits count, of an octree.
#pragma once

#include <cstdint>

#include "burnish/core/error.h"

namespace burnish {

// The last two numbers stand for what is no block.
inline void require_blocks(std::uint64_t blocks) {
  if (blocks >= 0xffffffffu) throw Error(ErrorCode::memory_limit, "the octree would have more than 2^32 - 2 blocks", "choose a larger --cell or a smaller --resolution");
}

}  // namespace burnish
