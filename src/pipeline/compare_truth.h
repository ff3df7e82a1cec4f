// The part of a comparison that takes B for the truth.
#pragma once

#include <string>

#include "burnish/io/output_file.h"
#include "burnish/pipeline/compare_files.h"
#include "compared_side.h"

namespace burnish {

// A surface with its facets' errors, for a viewer. Created before the work: a file that cannot be written is to be known before it.
// Throws Error{usage} for a path that does not end in .vtp.
class ErrorMap {
 public:
  ErrorMap(const std::string& path, bool overwrite);
  void write(const ComparedSide& result, const ComparedSide& truth, Progress& progress);

 private:
  OutputFile file_;
};

// Compares `result` with `truth`, both ready, as job.truth says, and writes the map if there is one. Reads the floor and the input.
TruthComparison compare_with_truth(const CompareJob& job, const ComparedSide& result, const ComparedSide& truth, ErrorMap* map,
                                   Progress& progress);

}  // namespace burnish
