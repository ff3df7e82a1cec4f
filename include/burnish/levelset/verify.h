// Is the distance field what it says it is? Nodes compared with distances that are certified.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/levelset/from_triangles.h"

namespace burnish {

// Where errors would have different causes. Cells and band are those of the level of the node's leaf: the band of level l is `band` times
// 2^l finest cells wide.
enum class NodeStratum : std::uint8_t {
  near_surface,   // closer than a cell: cancellation
  mid_band,       // between a cell from the surface and a cell from the band's edge
  band_edge,      // the band's last cell, and beyond: facets that no list names
  near_features,  // lattice nodes nearest to vertices and middles of edges of facets: the cases of the distance to a triangle
};
inline constexpr std::size_t kNodeStrata = 4;
std::string_view name(NodeStratum stratum);  // "near_surface", "mid_band", "band_edge", "near_features"

// Errors of one sort, in finest cells.
struct ErrorSummary {
  double max = 0;
  double rms = 0;
  double worst_share = 0;      // the largest error as a share of what was allowed there: at most 1 is fine
  std::size_t exceeded = 0;    // nodes beyond what was allowed
};

struct DistanceCheck {
  std::array<std::size_t, kNodeStrata> nodes{};  // compared, of each stratum
  ErrorSummary kernel;   // of the double that `exact_squared_distances` computes
  ErrorSummary stored;   // of |phi|
  std::size_t stored_nodes = 0;      // those within the band, or of them those that are to be exact; |phi| of others is not held against anything

  std::size_t total() const;
  bool passed() const { return kernel.exceeded + stored.exceeded == 0; }
};

struct DistanceCheckOptions {
  std::size_t nodes = 1000;  // to compare, in equal parts of the strata as far as there are such nodes
  double diagonal = 0;       // of the model, in cells
  std::uint64_t seed = 1;
  // Nodes whose |phi| is to be exact, in phi's layout (levelset/accepted.h); unset: all within the band.
  const Field<std::uint8_t>* exact = nullptr;
};

// Compares nodes near the surface with exact distances to the facets whose role is `boundary` (surface/exact_distance.h), in
// lattice coordinates, where nodes are exact.
//
// Allowed are 1e-9 d + 1e-12 diagonal for the kernel's double d, and for |phi| that and half a unit in the last place of
// its type. At nodes beyond the band the kernel has to say how far that reaches.
// `lattice_soup` has the facets that `level_set` was built from. The choice of nodes depends on the seed alone, not on threads.
DistanceCheck check_distances(const TriangleSoup& lattice_soup, const std::vector<FacetRole>& roles, const LevelSet& level_set,
                              const DistanceCheckOptions& options, Progress& progress = no_progress());

}  // namespace burnish
