// Numbers of 32 bits, and when there are no more of them.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string_view>

#include "burnish/core/error.h"

namespace burnish {

// Throws Error{memory_limit} unless 0 ... count - 1 are numbers of 32 bits other than the last of them, which stands for none.
inline void require_numbers(std::uint64_t count, std::string_view things) {
  if (count > 0xffffffffu)
    throw Error(ErrorCode::memory_limit, fmt::format("the mesh would have {} {}, and 32 bits number {}", count, things, 0xffffffffu), "choose a larger --cell, or larger cells in boxes");
}

// The same of the nodes of a lattice, whose last number stands for none.
inline void require_nodes(std::uint64_t nodes) {
  if (nodes >= 0xffffffffu) throw Error(ErrorCode::memory_limit, "the mesh would have more than 2^32 nodes", "choose a larger --cell, or larger cells in boxes");
}

}  // namespace burnish
