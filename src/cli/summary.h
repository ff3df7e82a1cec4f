// Results as people read them: the tables they paste into forums, at most 80 columns wide.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "burnish/core/model_unit.h"
#include "burnish/pipeline/check.h"
#include "burnish/pipeline/report.h"

namespace burnish {

// The first line of a summary, and an empty one: "part.stl (binary STL, in mm)".
std::string input_line(const std::string& input, std::string_view format, const std::optional<ModelUnit>& unit);

// What keeps a soup from being a valid solid, e.g. "12 open edges in 2 loops, 1 duplicate facet".
// Empty for a valid solid.
std::string problems(const Defects& defects);

// One column of counts, the `places` largest defects of each kind with their coordinates, and the verdict.
std::string check_summary(const CheckResult& result, std::size_t places);

// The before -> after table, the deviation in both directions, the verdict and the time.
// `details` adds the resolved options, what was done to the facets, the grid and the stages.
std::string clean_summary(const RepairReport& report, double wall_seconds, bool details);

}  // namespace burnish
