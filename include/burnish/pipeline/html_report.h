// A run as one HTML page: both surfaces to turn, what was wrong and where, and all figures of the report.
#pragma once

#include <cstddef>
#include <string>

#include "burnish/core/progress.h"
#include "burnish/pipeline/clean.h"
#include "burnish/pipeline/report.h"

namespace burnish {

// A surface of more facets is drawn simplified; figures and places of defects are those of the whole.
inline constexpr std::size_t kMostDrawnFacets = 300'000;
// Of each kind of defect, on each side, that many are listed, the largest.
inline constexpr std::size_t kMostListedDefects = 200;

// The page's text: UTF-8, self-contained (it asks no network, and says so in its security policy), works from a file. What comes
// from outside, such as names of files, stands in it as data only. It holds no date, and no time but that of the report's stages.
//
// Coordinates are drawn to 1/65535 of the box' sides, signed distances of the result from the input to 1/32767 of the largest.
// The same bytes for the same arguments and any number of threads. Throws what `progress` throws.
// Cost: about 3 us for each facet of either side, and the search for self-intersections of a surface that has some, unless `surfaces` tells them.
std::string html_report(const RepairReport& report, const CleanSurfaces& surfaces, Progress& progress = no_progress());

}  // namespace burnish
