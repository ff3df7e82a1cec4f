#include "level_set_gear.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "burnish/core/parallel.h"
#include "burnish/core/union_find.h"
#include "burnish/extract/trim.h"
#include "burnish/levelset/adapt.h"
#include "burnish/levelset/curvature.h"
#include "burnish/levelset/offset.h"
#include "burnish/levelset/redistance.h"
#include "burnish/levelset/smooth/smoothing.h"
#include "burnish/surface/sheet_block.h"
#include "burnish/surface/triangle_index.h"
#include "resolve_options.h"

namespace burnish {
namespace {

constexpr double kSheetMargin = 0.02;     // of the diagonal: how far a sheet goes on beyond its rim, at least
constexpr double kNegligibleArea = 1e-4;  // of the input's: unresolved details beyond this are worth a warning
constexpr double kDebrisShare = 1e-3;     // of the largest piece's volume: smaller ones need a component to stand for
constexpr std::size_t kVotesPerComponent = 64;
constexpr double kVoteReach = 3;          // cells
constexpr double kVolumeKept = 1e-3;      // drift of the volume beyond which the user is told
constexpr double kDomainMargin = 11;      // cells between the band and the walls
constexpr double kZerosOnly = 1.5;        // cells: nodes this near to the surface say where it is
constexpr double kRampInCells = 2, kRampInLengths = 0.5;  // from a region's border to where the surface moves freely
constexpr double kCrumb = 0.25;           // cells: a part of either sign that stays nearer to the rim than this is none

// Cells of distances that moving the surface uses up.
double cells_for_walls(const ResolvedOptions& options) {
  return (std::abs(options.offset.value_or(0)) + options.hollow.value_or(0)) / options.cell;
}

// Smoothing and extraction look no farther than the band, so the far field is left out.
LevelSetOptions level_set_options(const ResolvedOptions& options) {
  const double walls = options.moves_walls() ? kLeastBand + 1 + cells_for_walls(options) : 0;
  const double curvatures = options.edge_tolerance ? curvature_band(CurvatureOrder::second) : 0;
  LevelSetOptions set{.band = std::max({kUnsmoothedBand, walls, curvatures}), .room = 0, .far_field = false};
  const double smooth_cells = options.smooth / options.cell;
  if (smooth_cells <= 0) {
    // A shell's level set is coarsened afterwards, as is what has been smoothed.
    if (options.adapt && !options.thicken && !options.moves_walls()) {
      set.adaptivity.tolerance = *options.adapt / options.cell;
      set.adaptivity.limits.coarsest_level = options.coarsest_level;
    }
    return set;
  }
  set.room = room_for_smoothing(flow_mode(options.mode), smooth_cells);
  // A bound on the deviation is held against exact distances.
  const double bound = options.deviation ? *options.deviation / options.cell : 0;
  set.band = std::max({kFlowBand, std::min(bound, set.room) + 1, walls, curvatures});
  return set;
}

void tell_grid(const Octree& tree, RepairReport& report) {
  report.grid.blocks = tree.size();
  report.grid.finest_blocks = 0;
  report.grid.levels = tree.depth() + 1;
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) report.grid.finest_blocks += tree.level(leaf) == 0;
}

// Facets without an area bound nothing, and their distances are their neighbours'.
std::vector<std::uint32_t> facets_with_area(const TriangleSoup& soup) {
  std::vector<std::uint32_t> facets;
  for (std::uint32_t f = 0; f < soup.facets.size(); ++f)
    if (squared_norm(facet_normal_2a(soup, f)) > 0) facets.push_back(f);
  return facets;
}

void tell_unresolved(const LevelSetFromTriangles& built, RepairReport& report) {
  const double cell = report.options.cell;
  report.actions.ambiguous_regions = built.ambiguous_regions;
  report.actions.interior_facets_ignored = built.interior_facets;
  report.actions.unresolved_facets = built.unresolved_facets;
  report.actions.unresolved_area = built.unresolved_area * cell * cell;
  if (report.actions.unresolved_area > kNegligibleArea * report.before.area)
    report.warnings.push_back(
        fmt::format("{} facets ({:.3g} of area) bound sheets or walls thinner than a cell of {:.4g} and are not in the result; "
                    "choose a smaller --cell if they matter",
                    built.unresolved_facets, report.actions.unresolved_area, cell));
}

// For each component of the input the piece that most of its facets are closest to, of those they are close to at all.
std::vector<std::uint32_t> pieces_of_components(const TriangleSoup& surface, const Shells& pieces, const PreparedInput& prepared,
                                                const GridFrame& frame) {
  const TriangleIndex index(surface);
  const std::size_t components = prepared.shells.shells.size();
  std::vector<std::map<std::uint32_t, std::size_t>> votes(components);
  std::vector<std::size_t> seen(components, 0);
  for (std::size_t f = 0; f < prepared.oriented.facets.size(); ++f) {
    const std::uint32_t c = prepared.shells.of_facet[f];
    if (seen[c]++ % std::max<std::size_t>(1, prepared.shells.shells[c].facets / kVotesPerComponent) != 0) continue;
    const TriangleSoup& soup = prepared.oriented;
    const Vec3 at = frame.to_lattice((soup.corner(f, 0) + soup.corner(f, 1) + soup.corner(f, 2)) / 3.0);
    const auto closest = index.closest(at, kVoteReach * kVoteReach);
    if (closest.facet != kNoFacet) ++votes[c][pieces.of_facet[closest.facet]];
  }
  std::vector<std::uint32_t> chosen;
  const auto fewer = [](const auto& a, const auto& b) { return a.second < b.second; };
  for (const auto& vote : votes)
    if (!vote.empty()) chosen.push_back(std::max_element(vote.begin(), vote.end(), fewer)->first);
  return chosen;
}

// At the rim of an opening both distances are the same up to rounding: points there that have another sign than all
// points around them would become crumbs of the sheet, or pinholes in it.
void turn_crumbs(const TriangleSoup& surface, double least, std::vector<double>& values) {
  UnionFind parts(values.size());
  for (const Facet& f : surface.facets)
    for (std::size_t i = 0; i < 3; ++i)
      if ((values[f[i]] >= 0) == (values[f[(i + 1) % 3]] >= 0)) parts.unite(f[i], f[(i + 1) % 3]);
  std::vector<double> reach(values.size(), 0.0);
  for (std::uint32_t p = 0; p < values.size(); ++p) reach[parts.find(p)] = std::max(reach[parts.find(p)], std::abs(values[p]));
  for (std::uint32_t p = 0; p < values.size(); ++p)
    if (reach[parts.find(p)] < least) values[p] = values[p] >= 0 ? -least : least;
}

// The region's mobility at the nodes of a level set.
Field<float> mobility_field(const LevelSet& set, const Region& region, double ramp, Progress& progress) {
  Field<float> mobility = Field<float>::like(set.phi, 0.0f, 0.0f);
  parallel_for(set.octree().size(), [&](std::size_t leaf) {
    if (!mobility.stores(leaf)) return;
    progress.check();
    const auto corner = set.octree().corner(leaf);
    const int step = 1 << set.octree().level(leaf);
    float* const block = mobility.block(leaf);
    const double half = 0.5 * kBlockSide * step;
    const Vec3 lower{static_cast<double>(corner.x), static_cast<double>(corner.y), static_cast<double>(corner.z)};
    const Vec3 center = set.frame.to_model(lower * kBlockSide + Vec3{half, half, half});
    if (const auto same = region.uniform_mobility(center, std::sqrt(3.0) * half * set.frame.cell, ramp)) {
      std::fill_n(block, kBlockNodes, static_cast<float>(*same));
      return;
    }
    for (int k = 0; k < kBlockSide; ++k)
      for (int j = 0; j < kBlockSide; ++j)
        for (int i = 0; i < kBlockSide; ++i) {
          const Vec3 node{kBlockSide * static_cast<double>(corner.x) + step * i, kBlockSide * static_cast<double>(corner.y) + step * j,
                          kBlockSide * static_cast<double>(corner.z) + step * k};
          block[node_index(i, j, k)] = static_cast<float>(region.mobility(set.frame.to_model(node), ramp));
        }
  }, 4);
  return mobility;
}

void warn_of_smoothing(const SmoothingResult& done, RepairReport& report) {
  const ResolvedOptions& options = report.options;
  if (done.unsteady > 0)
    report.warnings.push_back(fmt::format("redistancing by {} was not steady {} times: the surface may have moved with it; --redistance closest is exact and faster",
                                          name(options.redistance), done.unsteady));
  const double drift = done.volume_after / done.volume_before - 1;
  if (options.keep_volume && !(std::abs(drift) <= kVolumeKept))
    report.warnings.push_back(fmt::format("smoothing changed the volume by {:.2g} %: {}", 100 * drift,
                                          options.deviation ? "the bound on the deviation did not let it be restored"
                                                            : "the smoothing length is too large for this model"));
}

}  // namespace

