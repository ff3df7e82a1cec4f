// What `burnish curvature` prints.
#pragma once

#include <string>

#include "burnish/pipeline/curvature.h"

namespace burnish {

// At most 80 columns wide, lengths in model units; `seconds` is what the run took.
std::string curvature_summary(const CurvatureResult& result, double seconds);

}  // namespace burnish
