// The options of a cleaning run, for every command that cleans.
#pragma once

#include <string>
#include <vector>

#include "burnish/pipeline/options.h"
#include "command_line.h"

namespace burnish {

// The table with the rows of `options`, behind those of its group "Output".
std::vector<Option> with_clean_options(std::vector<Option> table, CleanOptions& options);

// Throws Error{usage} for options that exclude each other.
void require_consistent(const CleanOptions& options);

// The names of options that were given and do nothing without --smooth.
std::vector<std::string> idle_options(const CleanOptions& options);

}  // namespace burnish
