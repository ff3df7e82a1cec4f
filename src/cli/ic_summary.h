// What `burnish ic` prints.
#pragma once

#include <string>

#include "burnish/pipeline/initial_condition.h"

namespace burnish {

// The result in lines, lengths in the mesh's unit; `seconds` is what the run took.
std::string summary_of(const InitialConditionResult& result, double seconds);

}  // namespace burnish
