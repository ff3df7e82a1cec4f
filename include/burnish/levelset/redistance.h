// Redistancing: turning any level set function back into the signed distance to its zero surface.
#pragma once

#include "burnish/core/progress.h"
#include "burnish/levelset/level_set.h"

namespace burnish {

// Replaces phi by the signed distance to the surface phi = 0, clamped to +-min(band, reach) cells, in all leaves of level
// 0. The surface itself stays where it is to third order.
//
// 1. Nodes of cells that the surface cuts: Newton's method for the closest point on a tricubic interpolant of phi
//    (Chopp 2001, sec. 2.1; Saye 2014): y <- y - phi g / |g|^2 + (x - y) - ((x - y).g) g / |g|^2 with g = grad phi(y).
//    Where it does not converge within two cells (kinks), the closest crossing of the axis edges around.
// 2. Outwards, layer by layer: a node takes the closest of its neighbours' closest points (vector distance
//    propagation), which is second order away from the medial axis.
//
// Same bits for any number of threads.
template <class T>
void redistance(BasicLevelSet<T>& level_set, double reach, Progress& progress = no_progress());
template <class T>
void redistance(BasicLevelSet<T>& level_set, Progress& progress = no_progress()) {
  redistance(level_set, level_set.band, progress);
}

}  // namespace burnish
