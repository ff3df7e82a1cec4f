#include "local_gear.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "burnish/core/parallel.h"
#include "burnish/core/union_find.h"
#include "burnish/surface/local_repair.h"
#include "burnish/surface/shells.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/weld.h"
#include "losses.h"

namespace burnish {
namespace {

constexpr double kVolumeTolerance = 0.02;   // of the prepared input's volume
constexpr double kMostEnclosingNothing = 0.05;  // of the area
constexpr double kFillingDiffers = 0.25;    // of the width of a hole: how far apart two fillings may be

TriangleSoup picked(const TriangleSoup& soup, const std::vector<std::uint32_t>& facets) {
  TriangleSoup part;
  part.points = soup.points;
  for (const std::uint32_t f : facets) part.facets.push_back(soup.facets[f]);
  return weld(std::move(part));
}

// The prepared facets that are not of absorbed shells.
std::vector<std::uint32_t> facets_in_use(const PreparedInput& prepared) {
  std::vector<std::uint32_t> facets;
  for (std::uint32_t f = 0; f < prepared.oriented.facets.size(); ++f)
    if (prepared.shell_fates[prepared.shells.of_facet[f]] == FacetFate::used) facets.push_back(f);
  return facets;
}

double expected_volume(const PreparedInput& prepared) {
  double volume = 0;
  for (std::size_t s = 0; s < prepared.shells.shells.size(); ++s)
    if (prepared.shell_fates[s] == FacetFate::used) volume += prepared.shells.shells[s].volume;
  return volume;
}

// By how much ways to fill holes may differ: each by a part of the filling's width.
double volume_of_fillings(const std::vector<Hole>& holes) {
  double volume = 0;
  for (const Hole& hole : holes)
    if (hole.filled) volume += kFillingDiffers * hole.area * hole.width();
  return volume;
}

// What two surfaces do not have in common.
struct Difference {
  std::vector<std::uint32_t> removed;  // facets of the input, but for those that were left out on purpose
  std::vector<std::uint32_t> left_out;
  std::vector<std::uint32_t> added;    // facets of the result that fill no hole
  std::vector<std::uint32_t> filling;
};

Difference difference(const LocalSolution& solution, const PreparedInput& prepared, std::size_t input_facets) {
  Difference d;
  std::vector<char> kept(input_facets, 0);
  for (std::uint32_t f = 0; f < solution.source.size(); ++f) {
    if (solution.source[f] != kNoFacet)
      kept[solution.source[f]] = 1;
    else
      (solution.fills_hole[f] ? d.filling : d.added).push_back(f);
  }
  for (std::uint32_t f = 0; f < input_facets; ++f)
    if (!kept[f]) (prepared.fates[f] == FacetFate::used ? d.removed : d.left_out).push_back(f);
  return d;
}

double area_of(const TriangleSoup& soup, const std::vector<std::uint32_t>& facets) {
  double sum = 0;
  for (const std::uint32_t f : facets) sum += 0.5 * norm(facet_normal_2a(soup, f));
  return sum;
}

// The distances of two parts of a surface that have these shares of its area; the rest coincides.
OneSidedDistance sum(const OneSidedDistance& p, double share_p, const OneSidedDistance& q, double share_q) {
  return {std::max(p.max, q.max), p.mean * share_p + q.mean * share_q,
          std::sqrt(p.rms * p.rms * share_p + q.rms * q.rms * share_q), p.samples + q.samples};
}

// What an exact union leaves out lies inside it, or encloses nothing: it is listed, and no solid has it. Only where much of
// it encloses nothing, the facets may be meant otherwise.
std::string objection_to_union(const std::vector<FarSample>& gone, const PreparedInput& prepared, const TriangleIndex& result,
                               double area_before, RepairReport& report) {
  double nothing = 0;
  // A cavity's wall inside another cavity has a winding number of -1/2.
  const TriangleIndex before(gone.empty() ? TriangleSoup{} : prepared.capped.soup);
  const std::vector<Loss> losses = gather_losses(gone, report.before.box.diagonal(), [&](const FarSample& sample) -> std::string {
    if (result.winding_number(sample.at) > 0.5 || before.winding_number(sample.at) < -0.25) return std::string(reason(FacetFate::absorbed));
    nothing += sample.area;
    return "encloses nothing";
  });
  report.losses.insert(report.losses.end(), losses.begin(), losses.end());
  return nothing > kMostEnclosingNothing * area_before ? "too much of it encloses nothing" : "";
}

// The places where facets changed: sets of removed and added facets that share points.
std::vector<Change> changes_of(const Difference& d, const TriangleSoup& welded, const TriangleSoup& result) {
  TriangleSoup both;
  both.points = welded.points;
  both.points.insert(both.points.end(), result.points.begin(), result.points.end());
  const auto shift = static_cast<std::uint32_t>(welded.points.size());
  for (const auto* list : {&d.removed, &d.left_out})
    for (const std::uint32_t f : *list) both.facets.push_back(welded.facets[f]);
  const std::size_t gone = both.facets.size();
  for (const auto* list : {&d.added, &d.filling})
    for (const std::uint32_t f : *list) {
      Facet facet = result.facets[f];
      for (std::uint32_t& p : facet) p += shift;
      both.facets.push_back(facet);
    }
  both = weld(std::move(both));
  UnionFind places = connected_points(both);
  std::vector<Change> change_at(both.points.size());
  std::vector<Box3> box_at(both.points.size());
  for (std::size_t f = 0; f < both.facets.size(); ++f) {
    const std::uint32_t place = places.find(both.facets[f][0]);
    ++(f < gone ? change_at[place].facets_removed : change_at[place].facets_added);
    for (int i = 0; i < 3; ++i) box_at[place].extend(both.corner(f, i));
  }
  std::vector<Change> changes;
  for (std::size_t p = 0; p < change_at.size(); ++p) {
    if (box_at[p].empty()) continue;
    change_at[p].position = box_at[p].center();
    change_at[p].extent = box_at[p].diagonal();
    changes.push_back(change_at[p]);
  }
  std::stable_sort(changes.begin(), changes.end(), [](const Change& a, const Change& b) {
    return a.facets_removed + a.facets_added > b.facets_removed + b.facets_added;
  });
  return changes;
}

}  // namespace

std::string reason_against_local(const CleanOptions& options, bool flows) {
  if (options.method == Method::level_set) return "asked for";
  if (flows) return "smoothing of the level set was asked for";
  if (options.moves_walls()) return "a parallel surface was asked for";
  if (options.thicken) return "a thickness was asked for";
  if (options.method == Method::automatic && options.asks_for_extraction()) return "a surface extracted anew was asked for";
  if (options.method == Method::automatic && (options.cell || options.resolution || options.adapt)) return "a cell was asked for";
  return {};
}

LocalSolution unchanged(const TriangleSoup& welded) {
  LocalSolution solution{welded, std::vector<std::uint32_t>(welded.facets.size()), std::vector<char>(welded.facets.size(), 0), false};
  std::iota(solution.source.begin(), solution.source.end(), 0u);
  return solution;
}

std::optional<LocalSolution> solve_locally(const TriangleSoup& welded, const PreparedInput& prepared, LocalRepairOptions options, RepairReport& report, Progress& progress,
                                           std::string& refusal) {
  const std::vector<std::uint32_t> used = facets_in_use(prepared);
  options.max_hole = report.options.max_hole;
  LocalRepairResult repaired = repair_locally(picked(prepared.oriented, used), options, progress);
  if (!repaired.refusal.empty()) {
    refusal = repaired.refusal;
    return std::nullopt;
  }
  RepairActions& actions = report.actions;
  actions.facets_cut = repaired.facets_cut;
  actions.needles_flipped = repaired.needles_flipped;
  actions.points_split = repaired.points_split;
  actions.largest_split = repaired.largest_split;
  actions.intersecting_pairs_removed = repaired.intersecting_pairs_removed;
  report.holes = std::move(repaired.holes);
  LocalSolution solution{std::move(repaired.soup), std::move(repaired.source), std::move(repaired.fills_hole), repaired.facets_cut > 0};
  // Joining points has moved some before they came here.
  for (std::size_t f = 0; f < solution.source.size(); ++f) {
    std::uint32_t& source = solution.source[f];
    if (source != kNoFacet) source = prepared.source[used[source]];
    if (source != kNoFacet && !has_same_points(solution.soup, f, welded, source)) source = kNoFacet;
  }
  return solution;
}

std::string objection_to(const LocalSolution& solution, const TriangleSoup& result, const TriangleSoup& welded,
                         const PreparedInput& prepared, double tolerance, RepairReport& report) {
  const Difference d = difference(solution, prepared, welded.facets.size());
  const std::size_t gone = d.removed.size() + d.left_out.size();
  report.actions.facets_removed = gone;
  report.actions.facets_added = d.added.size() + d.filling.size();
  report.actions.facets_kept = welded.facets.size() - gone;
  report.deviation = {};
  const double before = area(welded), after = area(result);
  std::string objection;
  if (gone > 0) {
    const TriangleIndex index(result);
    std::vector<FarSample> far, gone_far;
    const OneSidedDistance lost = one_sided_distance(picked(welded, d.removed), index, {.far_beyond = tolerance}, &gone_far);
    const OneSidedDistance left = one_sided_distance(picked(welded, d.left_out), index, {.far_beyond = tolerance}, &far);
    report.deviation.input_to_output = sum(lost, area_of(welded, d.removed) / before, left, area_of(welded, d.left_out) / before);
    report.losses = gather_losses(far, report.before.box.diagonal(), [&](const FarSample& sample) { return std::string(reason(prepared.fates[d.left_out[sample.facet]])); });
    if (solution.united)
      objection = objection_to_union(gone_far, prepared, index, before, report);
    else if (lost.max > tolerance)
      objection = fmt::format("{:.3g} away from the result something of the input would be lost", lost.max);
  }
  const std::vector<std::uint32_t>& added = d.added;
  if (added.size() + d.filling.size() > 0) {
    const TriangleIndex input(welded);
    const OneSidedDistance moved = one_sided_distance(picked(result, added), input);
    const OneSidedDistance filled = one_sided_distance(picked(result, d.filling), input);
    if (moved.max > tolerance) objection = fmt::format("facets would come to lie {:.3g} away from the input", moved.max);
    report.deviation.output_to_input = sum(moved, area_of(result, added) / after, filled, area_of(result, d.filling) / after);
  }
  report.changes = changes_of(d, welded, result);
  const double filled_share = volume_of_fillings(report.holes) / std::max(std::abs(report.after.volume), 1e-300);
  if (objection.empty() && solution.united && !is_same_solid(prepared.capped.soup, result, filled_share)) objection = "it would not be the solid that the facets enclose";
  const double volume = expected_volume(prepared), allowed = kVolumeTolerance * std::abs(volume) + volume_of_fillings(report.holes);
  if (objection.empty() && !solution.united && !report.is_sheet && !(std::abs(report.after.volume - volume) <= allowed))
    objection = fmt::format("its volume of {:.6g} would not be the {:.6g} that the facets enclose", report.after.volume, volume);
  return objection;
}

bool is_same_solid(const TriangleSoup& a, const TriangleSoup& b, double more) {
  constexpr std::size_t kPoints = 4096;
  constexpr double kMostDisagreeing = 0.005;  // of the points that are inside
  const TriangleIndex before(a), after(b);
  const Box3 box = bounding_box(a);
  std::vector<char> in(kPoints), out(kPoints);
  parallel_for(kPoints, [&](std::size_t i) {
    // The R3 sequence (Roberts 2018).
    const double t = static_cast<double>(i) + 1;
    const auto part = [t](double step) { return t * step - std::floor(t * step); };
    const Vec3 e = box.extent();
    const Vec3 p = box.lower + Vec3{part(0.8191725133961645) * e.x, part(0.6710436067037893) * e.y, part(0.5497004779019703) * e.z};
    in[i] = before.winding_number(p) > 0.5;
    out[i] = after.winding_number(p) > 0.5;
  }, 64);
  std::size_t inside = 0, differ = 0;
  for (std::size_t i = 0; i < kPoints; ++i) {
    inside += in[i] || out[i];
    differ += in[i] != out[i];
  }
  return static_cast<double>(differ) <= std::max(2.0, (kMostDisagreeing + more) * static_cast<double>(inside));
}

bool has_same_points(const TriangleSoup& a, std::size_t f, const TriangleSoup& b, std::size_t g) {
  for (int i = 0; i < 3; ++i)
    if (a.corner(f, i) != b.corner(g, 0) && a.corner(f, i) != b.corner(g, 1) && a.corner(f, i) != b.corner(g, 2)) return false;
  return true;
}

}  // namespace burnish