void close_sheet(PreparedInput& prepared, const CleanOptions& asked, RepairReport& report) {
  // The sheet: the facets and what fills the holes that are to be closed.
  const std::size_t facets = prepared.oriented.facets.size();
  CappedSoup sheet{prepared.capped.soup, facets, {}, 0};
  std::vector<Facet>& kept = sheet.soup.facets;
  kept.resize(facets);
  for (const Cap& cap : prepared.capped.caps) {
    if (cap.hole.width() > *report.options.max_hole) continue;
    sheet.caps.push_back({cap.hole, kept.size(), cap.facet_count});
    const auto begin = prepared.capped.soup.facets.begin() + static_cast<std::ptrdiff_t>(cap.first_facet);
    kept.insert(kept.end(), begin, begin + static_cast<std::ptrdiff_t>(cap.facet_count));
  }
  const double diagonal = report.before.box.diagonal(), reach = kSheetMargin * diagonal + asked.smooth.in_model_units(diagonal, kSheetMargin * diagonal);
  if (auto block = close_as_block(sheet.soup, reach, 2 * reach)) {
    block->caps.insert(block->caps.end(), sheet.caps.begin(), sheet.caps.end());
    block->first_cap_facet = facets;
    prepared.capped = std::move(*block);
  }
}

BuiltLevelSet build_level_set(const PreparedInput& prepared, RepairReport& report, Progress& progress) {
  return build_level_set(prepared, level_set_options(report.options), report, progress);
}

