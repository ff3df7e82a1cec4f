// Shifting a surface along its normals until it encloses a volume.
#pragma once

#include <functional>

#include "burnish/core/progress.h"
#include "burnish/levelset/level_set.h"

namespace burnish::detail {

struct VolumeShift {
  double farthest = 0;                     // cells
  const Field<float>* mobility = nullptr;  // a factor of the shift at nodes
  std::function<void()> redistance;        // makes phi a distance again, up to kFlowBand
  std::function<void()> constrain;         // what else phi has to obey
};

// Shifts phi until the volume is `wanted`, to 1e-6 of it; returns what it is in the end. Where that takes more than the farthest shift, phi stays as
// it is. [T-SMOOTH-9]
double shift_to_volume(LevelSet& level_set, double wanted, const VolumeShift& how, Progress& progress);

}  // namespace burnish::detail
