// Inspecting a file without changing it.
#pragma once

#include <string>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/surface/inspect.h"

namespace burnish {

struct CheckResult {
  std::string input;
  std::string input_format;
  Defects defects;                    // after welding by exact coordinates
  std::vector<std::string> warnings;  // of the reader
  bool valid_solid = false;
};

// Reads the file at `path` ("-": standard input), welds it and inspects it. Throws Error as `read_mesh`.
CheckResult check(const std::string& path, bool salvage = false, Progress& progress = no_progress());

}  // namespace burnish
