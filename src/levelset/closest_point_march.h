// Redistancing by closest points (levelset/redistance.h: closest, fmm).
#pragma once

#include "burnish/levelset/redistance.h"

namespace burnish::detail {

template <class T>
void closest_point_redistance(BasicLevelSet<T>& level_set, const RedistanceOptions& options, Progress& progress);

}  // namespace burnish::detail
