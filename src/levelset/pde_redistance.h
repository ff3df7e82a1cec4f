// Redistancing by pseudo-time steps (levelset/redistance.h: pde_weno5, pde_first).
#pragma once

#include "burnish/levelset/redistance.h"

namespace burnish::detail {

template <class T>
RedistanceResult pde_redistance(BasicLevelSet<T>& level_set, const RedistanceOptions& options, Progress& progress);

}  // namespace burnish::detail
