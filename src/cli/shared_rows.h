// Rows that several commands' tables share, each under the heading that the command gives it.
#pragma once

#include "burnish/pipeline/options.h"
#include "command_line.h"

namespace burnish {

Option nested_row(std::string_view group, CleanOptions& options);
Option gap_row(std::string_view group, CleanOptions& options);
Option salvage_row(std::string_view group, bool& salvage);
Option threads_row(std::string_view group, int& threads);
Option memory_row(std::string_view group, CleanOptions& options);
// What the model's coordinates are in; parsing sets it before all others, so that lengths can have a unit.
Option units_row(std::string_view group, std::optional<ModelUnit>& unit);
Option help_row(std::string_view group);

// `answers`: of a command whose exit code is an answer.
Option quiet_row(std::string_view group, bool& quiet, bool answers = false);

}  // namespace burnish