BuiltLevelSet build_level_set(const PreparedInput& prepared, const LevelSetOptions& set, RepairReport& report, Progress& progress) {
  const ResolvedOptions& options = report.options;
  BuiltLevelSet result;
  result.roles.assign(prepared.capped.soup.facets.size(), FacetRole::boundary);
  const double half = options.thicken ? 0.5 * *options.thicken / options.cell : 0;
  const double reach = set.band + set.room + half;
  if (options.thicken) {
    const GridFrame frame = make_frame(bounding_box(prepared.oriented), options.cell, reach + kDomainMargin);
    result.level_set = level_set_of_shell(prepared.oriented, frame, half, set, progress);
  } else {
    result.facets = facets_with_area(prepared.capped.soup);
    const std::vector<std::uint32_t>& facets = result.facets;
    TriangleSoup solid{prepared.capped.soup.points, {}, {}};
    for (const std::uint32_t f : facets) solid.facets.push_back(prepared.capped.soup.facets[f]);
    // Coarse cells that the surface cuts, and their neighbours, have to end before the walls.
    const double coarse = set.adaptivity.wanted() ? 3.0 * (1 << set.adaptivity.limits.coarsest_level) : 0;
    const GridFrame frame = make_frame(bounding_box(solid), options.cell, std::max(reach + kDomainMargin, coarse));
    LevelSetFromTriangles built = level_set_from_triangles(solid, frame, set, progress);
    for (std::size_t i = 0; i < facets.size(); ++i) result.roles[facets[i]] = built.roles[i];
    tell_unresolved(built, report);
    result.regions = built.regions;
    result.growth = std::move(built.growth);
    result.certainty = std::move(built.certainty);
    result.nearest = std::move(built.nearest);
    parallel_for(result.nearest.values().size(), [&](std::size_t n) {
      std::uint32_t& facet = result.nearest.values()[n];
      if (facet != kNoFacet) facet = facets[facet];
    });
    result.level_set = std::move(built.level_set);
  }
  tell_grid(result.level_set.octree(), report);
  report.grid.bytes_planned = planned_bytes(prepared.capped.soup, options.cell, reach);
  return result;
}

BuiltLevelSet build_level_set(const VolumeInput& volume, const PreparedInput& prepared, RepairReport& report, Progress& progress) {
  const LevelSetOptions set = level_set_options(report.options);
  BuiltLevelSet result;
  result.roles.assign(prepared.capped.soup.facets.size(), FacetRole::boundary);
  result.level_set = volume.level_set(set.band, set.room, progress).level_set;
  result.level_set.frame.origin -= report.recentred_by;
  tell_grid(result.level_set.octree(), report);
  report.grid.bytes_planned = planned_bytes(prepared.capped.soup, report.options.cell, set.band + set.room);
  return result;
}

