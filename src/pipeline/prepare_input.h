// From a welded soup to a closed, oriented chain of facets; or the reason why there is no solid in it.
#pragma once

#include <optional>

#include "burnish/core/error.h"
#include "burnish/pipeline/report.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// Drops degenerate and duplicate facets, welds open edges within a tolerance if too many stay unmatched, orients,
// caps. Says what it did in `actions`.
TriangleSoup prepare_input(const TriangleSoup& welded, RepairActions& actions);

// Why the prepared soup bounds no solid: nothing with an area, or openings too large for a cap to be more than a guess.
std::optional<Error> reason_for_no_solid(const TriangleSoup& welded, const TriangleSoup& prepared, const Defects& before,
                                         const RepairActions& actions);

}  // namespace burnish
