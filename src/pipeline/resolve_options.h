// Where relative lengths become model units, and defaults become numbers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "burnish/levelset/smooth/smoothing.h"
#include "burnish/pipeline/options.h"
#include "burnish/surface/boundary_caps.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// Cells of exact distances around the surface when nothing is smoothed: what extraction takes.
inline constexpr double kUnsmoothedBand = 3;

// The flow of the level set behind a mode; mean-curvature flow for modes that have none.
FlowMode flow_mode(SmoothMode mode);

// Resolves everything but the cell and what is measured in cells; `diagonal` is the input's.
ResolvedOptions resolve_lengths(const CleanOptions& asked, double diagonal);

// Resolves the rest for a prepared soup. Default cell: the least of the mean edge, a sixth of the mean thickness
// (2 V / A), and 0.3 of the area per length of creases; but no more than 1/300 and no less than 1/1000 of the diagonal, nor so fine that the
// surface has more than a million cells, and as coarse as the memory budget asks. With
// smoothing it need not be finer than a twelfth of that length (up to 1/150 of the diagonal). What had to give way is added to `warnings`.
// `band`: the cells of exact distances that will be asked for where nothing is smoothed.
// Throws Error{memory_limit} if an explicit cell does not fit the budget, Error{usage} if a length makes no sense.
void resolve_cell(const CleanOptions& asked, const CappedSoup& capped, ResolvedOptions& resolved, std::vector<std::string>& warnings,
                  double band = kUnsmoothedBand);

// The memory that a run with this cell is expected to need, in bytes: proportional to the surface's area in cells and
// to the band's width (calibrated in docs/benchmarks.md, rounded up), plus what the input itself takes.
std::uint64_t planned_bytes(const TriangleSoup& prepared, double cell, double band);

}  // namespace burnish
