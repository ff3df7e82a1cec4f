// What `burnish mesh` prints.
#pragma once

#include <string>

#include "burnish/pipeline/flow_mesh_job.h"

namespace burnish {

// The result in lines, lengths in model units; `seconds` is what the run took.
std::string summary_of(const FlowMeshResult& result, double seconds);

}  // namespace burnish
