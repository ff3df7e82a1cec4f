#include "mesh_refinement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "burnish/core/error.h"
#include "burnish/core/text.h"

namespace burnish {
namespace {

constexpr double kRounding = 1e-9;  // of a cell

bool meet(const Box3& a, const Box3& b) {
  bool all = true;
  for (int i = 0; i < 3; ++i) all = all && a.lower[i] <= b.upper[i] && b.lower[i] <= a.upper[i];
  return all;
}

// The smallest box of octants of a level around it.
LatticeBox rounded(const LatticeBox& box, int level) {
  LatticeBox result;
  for (std::size_t a = 0; a < 3; ++a) result.lower[a] = (box.lower[a] >> level) << level, result.upper[a] = (((box.upper[a] - 1) >> level) + 1) << level;
  return result;
}

LatticeBox grown(LatticeBox box, std::int64_t by) {
  for (std::size_t a = 0; a < 3; ++a) box.lower[a] -= by, box.upper[a] += by;
  return box;
}

Box3 in_lattice_units(const LatticeBox& box) {
  Box3 result;
  for (int a = 0; a < 3; ++a) {
    result.lower[a] = 2.0 * static_cast<double>(box.lower[static_cast<std::size_t>(a)]);
    result.upper[a] = 2.0 * static_cast<double>(box.upper[static_cast<std::size_t>(a)]);
  }
  return result;
}

// The whole number in a range that is nearest to a coordinate, which may be one that no integer holds.
std::int64_t within(double x, std::int64_t least, std::int64_t most) {
  return static_cast<std::int64_t>(std::clamp(x, static_cast<double>(least), static_cast<double>(most)));
}

// A box of the lattice in whole cells, at least one, of the region.
LatticeBox in_cells(const Box3& box, const LatticeBox& region) {
  LatticeBox cells;
  for (int a = 0; a < 3; ++a) {
    const auto i = static_cast<std::size_t>(a);
    cells.lower[i] = within(std::floor(box.lower[a] / 2 + kRounding), region.lower[i], region.upper[i] - 1);
    cells.upper[i] = within(std::ceil(box.upper[a] / 2 - kRounding), cells.lower[i] + 1, region.upper[i]);
  }
  return cells;
}

}  // namespace

double LatticeBox::octants(int level) const {
  double product = 1;
  for (std::size_t a = 0; a < 3; ++a) product *= static_cast<double>(((upper[a] - 1) >> level) - (lower[a] >> level) + 1);
  return product;
}

Vec3 DomainStretch::to_domain(const Vec3& q) const {
  Vec3 r = q;
  for (int a = 0; a < 3; ++a) {
    if (q[a] < body.lower[a]) r[a] = body.lower[a] - (body.lower[a] - q[a]) * (body.lower[a] - domain.lower[a]) / (body.lower[a] - lattice.lower[a]);
    if (q[a] > body.upper[a]) r[a] = body.upper[a] + (q[a] - body.upper[a]) * (domain.upper[a] - body.upper[a]) / (lattice.upper[a] - body.upper[a]);
  }
  return r;
}

Vec3 DomainStretch::to_lattice(const Vec3& r) const { return DomainStretch{body, domain, lattice}.to_domain(r); }

void drop_refinements_beside(const Box3& meshed, std::vector<MeshRefinement>& refinements, std::vector<std::string>& notes) {
  const auto is_beside = [&](const MeshRefinement& r) { return !meet(r.box, meshed); };
  for (const MeshRefinement& r : refinements)
    if (is_beside(r)) notes.push_back(fmt::format("the box {} that is to have cells of {:.4g} lies beside what is meshed, {}, and has no effect", text_of(r.box), r.cell, text_of(meshed)));
  std::erase_if(refinements, is_beside);
}

int levels_below_surface(const FlowMeshOptions& options, int most) {
  int levels = 0;
  for (const MeshRefinement& r : options.refinements) {
    const double below = std::ceil(std::log2(options.cell / r.cell) - kRounding);
    if (below > most)
      throw Error(ErrorCode::usage, fmt::format("the box {} is to have cells of {:.4g}: less than 1/{} of those at the surface, {:.4g}", text_of(r.box), r.cell, 1 << most, options.cell),
                  fmt::format("give it cells of at least {:.4g}, or choose a smaller --cell", options.cell / (1 << most)));
    levels = std::max(levels, static_cast<int>(below));
  }
  return levels;
}

std::vector<LatticeRefinement> on_lattice(const FlowMeshOptions& options, const GridFrame& frame, const DomainStretch& stretch, const LatticeBox& cells, int surface_level) {
  std::vector<LatticeRefinement> result;
  for (std::size_t i = 0; i < options.refinements.size(); ++i) {
    const MeshRefinement& r = options.refinements[i];
    const Box3 box{stretch.to_lattice(frame.to_lattice(r.box.lower)), stretch.to_lattice(frame.to_lattice(r.box.upper))};
    // Larger cells than the coarsest are not there: such a box has them as they are.
    const double level = surface_level + std::floor(std::log2(r.cell / options.cell) + kRounding);
    result.push_back({in_cells(box, cells), static_cast<int>(within(level, 0, surface_level + options.coarsest_level)), i});
  }
  return result;
}

// [T-HEX-2]
std::vector<LevelInBox> level_set_boxes(std::span<const LatticeRefinement> refinements, int cells_between_levels, int surface_level) {
  std::vector<LevelInBox> boxes;
  for (const LatticeRefinement& r : refinements) {
    LatticeBox box = r.box;
    for (int level = r.level; level < surface_level; ++level) {
      if (level > r.level) box = grown(box, std::int64_t{cells_between_levels} << level);
      box = rounded(box, level + 1);
      boxes.push_back({in_lattice_units(box), level});
    }
  }
  return boxes;
}

}  // namespace burnish
