// Nothing is lost silently: the parts of the input that the result is not near to.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "burnish/pipeline/report.h"
#include "burnish/surface/compare.h"

namespace burnish {

// Gathers far samples into places (of the same reason, in one cell of a grid of a sixteenth of `diagonal`), the largest
// first. `reason_of` says why a sample of the input is not in the result.
std::vector<Loss> gather_losses(const std::vector<FarSample>& far, double diagonal, const std::function<std::string(const FarSample&)>& reason_of);

}  // namespace burnish
