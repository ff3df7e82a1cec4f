// Between our points and facets and CGAL's. For units that see CGAL; private to src/surface.
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

inline Kernel::Point_3 to_cgal(const Vec3& p) { return {p.x, p.y, p.z}; }
inline Vec3 from_cgal(const Kernel::Point_3& p) { return {p.x(), p.y(), p.z()}; }

}  // namespace burnish
