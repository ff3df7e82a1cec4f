// Surfaces parallel to that of a level set: offsets and hollow shells.
#pragma once

#include "burnish/levelset/level_set.h"

namespace burnish {

// Cells of band that an offset has to leave.
inline constexpr double kLeastBand = 3;

// Moves the surface by `cells` along its outward normals (inwards if negative): phi + cells. [T-SMOOTH-12]
//
// Afterwards the band is |cells| narrower and phi is clamped to it everywhere, in leaves that store nothing, too. The new surface is as accurate as
// phi was there: with exact distances a sphere is exact. Outside of convex edges phi is rounded, so they come out round with the offset as their radius; concave
// edges stay sharp. Where offsets of opposite sheets meet they unite, with a kink in phi.
// What is nearer to the band's edge than kLeastBand is not known well enough: throws Error{usage} unless |cells| < band - kLeastBand.
template <class T>
void offset(BasicLevelSet<T>& level_set, double cells);

// Leaves a wall of `cells` thickness inside the surface, the inner surface parallel to it: min(phi, cells - phi). Negative: outside of it. [T-SMOOTH-13]
//
// Walls of the solid thinner than twice that stay solid. Band, clamping and errors as above. phi has a kink in the middle of the wall: redistancing and curvature see it
// up to their stencils' width, so walls should have eight cells.
template <class T>
void hollow(BasicLevelSet<T>& level_set, double cells);

}  // namespace burnish
