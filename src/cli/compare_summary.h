// A comparison as people read it: at most 80 columns wide.
#pragma once

#include <string>

#include "burnish/pipeline/compare_files.h"

namespace burnish {

// Sizes of both side by side, distances and angles both ways, where the surfaces are farthest apart, and the answer.
std::string compare_summary(const CompareResult& result);

}  // namespace burnish
