#include "burnish/pipeline/cell_octree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "burnish/core/error.h"
#include "burnish/levelset/from_triangles.h"
#include "field_output.h"
#include "read_input.h"
#include "staged_run.h"

namespace burnish {
namespace {

constexpr int kBlockLevels = 3;            // a frame counts blocks of 2^3 cells a side
constexpr int kResolution = 160;           // cells along the longest side
constexpr double kCoarsest = 1.0 / 5;      // of the longest side
constexpr std::uint32_t kFaceLimit = 3;
constexpr double kRefineTol = 2;
constexpr double kRounding = 1e-9;         // of a level: quotients of lengths that are powers of two

// The level of the widest cells of at most `widest`.
int coarsest_level(double widest, double cell) {
  return static_cast<int>(std::floor(std::log2(widest / cell) + kRounding));
}

AdaptiveGrowth grow_within(std::uint64_t memory_bytes, const TriangleSoup& lattice_soup, int depth, const RefinementLimits& limits, Progress& progress) {
  const auto criteria = criteria_of(limits);
  std::vector<const RefinementCriterion*> asked;
  asked.reserve(criteria.size());
  for (const auto& criterion : criteria) asked.push_back(criterion.get());
  return grow_adaptive(lattice_soup, depth, {.cells_per_side = 1, .coarsest_level = limits.coarsest_level, .band = 0, .memory_bytes = memory_bytes},
                       asked, progress);
}

// Facets by the leaf that holds their centroid.
std::vector<std::uint32_t> facets_in(const TriangleSoup& lattice_soup, const Octree& tree) {
  std::vector<std::uint32_t> sorted(tree.size(), 0);
  const double last = tree.side() - 1.0;
  const auto place = [&](double c) { return static_cast<std::uint32_t>(std::clamp(c, 0.0, last)); };
  for (std::uint32_t f = 0; f < lattice_soup.facets.size(); ++f) {
    const Vec3 at = (lattice_soup.corner(f, 0) + lattice_soup.corner(f, 1) + lattice_soup.corner(f, 2)) / 3.0;
    ++sorted[tree.find({place(at.x), place(at.y), place(at.z)})];
  }
  return sorted;
}

// `grid` and `sorted` must outlive what is returned.
CellGrid cells_of(const SurfaceOctree& grid, const std::vector<std::uint32_t>& sorted, const GridFrame& frame) {
  const Octree& tree = grid.octree;
  CellGrid cells{frame.origin, frame.cell, tree.depth(), tree.size(), {}, {}, {}};
  const auto whole = [](std::uint32_t c) { return static_cast<std::int32_t>(c); };
  cells.cubes = [&tree, whole](std::size_t first, std::span<LatticeCube> cubes) {
    for (std::size_t c = 0; c < cubes.size(); ++c) {
      const morton::Position p = tree.corner(first + c);
      cubes[c] = {{whole(p.x), whole(p.y), whole(p.z)}, tree.level(first + c)};
    }
  };
  const auto add = [&](const char* name, auto&& value) {
    cells.cell_arrays.push_back({name, NumberType::int64, [&tree, value](std::span<const LatticeCube> cubes, double* values) {
                                   const auto place = [](std::int32_t c) { return static_cast<std::uint32_t>(c); };
                                   for (const LatticeCube& c : cubes) {
                                     const std::uint32_t leaf = tree.find({place(c.corner[0]), place(c.corner[1]), place(c.corner[2])});
                                     *values++ = tree.level(leaf) == c.level ? static_cast<double>(value(leaf)) : -1;
                                   }
                                 }});
  };
  cells.cell_arrays.push_back({"level", NumberType::uint8, [](std::span<const LatticeCube> cubes, double* values) {
                                 for (const LatticeCube& c : cubes) *values++ = c.level;
                               }});
  add("facets", [&sorted](std::uint32_t leaf) { return sorted[leaf]; });
  add("facets_cut", [&grid](std::uint32_t leaf) { return grid.facets_of(leaf).size(); });
  return cells;
}

// One run: the stages write into the result as they go.
class CellOctreeRun : StagedRun {
 public:
  CellOctreeRun(const CellOctreeJob& job, Progress& progress) : StagedRun(progress), job_(job), output_(job.output, job.overwrite) {
    if (output_.is_wanted() && !holds_cells(output_.format()))
      throw Error(ErrorCode::usage, fmt::format("{}: an octree of cells has no distances to be sampled", job.output), "write a .vtu or a .htg");
  }

