// What a run's smoothing comes down to, once the input is known.
#pragma once

#include <memory>
#include <optional>

#include "burnish/pipeline/options.h"
#include "burnish/pipeline/report.h"
#include "prepare_input.h"
#include "region.h"

namespace burnish {

struct SmoothingPlan {
  SmoothMode mode = SmoothMode::automatic;  // automatic: nothing is smoothed
  double length = 0;                        // waves below this are removed, in model units; 0: what is noise, at its own scale
  std::optional<double> stop_at;            // rms displacement that explains the noise: smoothing ends there, in model units
  bool clamps_outliers = false;             // points far off the surface are put back first
  std::shared_ptr<const Region> region;     // unset: everywhere

  bool smooths() const { return mode != SmoothMode::automatic; }
  bool denoises() const { return mode == SmoothMode::feature; }
  bool flows() const { return mode != SmoothMode::feature && mode != SmoothMode::automatic; }
};

// Chooses the mode for options that ask for smoothing, and `noise`, that of the prepared facets. Tells report.smoothing, and warns of options that the mode has no use for.
SmoothingPlan plan_smoothing(const CleanOptions& asked, const NoiseEstimate& noise, std::shared_ptr<const Region> region, const PreparedInput& prepared, RepairReport& report);

// The options for the rest of the run: with the length that was chosen, if the level set is to be smoothed.
CleanOptions with_plan(const CleanOptions& asked, const SmoothingPlan& plan);

}  // namespace burnish
