// One input smoothed at several strengths.
#pragma once

#include <string>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/pipeline/clean.h"

namespace burnish {

// A strength, and where its result goes.
struct SweepStep {
  Length smooth;
  std::string output;
};

// Smooths the input at each strength, as `clean` does with `job.options` and that length; `job.output` and `job.options.smooth` are not looked at. The input is read
// and prepared once, and where level sets are smoothed, they start from one distance field, whose cells suit the shortest length.
// All outputs are created before the work begins. One report a step, in their order; each output appears once it is complete and verified.
// An input that bounds no solid gives one report, with the reason. Throws Error as `clean` does.
std::vector<RepairReport> sweep(const CleanJob& job, const std::vector<SweepStep>& steps, Progress& progress = no_progress());

}  // namespace burnish