  CellOctreeResult run() {
    result_.input = job_.input;
    begin("reading");
    read();
    resolve();
    begin("growing");
    soup_ = to_lattice(soup_, frame_);
    AdaptiveGrowth grown = grow_within(job_.memory_bytes, soup_, frame_.depth + kBlockLevels, result_.limits, progress_);
    result_.bytes = grown.grid.bytes();
    result_.statistics = std::move(grown.statistics);
    if (output_.is_wanted()) write(grown.grid);
    clock_.end();
    result_.output = output_.told();
    result_.output.cells = FieldCells::cells;
    result_.stages = clock_.stages();
    return std::move(result_);
  }

 private:
  void read() {
    RepairReport report;
    soup_ = read_input(job_.input, job_.salvage, {}, report);
    result_.input_format = report.input_format;
    result_.warnings = std::move(report.warnings);
    result_.facets = soup_.facets.size();
  }

  void resolve() {
    const Box3 box = bounding_box(soup_);
    const double longest = box.empty() ? 0 : box.longest_side(), diagonal = box.empty() ? 0 : box.diagonal();
    if (!(longest > 0))
      throw Error(ErrorCode::guarantee_unmet, fmt::format("{}: nothing to work on: all {} facets lie in one point", job_.input, result_.facets),
                  "re-export the model");
    result_.cell = job_.cell ? job_.cell->in_model_units(diagonal, 0) : longest / job_.resolution.value_or(kResolution);
    result_.cells_along_longest_side = longest / result_.cell;
    result_.limits = job_.limits;
    if (!result_.limits.max_face_limit && !result_.limits.max_face_cut && !result_.limits.refine_tol)
      result_.limits.max_face_limit = kFaceLimit, result_.limits.refine_tol = kRefineTol;
    const double widest = job_.cell_max ? job_.cell_max->in_model_units(diagonal, result_.cell) : kCoarsest * longest;
    const int level = coarsest_level(widest, result_.cell);
    if (level < 0 && job_.cell_max)
      throw Error(ErrorCode::usage, fmt::format("--cell-max is {:.4g}, less than the finest cell's {:.4g}", widest, result_.cell),
                  "give a larger --cell-max, or a smaller --cell");
    frame_ = make_frame(box, result_.cell, 0);
    if (frame_.depth + kBlockLevels > morton::kMaxDepth)
      throw Error(ErrorCode::memory_limit,
                  fmt::format("an octree of cells can have {} along a side; with a cell of {:.4g} it needs more", 1 << morton::kMaxDepth, result_.cell),
                  "choose a larger --cell");
    // No cell is wider than the domain.
    result_.limits.coarsest_level = std::clamp(level, 0, morton::kMaxDepth);
    result_.cell_max = std::ldexp(result_.cell, result_.limits.coarsest_level);
  }

  void write(const SurfaceOctree& grid) {
    begin("sorting facets");
    const std::vector<std::uint32_t> sorted = facets_in(soup_, grid.octree);
    const std::size_t cells = grid.octree.size();
    output_.require_memory(cells, result_.bytes + sorted.size() * sizeof(std::uint32_t), job_.memory_bytes,
                           "choose a larger --cell or limits that divide less, or raise --memory");
    begin(FieldOutput::stage(cells));
    output_.write(cells_of(grid, sorted, frame_), progress_);
  }

  const CellOctreeJob& job_;
  FieldOutput output_;
  TriangleSoup soup_;  // welded, otherwise as read; from the growth on in lattice units
  GridFrame frame_;
  CellOctreeResult result_;
};

}  // namespace

CellOctreeResult cell_octree(const CellOctreeJob& job, Progress& progress) { return CellOctreeRun(job, progress).run(); }

}  // namespace burnish
