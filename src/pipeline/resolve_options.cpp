#include "resolve_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "burnish/core/error.h"
#include "burnish/levelset/smooth/smoothing.h"
#include "burnish/surface/edge_table.h"
#include "burnish/surface/thickness.h"

namespace burnish {
namespace {

constexpr double kCoarsest = 1.0 / 300, kFinest = 1.0 / 1000;  // of the diagonal, for a default cell
constexpr double kCellsAcross = 6;             // of the mean thickness
constexpr double kCellsAcrossShell = 4;        // of the thickness of a shell that was asked for
constexpr double kCellsPerWall = 2;            // of its thickness, so that a wall is there at all
constexpr double kFinestForWalls = 1.0 / 1500, kMostCellsForWalls = 2e6;
constexpr double kMostCaps = 0.1;              // of the area, beyond which it is not refined for walls
constexpr double kThinShare = 0.02;            // of the area has to be walls that a finer cell would resolve
constexpr std::size_t kWallSamples = 4000;
constexpr double kCreaseShare = 0.3;           // of the surface may lie within a cell's width along creases
constexpr double kCreaseCosine = 0.766;        // of the angle between normals, 40 degrees: sharper edges are creases
constexpr double kLeastHeight = 0.01;          // of a facet over its edge: flatter ones have no reliable normal
constexpr double kCellsPerWave = 12;           // of the smoothing length: what is shorter will be gone
constexpr double kCoarsestSmoothed = 1.0 / 150;
constexpr double kMostCells = 1e6;             // of surface: about three million facets
constexpr double kCellMax = 8;                 // finest cells, of the coarsest at the surface
constexpr int kMostLevels = 10;
constexpr double kFacetsPerArea = 2.4;         // in units of the edge: somewhat more than equilateral ones
constexpr double kBytesPerSizedFacet = 1000;   // Delaunay, remeshing
constexpr double kBytesPerFacet = 250;         // input, index, inspection
constexpr double kBytesPerCell = 1000;         // of surface: extraction, result, verification
constexpr double kBytesPerCellAndBand = 100;   // of surface, and cell of band

double band_of(const CleanOptions& asked, FlowMode mode, double diagonal, double cell, double unsmoothed) {
  const double length = asked.smooth.in_model_units(diagonal, cell);
  return length > 0 ? kFlowBand + room_for_smoothing(mode, length / cell) : unsmoothed;
}

std::uint64_t bytes_for(std::size_t facets, double surface_area, double cell, double band) {
  const double cells = surface_area / (cell * cell);
  const double bytes = kBytesPerFacet * static_cast<double>(facets) + cells * (kBytesPerCell + kBytesPerCellAndBand * band);
  return static_cast<std::uint64_t>(std::min(bytes, 0x1p62));
}

// The finest cell from `cell` upwards that fits the budget. `band` gives the cells around the surface for a cell.
template <class Band>
double fitted_cell(std::uint64_t budget, const TriangleSoup& prepared, double cell, Band&& band) {
  const double surface_area = area(prepared);
  for (int i = 0; i < 200; ++i) {
    if (bytes_for(prepared.facets.size(), surface_area, cell, band(cell)) <= budget) break;
    cell *= 1.05;
  }
  return cell;
}

// Twice the volume over the area: the thickness of a plate, a third of a sphere's diameter.
double mean_thickness(const TriangleSoup& prepared) {
  const double a = area(prepared);
  return a > 0 ? 2 * std::abs(signed_volume(prepared)) / a : 0;
}

// Length of the edges at which two facets meet at more than 40 degrees. Cells round creases off, so a surface that is
// all creases needs smaller ones.
double crease_length(const TriangleSoup& soup) {
  const EdgeTable table(soup);
  double length = 0;
  for (std::size_t e = 0; e < table.size(); ++e) {
    const auto uses = table.uses(e);
    if (uses.size() != 2) continue;
    const Vec3 m = facet_normal_2a(soup, uses[0].facet), n = facet_normal_2a(soup, uses[1].facet);
    const double edge2 = squared_norm(soup.points[table.edge(e)[0]] - soup.points[table.edge(e)[1]]);
    const double lm = norm(m), ln = norm(n);
    if (std::min(lm, ln) < kLeastHeight * edge2) continue;
    const double cosine = dot(m, n) / (lm * ln);
    if ((table.is_misoriented(e) ? -cosine : cosine) < kCreaseCosine) length += std::sqrt(edge2);
  }
  return length;
}

// The cell that gives walls their two cells, if walls too thin for that are common and not too thin for any cell. [T-CELL-2]
double refined_for_walls(const CappedSoup& capped, double diagonal, double cell) {
  const TriangleSoup& prepared = capped.soup;
  // Between a cap and what it is to cover there are no walls to be resolved.
  if (capped.cap_area > kMostCaps * area(prepared)) return cell;
  const double finest = std::max(kFinestForWalls * diagonal, std::sqrt(area(prepared) / kMostCellsForWalls));
  if (!(finest < cell)) return cell;
  const std::vector<double> walls = wall_thicknesses(prepared, kWallSamples);
  const auto begin = std::lower_bound(walls.begin(), walls.end(), kCellsPerWall * finest);
  const auto end = std::lower_bound(begin, walls.end(), kCellsPerWall * cell);
  const auto thin = end - begin;
  if (static_cast<double>(thin) < kThinShare * static_cast<double>(kWallSamples)) return cell;
  return std::max(finest, *(begin + thin / 4) / kCellsPerWall);
}

// [T-CELL-1]
double default_cell(const CappedSoup& capped, double diagonal, const Length& smooth, const std::optional<double>& shell) {
  const TriangleSoup& prepared = capped.soup;
  const double at_creases = kCreaseShare * area(prepared) / std::max(crease_length(prepared), area(prepared) / diagonal);
  // The thickness of what is to be built: a sheet that becomes a shell has none of its own.
  const double across = shell ? *shell / kCellsAcrossShell : mean_thickness(prepared) / kCellsAcross;
  const double wanted = std::min({mean_edge_length(prepared), across, at_creases});
  const double finest = std::max(kFinest * diagonal, std::sqrt(area(prepared) / kMostCells));
  const double cell = std::clamp(wanted, std::min(finest, kCoarsest * diagonal), kCoarsest * diagonal);
  if (smooth.unit == LengthUnit::cells) return refined_for_walls(capped, diagonal, cell);
  const double enough = smooth.in_model_units(diagonal, 0) / kCellsPerWave;
  if (!(enough > cell)) return refined_for_walls(capped, diagonal, cell);
  return std::max(cell, std::min(enough, kCoarsestSmoothed * diagonal));
}

double given_default(const CleanOptions& asked, double diagonal) {
  const double cell = asked.default_cell->in_model_units(diagonal, 0), wave = asked.smooth.unit == LengthUnit::cells ? 0 : asked.smooth.in_model_units(diagonal, 0);
  return wave > 0 ? std::min(cell, wave / kCellsPerWave) : cell;
}

double asked_cell(const CleanOptions& asked, const Box3& box) {
  if (asked.resolution) return box.longest_side() / *asked.resolution;
  const double cell = asked.cell->in_model_units(box.diagonal(), 0);
  if (!(cell > 0)) throw Error(ErrorCode::usage, "--cell must be a length greater than zero", "for example --cell 0.5 or --cell 0.2%");
  return cell;
}

void refuse_too_many_facets(const ResolvedOptions& resolved, double surface_area) {
  if (!resolved.edge) return;
  const double facets = kFacetsPerArea * surface_area / (*resolved.edge * *resolved.edge), most = static_cast<double>(resolved.memory_bytes) / kBytesPerSizedFacet;
  if (facets <= most) return;
  throw Error(ErrorCode::memory_limit,
              fmt::format("edges of {:.4g} make about {:.3g} facets, which need {:.3g} GB; the budget is {:.1f} GB", *resolved.edge, facets, facets * kBytesPerSizedFacet * 0x1p-30,
                          static_cast<double>(resolved.memory_bytes) * 0x1p-30),
              fmt::format("choose a larger --edge (from about {:.4g}), or raise --memory", std::sqrt(kFacetsPerArea * surface_area / most)));
}

void resolve_adaptivity(const CleanOptions& asked, double diagonal, ResolvedOptions& resolved) {
  if (asked.adapt) resolved.adapt = asked.adapt->in_model_units(diagonal, resolved.cell);
  const double cell_max = asked.cell_max ? asked.cell_max->in_model_units(diagonal, resolved.cell) : kCellMax * resolved.cell;
  if (cell_max < resolved.cell * (1 - 1e-9))
    throw Error(ErrorCode::usage, fmt::format("--cell-max {:.4g} is smaller than the finest cell, {:.4g}", cell_max, resolved.cell),
                "give a larger one, such as --cell-max 8h");
  // Cells double from level to level; the last one that is no larger than what was asked for.
  resolved.coarsest_level = std::min(kMostLevels, static_cast<int>(std::floor(std::log2(cell_max / resolved.cell) + 1e-9)));
}

}  // namespace

std::uint64_t planned_bytes(const TriangleSoup& prepared, double cell, double band) {
  return bytes_for(prepared.facets.size(), area(prepared), cell, band);
}

FlowMode flow_mode(SmoothMode mode) {
  switch (mode) {
    case SmoothMode::volume: return FlowMode::volume;
    case SmoothMode::filtered: return FlowMode::filtered;
    case SmoothMode::reinit: return FlowMode::reinit;
    case SmoothMode::automatic:
    case SmoothMode::feature:
    case SmoothMode::mcf: break;
  }
  return FlowMode::mcf;
}

ResolvedOptions resolve_lengths(const CleanOptions& asked, double diagonal) {
  const auto length = [&](const std::optional<Length>& l) { return l ? std::optional(l->in_model_units(diagonal, 0)) : std::nullopt; };
  ResolvedOptions resolved{static_cast<const PlainOptions&>(asked), {}};
  resolved.gap = length(asked.gap);
  resolved.max_hole = asked.keep_openings ? std::optional(0.0) : length(asked.max_hole);
  resolved.thicken = length(asked.thicken);
  resolved.curvature_radius = length(asked.curvature_radius);
  if (asked.deviation && asked.deviation->unit != LengthUnit::cells) resolved.deviation = length(asked.deviation);
  resolved.offset = length(asked.offset);
  if (resolved.offset && asked.offset_inwards) resolved.offset = -*resolved.offset;
  resolved.hollow = length(asked.hollow);
  resolved.simplify = length(asked.simplify);
  return resolved;
}

void resolve_cell(const CleanOptions& asked, const CappedSoup& capped, ResolvedOptions& resolved, std::vector<std::string>& warnings,
                  double unsmoothed_band) {
  const TriangleSoup& prepared = capped.soup;
  const Box3 box = bounding_box(prepared);
  const double diagonal = box.diagonal(), half_shell = 0.5 * resolved.thicken.value_or(0);
  const double walls = std::abs(resolved.offset.value_or(0)) + resolved.hollow.value_or(0);
  const std::optional<double> wall = resolved.thicken ? resolved.thicken : resolved.hollow;  // that is to be built
  const auto band = [&](double cell) { return band_of(asked, flow_mode(resolved.mode), diagonal, cell, unsmoothed_band) + (half_shell + walls) / cell; };
  resolved.cell_was_chosen = !asked.cell && !asked.resolution;
  if (resolved.cell_was_chosen) {
    double wanted = asked.default_cell ? given_default(asked, diagonal) : default_cell(capped, diagonal, asked.smooth, resolved.thicken);
    if (wall) wanted = std::max(std::min(wanted, *wall / kCellsAcrossShell), std::sqrt(2 * area(prepared) / kMostCellsForWalls));
    resolved.cell = fitted_cell(asked.share_of_memory(), prepared, wanted, band);
    if (resolved.cell > wanted && asked.memory_shares > 1)
      throw Error(ErrorCode::memory_limit, fmt::format("the default cell of {:.4g} does not fit into a share of 1/{} of the memory", wanted, asked.memory_shares), "run it alone");
    if (resolved.cell > wanted)
      warnings.push_back(fmt::format("the default cell of {:.4g} was coarsened to {:.4g} to stay within the memory budget", wanted, resolved.cell));
  } else {
    resolved.cell = asked_cell(asked, box);
    const std::uint64_t needed = planned_bytes(prepared, resolved.cell, band(resolved.cell));
    if (needed > asked.share_of_memory())
      throw Error(ErrorCode::memory_limit,
                  fmt::format("a cell of {:.4g} ({:.0f} along the longest side) needs about {:.1f} GB; the budget is {:.1f} GB", resolved.cell,
                              box.longest_side() / resolved.cell, static_cast<double>(needed) * 0x1p-30,
                              static_cast<double>(asked.share_of_memory()) * 0x1p-30),
                  fmt::format("choose a larger --cell (from about {:.4g}), or raise --memory", fitted_cell(asked.share_of_memory(), prepared, resolved.cell, band)));
  }
  if (wall && *wall < kCellsPerWall * resolved.cell)
    throw Error(ErrorCode::guarantee_unmet,
                fmt::format("a {} of thickness {:.4g} needs cells of {:.4g} or less; the cell is {:.4g}", resolved.thicken ? "shell" : "wall", *wall,
                            *wall / kCellsPerWall, resolved.cell),
                fmt::format("make it thicker, or give the cell: --cell {:.4g}", *wall / kCellsAcrossShell));
  resolved.cells_along_longest_side = box.longest_side() / resolved.cell;
  resolved.smooth = asked.smooth.in_model_units(diagonal, resolved.cell);
  resolve_adaptivity(asked, diagonal, resolved);
  const auto length = [&](const std::optional<Length>& l) { return l ? std::optional(l->in_model_units(diagonal, resolved.cell)) : std::nullopt; };
  if (asked.deviation) resolved.deviation = length(asked.deviation);
  resolved.edge = length(asked.edge);
  refuse_too_many_facets(resolved, area(prepared));
  resolved.edge_tolerance = length(asked.edge_tolerance);
}

}  // namespace burnish
