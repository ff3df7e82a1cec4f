// A model's repaired surface in memory: what `clean` would write, in double precision.
#pragma once

#include "burnish/core/progress.h"
#include "burnish/pipeline/clean.h"
#include "burnish/pipeline/report.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

struct RepairedSurface {
  RepairReport report;    // its failure says why there is no surface
  TriangleSoup surface;   // verified, welded, closed; no facets if there is a failure
};

// Runs `clean` up to its verified result. The job's output is not looked at. `named`: with the groups and colours of the input, facets in their order.
// Throws Error as `clean` does.
RepairedSurface repaired_surface(const CleanJob& job, Progress& progress, bool named = false);

}  // namespace burnish
