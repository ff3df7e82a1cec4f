// What a user can ask of a cleaning run, and what it was resolved to.
#pragma once

#include <cstdint>
#include <optional>

#include "burnish/core/length.h"

namespace burnish {

// As asked. Lengths may be relative; `resolve` (pipeline/clean.cpp) turns them into model units once.
struct CleanOptions {
  // Side of the finest cells. At most one of `cell` and `resolution` is set; with neither, the cell
  // follows from the mean edge and the diagonal (docs/choosing-parameters.md).
  std::optional<Length> cell;
  // Cells along the longest side of the bounding box.
  std::optional<int> resolution;
  // Wavelengths below this length are removed (attenuated tenfold or more). 0: no smoothing.
  Length smooth{};
  // Bound on the distance between the smoothed and the repaired surface. Unset: no bound.
  std::optional<Length> deviation;
  // The run plans to stay below this many bytes: a default cell is coarsened for it, an explicit one
  // that needs more ends the run with Error{memory_limit}.
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
};

// As resolved, in model units.
struct ResolvedOptions {
  double cell = 0;
  double cells_along_longest_side = 0;
  double smooth = 0;
  std::optional<double> deviation;
  std::uint64_t memory_bytes = 0;
  bool cell_was_chosen = false;  // by default rule, not by the user
};

}  // namespace burnish
