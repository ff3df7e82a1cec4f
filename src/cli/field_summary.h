// What `burnish field` prints.
#pragma once

#include <string>

#include "burnish/pipeline/cell_octree.h"
#include "burnish/pipeline/field.h"

namespace burnish {

// Results in lines, lengths in model units; `seconds` is what the run took.
std::string summary_of(const FieldResult& result, double seconds);
std::string summary_of(const CellOctreeResult& result, double seconds);

}  // namespace burnish
