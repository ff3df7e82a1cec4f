// What every run that needs a solid begins with, and what its stages write into as they go.
#pragma once

#include <string>

#include "burnish/pipeline/options.h"
#include "burnish/pipeline/report.h"
#include "burnish/surface/inspect.h"
#include "prepare_input.h"
#include "staged_run.h"

namespace burnish {

class SolidRun : protected StagedRun {
 protected:
  SolidRun(const std::string& input, Progress& progress) : StagedRun(progress) { report_.input = input; }

  void read(bool salvage, const CleanOptions& options);
  // Instead of reading: a surface that is in memory, welded or not.
  void take(TriangleSoup input, const CleanOptions& options);
  // Inspects, orients and caps the input. False if it bounds no solid, and that was needed: report_.failure says why.
  bool prepare(const CleanOptions& options);

  RepairReport report_;  // also what preparation tells other runs than repairs
  TriangleSoup input_;   // welded, otherwise as read
  Inspection inspection_;
  PreparedInput prepared_;
};

}  // namespace burnish
