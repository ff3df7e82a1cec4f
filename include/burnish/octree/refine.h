// Growing an octree that is fine where criteria ask for it, from the coarsest level down (thesis, section 4.2 and 4.3).
//
// **Units.** A leaf of level l is a cube of n^3 cells of side 2^l, in lattice units; n = `cells_per_side` is 8, where a
// leaf is a block with fields (octree/field.h), or 1, where a leaf *is* a cell. So a leaf with corner c = octree.corner(leaf)
// (in finest octants) has its lower corner at lattice coordinates n c, hence at frame.to_model(n c) in the model.
// With n = 1 the octree of a GridFrame has depth frame.depth + 3.
//
// **Growth** is synchronous by level. Octants begin as the one that is the domain and are divided down to the coarsest level
// wanted; from there on where a criterion says so and the level is above 0. An octant carries the facets that meet its
// the band of its own level; its children's are sorted out of these, never searched for (Algorithm 3: *re-sorting*).
// Octants that no facet concerns are not looked at again. At the end neighbours that block the 2:1 balance are
// divided, their facets re-sorted as well.
//
// Cost: per level one separating-axis test for a facet and a child whose box it meets; memory for the lists of two levels
// and of the leaves. The result does not depend on the number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/octree/grid_frame.h"
#include "burnish/octree/grow.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// What a criterion sees of an octant.
struct OctantFacets {
  const TriangleSoup& soup;                // in lattice units
  std::span<const std::uint32_t> facets;   // near it (see grow_adaptive), ascending; at least one
  Vec3 corner;                             // lower corner, in lattice units
  int level = 0;                           // at least 1
  int cells_per_side = kBlockSide;
  double band = 0;                         // in cells of its own level

  double cell() const { return static_cast<double>(1u << level); }
};

// A reason to divide octants. `divides` is called from many threads at once and must depend on its argument alone.
class RefinementCriterion {
 public:
  virtual ~RefinementCriterion() = default;
  virtual std::string_view name() const = 0;
  virtual bool divides(const OctantFacets& octant) const = 0;
};

// The thesis' criteria, each of a *cell* (one cell that fires divides its octant). [T-REF-1]
//
// Some cell holds the centroids of more than `limit` facets: each facet counts in one cell only (half-open cells).
std::unique_ptr<RefinementCriterion> max_face_limit(std::uint32_t limit);
// Some cell is cut by more than `limit` facets (closed: touching counts). Below the valence of a vertex it ends at level 0 only.
std::unique_ptr<RefinementCriterion> max_face_cut(std::uint32_t limit);
// The cell's side over the shortest edge of the facets that cut it is more than `tolerance` (eq. 4.1; Algorithm 2 has the comparison
// the wrong way round). Facets with an edge of length 0 do not count.
std::unique_ptr<RefinementCriterion> refine_tol(double tolerance);

// Octants that meet the box (closed, in lattice units) are at most of this level.
struct LevelInBox {
  Box3 box;
  int level = 0;
};
// The octant meets one of the boxes, and is of a higher level than that one's. Named "boxes".
std::unique_ptr<RefinementCriterion> levels_in_boxes(std::vector<LevelInBox> boxes);

struct GrowthOptions {
  int cells_per_side = kBlockSide;  // or 1
  int coarsest_level = 0;           // of octants that meet the surface's band; 0: the uniform finest band
  double band = 3;                  // in cells of each octant's own level
  std::uint64_t memory_bytes = ~std::uint64_t{0};  // that octree and lists may take, about
};

struct LevelCount {
  std::uint64_t leaves = 0;        // all of this level
  std::uint64_t near_surface = 0;  // leaves with facets
  std::uint64_t cells = 0;         // leaves x cells_per_side^3
  std::uint64_t cells_cut = 0;     // cells that a facet cuts
};

struct GrowthStatistics {
  std::vector<LevelCount> levels;         // by level, 0 first
  std::vector<std::uint64_t> divided_by;  // octants that each criterion divided, the first in order that fired
  std::uint64_t divided_by_balance = 0;   // octants divided for the 2:1 balance alone, with facets or without

  std::uint64_t cells() const;
  std::uint64_t cells_cut() const;
};

struct AdaptiveGrowth {
  SurfaceOctree grid;
  GrowthStatistics statistics;
};

// The coarsest balanced octree in which every octant that meets the surface's band has level `coarsest_level` or less and no
// criterion divides it. A leaf of level l that is a block lists the facets within band * 2^l of its nodes, as
// TriangleNearBox finds them, so `band` is at least 2 for blocks (criteria need the facets that cut its cells); a single cell lists those that meet
// its cube inflated by as much. A leaf
// without facets is farther than that from all of them (leaves above the coarsest level: farther than the band of that).
//
// `lattice_soup`: in lattice units, within the domain of 2^depth octants of cells_per_side cells. Criteria are asked in the order
// given. Throws Error{interrupted}, Error{memory_limit}.
AdaptiveGrowth grow_adaptive(const TriangleSoup& lattice_soup, int depth, const GrowthOptions& options,
                             std::span<const RefinementCriterion* const> criteria, Progress& progress = no_progress());

// The thesis' octree: every leaf is a cell.
struct RefinementLimits {
  std::optional<std::uint32_t> max_face_limit;
  std::optional<std::uint32_t> max_face_cut;
  std::optional<double> refine_tol;
  int coarsest_level = 0;  // cells that a facet cuts are at most 2^coarsest_level finest cells wide
  double band = 0;         // 0: cells list the facets that cut them, nothing else
  std::vector<LevelInBox> boxes = {};
};

// The criteria that the limits ask for, in the order of their members.
std::vector<std::unique_ptr<RefinementCriterion>> criteria_of(const RefinementLimits& limits);

// `soup` in model coordinates. Leaf at corner c: lattice coordinates c to c + 2^level (see *Units*); depth is frame.depth + 3.
// Throws Error{memory_limit} if that is more than 20.
SurfaceOctree grow_cells(const TriangleSoup& soup, const GridFrame& frame, const RefinementLimits& limits,
                         Progress& progress = no_progress());
// The same with statistics; `divided_by` as in criteria_of.
AdaptiveGrowth grow_cells_counted(const TriangleSoup& soup, const GridFrame& frame, const RefinementLimits& limits,
                                  Progress& progress = no_progress());

// Leaves and cells by level of any octree with lists, as in GrowthStatistics.
std::vector<LevelCount> count_cells(const TriangleSoup& lattice_soup, const SurfaceOctree& grid, int cells_per_side,
                                    Progress& progress = no_progress());

}  // namespace burnish
