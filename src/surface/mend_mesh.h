// The steps of local repair that work on a mesh, private to src/surface.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/surface/local_repair.h"

namespace burnish {

// Why local repair stops. Never leaves src/surface.
struct Refusal {
  std::string why;
};

using Pairs = std::vector<std::array<std::uint32_t, 2>>;

// Makes the soup a 2-manifold: pairs facets across edges, takes out needles, moves coinciding points apart, fills
// holes. Facets may still intersect. Throws Refusal.
LocalRepairResult mend(const TriangleSoup& oriented, const LocalRepairOptions& options, Progress& progress);

// The same; then cuts out facets that intersect and fills what that leaves. Throws Refusal.
LocalRepairResult mend_and_cut_out(const TriangleSoup& oriented, const LocalRepairOptions& options, Progress& progress);

}  // namespace burnish
