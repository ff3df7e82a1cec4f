// Machine parts: flat faces, sharp edges, holes and thin walls. Closed, oriented outwards, points shared.
#pragma once

#include "burnish/surface/triangle_soup.h"

namespace burnish::test {

// [0, extent], each face a grid of nx, ny, nz squares along the axes, cut in two.
TriangleSoup box(const Vec3& extent, int nx, int ny, int nz);
// A strip of a plate, thin in z: [0, 1] x [0, 0.6] x [0, 0.02].
TriangleSoup thin_plate();
// An angle bracket, 3 x 1 x 1: a plate of thickness 0.25 with two round holes of radius 0.3 through it, and a block of
// height 1 at its end. Genus 2. `n` facets along a unit edge, 4 n around a hole.
TriangleSoup bracket(int n);

}  // namespace burnish::test
