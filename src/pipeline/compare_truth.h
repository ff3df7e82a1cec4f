// The part of a comparison that takes B for the truth.
#pragma once

#include <string>

#include "burnish/pipeline/compare_files.h"
#include "compared_side.h"
#include "viewer_file.h"

namespace burnish {

// The path of a map, a surface with its facets' errors. Throws Error{usage} for one that does not end in .vtp.
const std::string& checked_map(const std::string& path);

// Compares `result` with `truth`, both ready, as job.truth says, and writes the map if there is one. Reads the floor and the input.
TruthComparison compare_with_truth(const CompareJob& job, const ComparedSide& result, const ComparedSide& truth, ViewerFile* map,
                                   Progress& progress);

}  // namespace burnish
