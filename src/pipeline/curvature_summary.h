// What the curvatures at a surface's points amount to.
#pragma once

#include <span>

#include "burnish/levelset/curvature.h"
#include "burnish/pipeline/curvature.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// In model units: those of `at` are per finest cell. `surface` in model units, one of `at` for each of its points; with `mean_only` nothing but k1 + k2
// is looked at. `points` says what those of the surface are: the input's vertices are mere samples, without integrals. Leaves mean_edge to the
// caller. [T-GAUSS-1]
CurvatureSummary summarize_curvature(const TriangleSoup& surface, std::span<const FrontCurvature> at, double cell, CurvatureOrder order, CurvaturePoints points,
                                     bool mean_only);

// The same points by two methods: differences of k1 and k2 where both have converged. `points` in model units.
CurvatureCheck compare_curvatures(std::span<const Vec3> points, std::span<const FrontCurvature> a, std::span<const FrontCurvature> b, double cell);

}  // namespace burnish