void coarsen_level_set(LevelSet& level_set, RepairReport& report, Progress& progress) {
  const ResolvedOptions& options = report.options;
  // What is extracted afterwards are the zeros: farther away, where the field has been clamped, signs will do.
  level_set.band = std::min(level_set.band, kZerosOnly);
  level_set = coarsen(level_set, *options.adapt / options.cell, options.coarsest_level, progress);
  tell_grid(level_set.octree(), report);
}

void smooth_level_set(LevelSet& level_set, const SmoothingPlan& plan, RepairReport& report, Progress& progress) {
  const ResolvedOptions& options = report.options;
  const double square = options.cell * options.cell;
  const auto in_cells = [&](const std::optional<double>& length) { return length ? std::optional(*length / options.cell) : std::nullopt; };
  SmoothingOptions asked;
  asked.mode = flow_mode(plan.mode);
  asked.length = options.smooth / options.cell;
  asked.target_rms = in_cells(plan.stop_at);
  asked.deviation = in_cells(options.deviation);
  asked.keep_volume = options.keep_volume;
  asked.curvature_radius = in_cells(options.curvature_radius).value_or(0);
  asked.redistance = options.redistance;
  Field<float> mobility;
  if (plan.region) {
    mobility = mobility_field(level_set, *plan.region, std::max(kRampInCells * options.cell, kRampInLengths * options.smooth), progress);
    asked.mobility = &mobility;
  }
  const SmoothingResult done = smooth(level_set, asked, progress);
  SmoothingSummary& told = report.smoothing;
  told.length = options.smooth;
  told.flow_time = done.time * square;
  told.steps = done.steps;
  told.redistance = options.redistance;
  told.rms_moved = done.rms_moved * options.cell;
  told.volume_before = done.volume_before * square * options.cell;
  told.volume_after = done.volume_after * square * options.cell;
  warn_of_smoothing(done, report);
}

void move_walls(LevelSet& level_set, const ResolvedOptions& options, Progress& progress) {
  // Smoothing has kept less of a band than that.
  if (options.smooth > 0) redistance(level_set, {.reach = level_set.band}, progress);
  if (options.offset) offset(level_set, *options.offset / options.cell);
  if (options.hollow) hollow(level_set, *options.hollow / options.cell);
}

std::vector<Facet> leave_out_debris(TriangleSoup& surface, const PreparedInput& prepared, const GridFrame& frame) {
  if (count_connected(surface) <= prepared.shells.shells.size()) return {};
  const Shells pieces = find_shells(surface);
  double largest = 0;
  for (const Shell& piece : pieces.shells) largest = std::max(largest, std::abs(piece.volume));
  std::vector<char> debris(pieces.shells.size());
  for (std::size_t s = 0; s < debris.size(); ++s) debris[s] = std::abs(pieces.shells[s].volume) < kDebrisShare * largest;
  if (std::find(debris.begin(), debris.end(), 1) == debris.end()) return {};
  for (const std::uint32_t piece : pieces_of_components(surface, pieces, prepared, frame)) debris[piece] = 0;
  std::vector<Facet> kept, left_out;
  for (std::size_t f = 0; f < surface.facets.size(); ++f) (debris[pieces.of_facet[f]] ? left_out : kept).push_back(surface.facets[f]);
  surface.facets = std::move(kept);
  return left_out;
}

TriangleSoup without_kept_caps(const TriangleSoup& surface, const PreparedInput& prepared, const ResolvedOptions& options) {
  const TriangleSoup& all = prepared.capped.soup;
  TriangleSoup kept{all.points, {}, {}}, openings{all.points, {}, {}};
  kept.facets.assign(all.facets.begin(), all.facets.begin() + static_cast<std::ptrdiff_t>(prepared.capped.first_cap_facet));
  for (const Cap& cap : prepared.capped.caps) {
    TriangleSoup& to = cap.hole.width() > *options.max_hole ? openings : kept;
    const auto begin = all.facets.begin() + static_cast<std::ptrdiff_t>(cap.first_facet);
    to.facets.insert(to.facets.end(), begin, begin + static_cast<std::ptrdiff_t>(cap.facet_count));
  }
  if (openings.facets.empty()) return surface;
  const TriangleIndex near_kept(kept), near_openings(openings);
  std::vector<double> values(surface.points.size());
  parallel_for(values.size(), [&](std::size_t i) {
    const Vec3& p = surface.points[i];
    values[i] = std::sqrt(near_openings.closest(p).squared_distance) - std::sqrt(near_kept.closest(p).squared_distance);
  });
  turn_crumbs(surface, kCrumb * options.cell, values);
  return trim_negative(surface, values);
}

}  // namespace burnish
