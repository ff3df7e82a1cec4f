// What every run of stages has: progress that is told, and a clock.
#pragma once

#include <string>

#include "burnish/core/progress.h"
#include "burnish/core/timer.h"

namespace burnish {

class StagedRun {
 protected:
  explicit StagedRun(Progress& progress) : progress_(progress) {}

  // The next stage: may be interrupted, is timed and told.
  void begin(const std::string& stage) {
    progress_.check();
    clock_.begin(stage);
    progress_.begin_stage(stage);
  }

  Progress& progress_;
  StageClock clock_;
};

}  // namespace burnish
