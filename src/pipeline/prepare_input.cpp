#include "prepare_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "burnish/core/union_find.h"
#include "burnish/surface/edge_table.h"
#include "burnish/surface/facet_filter.h"
#include "burnish/surface/manifold.h"
#include "burnish/surface/orient.h"
#include "burnish/surface/outliers.h"
#include "burnish/surface/weld.h"

namespace burnish {
namespace {

constexpr double kUnmatchedShare = 0.05;  // of the edges, beyond which open edges are welded within a tolerance
constexpr double kWeldShare = 0.1;        // of the median edge: that tolerance
constexpr double kSheetCapShare = 0.75;   // caps larger than this part of the input's area
constexpr double kSheetRoundness = 0.02;  // and whose solid is flat by this measure are sheets
constexpr double kFlatRoundness = 1e-7;   // below this there is nothing inside
constexpr double kFewSheets = 0.05;       // of the area: pieces that are sheets may be left out up to that
constexpr double kWeldedSoup = 0.5;       // of the edges unmatched: nothing but points near each other joins the facets
constexpr double kWeldDiagonals = 1e-3;   // the tolerance's bound, unless that is so
constexpr double kManyFlipped = 0.1;      // of the facets against their neighbours: worth a warning

double median_edge(const TriangleSoup& soup) {
  std::vector<double> lengths;
  lengths.reserve(soup.facets.size() * 3);
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    for (int i = 0; i < 3; ++i) lengths.push_back(norm(soup.corner(f, (i + 1) % 3) - soup.corner(f, i)));
  if (lengths.empty()) return 0;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

double open_share(const TriangleSoup& soup) {
  const EdgeTable table(soup);
  std::size_t open = 0;
  for (std::size_t e = 0; e < table.size(); ++e) open += table.is_open(e);
  return table.size() ? static_cast<double>(open) / static_cast<double>(table.size()) : 0;
}

// 36 pi V^2 / A^3: 1 for a ball, 0 for what is flat. [T-SHEET-1]
double isoperimetric_quotient(double a, double v) {
  return a > 0 ? 36 * std::numbers::pi * v * v / (a * a * a) : 0;
}

// The steps of prepare_input, in order.
class Preparation {
 public:
  Preparation(const TriangleSoup& welded, const CleanOptions& options, RepairReport& report)
      : welded_(welded), options_(options), report_(report) {
    soup_.points = welded.points;
    soup_.facets = welded.facets;
    source_.resize(welded.facets.size());
    for (std::uint32_t f = 0; f < source_.size(); ++f) source_[f] = f;
  }

  PreparedInput prepare(const FacetPairs& intersecting) {
    filter();
    join_open_edges();
    // Of a valid solid each part is one; of facets that do not join, each is a part.
    if (options_.smooth_auto && !report_.before.valid_solid() && open_share(soup_) < kWeldedSoup) drop_fragments();
    orient_facets();
    PreparedInput result;
    if (!options_.keeps_openings() && !options_.thicken && !report_.before.valid_solid()) leave_out_sheets();
    cap(result);
    find_overlaps(result, intersecting);
    settle_nesting(result);
    drop_components(result);
    find_overlaps(result, intersecting);
    find_absorbed(result);
    tell_components(result);
    tell_fates(result);
    result.oriented = std::move(soup_);
    result.source = std::move(source_);
    return result;
  }

 private:
  void filter() {
    FilteredFacets kept = filter_facets(soup_, true);
    report_.actions.degenerate_facets_dropped += kept.degenerate;
    report_.actions.duplicate_facets_dropped += kept.duplicate;
    report_.actions.wall_facets_dropped += kept.walls;
    for (std::uint32_t& f : kept.source) f = source_[f];
    source_ = std::move(kept.source);
    soup_ = std::move(kept.soup);
  }

  // [T-WELD-2]
  void join_open_edges() {
    double tolerance = report_.options.gap.value_or(0);
    if (tolerance <= 0) tolerance = default_weld_tolerance();
    if (tolerance <= 0) return;
    WeldedNear near = weld_boundaries(soup_, tolerance);
    if (near.points_moved == 0) return;
    report_.actions.points_welded_within_tolerance = near.points_moved;
    report_.actions.weld_tolerance = tolerance;
    soup_ = std::move(near.soup);
    filter();
  }

  double default_weld_tolerance() const {
    const double open = open_share(soup_);
    if (open <= kUnmatchedShare) return 0;
    const double share = kWeldShare * median_edge(soup_);
    return open > kWeldedSoup ? share : std::min(share, kWeldDiagonals * bounding_box(soup_).diagonal());
  }

  // Pieces that enclose nothing (fins, stray facets), if they are a small part: no solid has them. [T-SHEET-2]
  void leave_out_sheets() {
    const ManifoldPieces pieces = split_into_manifold_pieces(soup_);
    const CappedSoup closed = cap_boundary(pieces.soup);
    const Shells shells = find_shells(closed.soup);
    std::vector<double> own(shells.shells.size(), 0.0);
    for (std::size_t f = 0; f < soup_.facets.size(); ++f) own[shells.of_facet[f]] += 0.5 * norm(facet_normal_2a(soup_, f));
    std::vector<char> sheet(own.size());
    double sheet_area = 0;
    for (std::size_t s = 0; s < own.size(); ++s) {
      const Shell& shell = shells.shells[s];
      const double roundness = isoperimetric_quotient(shell.area, shell.volume), caps = shell.area - own[s];
      sheet[s] = roundness < kFlatRoundness || (roundness < kSheetRoundness && caps > kSheetCapShare * own[s]);
      if (sheet[s]) sheet_area += own[s];
    }
    if (sheet_area == 0 || sheet_area > kFewSheets * area(soup_)) return;
    std::vector<ComponentFate> fates;
    for (const Shell& shell : shells.shells) fates.push_back(fate_of(shell, "lost", "a sheet without thickness"));
    count_facets(shells, fates);
    for (std::size_t s = 0; s < own.size(); ++s)
      if (sheet[s]) dropped_.push_back(fates[s]);
    remove_facets_of(shells, sheet, FacetFate::sheet);
  }

  void orient_facets() { soup_ = orient(soup_).soup; }

  void cap(PreparedInput& result) const {
    result.capped = cap_boundary(soup_);
    result.shells = find_shells(result.capped.soup);
  }

  // --- nesting

  // Whether most of a shell's facets are turned against the file.
  std::vector<char> turned_shells(const PreparedInput& result) const {
    std::vector<double> balance(result.shells.shells.size(), 0.0);
    for (std::size_t f = 0; f < soup_.facets.size(); ++f)
      balance[result.shells.of_facet[f]] += norm(facet_normal_2a(soup_, f)) * (is_turned(f) ? 1 : -1);
    std::vector<char> turned(balance.size());
    std::transform(balance.begin(), balance.end(), turned.begin(), [](double b) { return b > 0; });
    return turned;
  }

  // Joining points and turning both keep the order of a facet's corners, up to one swap.
  bool is_turned(std::size_t f) const {
    const Vec3 now = facet_normal_2a(soup_, f), then = facet_normal_2a(welded_, source_[f]);
    return dot(now, then) < 0;
  }

  // Whether a shell crosses, perhaps through others, an outermost one around it: then it is a part of that body.
  bool crosses_its_root(const std::vector<Shell>& shells, std::uint32_t s) {
    return std::any_of(shells[s].around.begin(), shells[s].around.end(), [&](const auto& a) {
      return shells[a.first].around.empty() && bodies_.find(a.first) == bodies_.find(s);
    });
  }

  // Outermost shells face outwards; what crosses them is part of a union. What lies inside another keeps the orientation it has in the file relative to the
  // outermost shell around it, or gets the one that is asked for. [T-NEST-1]
  void settle_nesting(PreparedInput& result) {
    const std::vector<char> turned = turned_shells(result);
    const std::vector<Shell>& shells = result.shells.shells;
    std::vector<char> turn(shells.size(), 0);
    const auto outermost = [&](std::uint32_t s) { return shells[s].around.empty(); };
    for (std::uint32_t s = 0; s < shells.size(); ++s)
      if (shells[s].closed && outermost(s)) turn[s] = shells[s].volume < 0;
    for (std::uint32_t s = 0; s < shells.size(); ++s) {
      if (!shells[s].closed || outermost(s) || crosses_its_root(shells, s)) continue;
      bool outwards = shells[s].volume > 0;
      if (options_.nesting == Nesting::cavity) {
        outwards = shells[s].around.size() % 2 == 0;
      } else if (options_.nesting == Nesting::solid) {
        outwards = true;
      } else {
        const auto root = std::find_if(shells[s].around.begin(), shells[s].around.end(), [&](const auto& a) { return outermost(a.first); });
        const bool follow = root != shells[s].around.end() && (turned[root->first] != 0) != (turn[root->first] != 0);
        outwards = (shells[s].volume > 0) != ((turned[s] != 0) != follow);
      }
      turn[s] = (shells[s].volume > 0) != outwards;
    }
    if (std::find(turn.begin(), turn.end(), 1) == turn.end()) return;
    for (std::size_t f = 0; f < result.capped.soup.facets.size(); ++f) {
      if (!turn[result.shells.of_facet[f]]) continue;
      std::swap(result.capped.soup.facets[f][1], result.capped.soup.facets[f][2]);
      if (f < soup_.facets.size()) std::swap(soup_.facets[f][1], soup_.facets[f][2]);
    }
    result.shells = find_shells(result.capped.soup);
  }

  // --- components

  void drop_components(PreparedInput& result) {
    if (!options_.keep_largest && !options_.min_component) return;
    const std::vector<Shell>& shells = result.shells.shells;
    // Shells that cross are one body.
    std::vector<double> volume(shells.size(), 0.0);
    for (std::uint32_t s = 0; s < shells.size(); ++s) volume[bodies_.find(s)] += std::abs(shells[s].volume);
    const double largest = shells.empty() ? 0 : *std::max_element(volume.begin(), volume.end());
    double least = options_.min_component ? options_.min_component->value : 0;
    if (options_.min_component && options_.min_component->percent_of_largest) least *= 0.01 * largest;
    std::vector<char> drop(shells.size(), 0);
    std::vector<ComponentFate> fates;
    const auto kept = static_cast<std::uint32_t>(std::find(volume.begin(), volume.end(), largest) - volume.begin());
    const auto is_cavity = [&](const Shell& shell) { return shell.volume < 0 && shell.wrapped == 1; };
    for (std::uint32_t s = 0; s < shells.size(); ++s) {
      const bool small = volume[bodies_.find(s)] < least;
      drop[s] = !is_cavity(shells[s]) && (small || (options_.keep_largest && bodies_.find(s) != kept));
      fates.push_back(fate_of(shells[s], "dropped", small ? "smaller than --min-component" : "not the largest component"));
    }
    // A cavity goes with the body around it: the smallest of the shells that are.
    for (std::uint32_t s = 0; s < shells.size(); ++s) {
      if (!is_cavity(shells[s])) continue;
      const auto closest = std::min_element(shells[s].around.begin(), shells[s].around.end(), [&](const auto& a, const auto& b) {
        return std::abs(shells[a.first].volume) < std::abs(shells[b.first].volume);
      });
      drop[s] = drop[closest->first];
    }
    count_facets(result.shells, fates);
    for (std::size_t s = 0; s < shells.size(); ++s)
      if (drop[s]) dropped_.push_back(fates[s]);
    remove_facets_of(result.shells, drop, FacetFate::dropped);
    cap(result);
  }

  // Dirt of scanning, which whoever asks for the noise to go wants to go with it.
  void drop_fragments() {
    const std::vector<std::uint32_t> fragments = find_fragments(soup_);
    if (fragments.empty()) return;
    TriangleSoup dirt{soup_.points, {}, {}};
    std::vector<char> drop(soup_.facets.size(), 0);
    for (const std::uint32_t f : fragments) {
      drop[f] = 1;
      dirt.facets.push_back(soup_.facets[f]);
    }
    const Shells shells = find_shells(dirt);
    std::vector<ComponentFate> fates;
    for (const Shell& shell : shells.shells) fates.push_back(fate_of(shell, "dropped", "a stray fragment"));
    for (std::size_t f = 0; f < dirt.facets.size(); ++f) ++fates[shells.of_facet[f]].facets;
    dropped_.insert(dropped_.end(), fates.begin(), fates.end());
    report_.actions.fragments_dropped = shells.shells.size();
    remove_facets(drop, FacetFate::fragment);
  }

  void remove_facets_of(const Shells& shells, const std::vector<char>& drop, FacetFate fate) {
    if (std::find(drop.begin(), drop.end(), 1) == drop.end()) return;
    std::vector<char> drop_facet(soup_.facets.size());
    for (std::size_t f = 0; f < drop_facet.size(); ++f) drop_facet[f] = drop[shells.of_facet[f]];
    remove_facets(drop_facet, fate);
  }

  void remove_facets(const std::vector<char>& drop, FacetFate fate) {
    TriangleSoup kept;
    std::vector<std::uint32_t> source;
    for (std::size_t f = 0; f < soup_.facets.size(); ++f) {
      if (drop[f]) {
        removed_.emplace_back(source_[f], fate);
        continue;
      }
      kept.facets.push_back(soup_.facets[f]);
      source.push_back(source_[f]);
    }
    kept.points = std::move(soup_.points);
    soup_ = weld(std::move(kept));
    source_ = std::move(source);
  }

  void find_overlaps(PreparedInput& result, const FacetPairs& intersecting) {
    std::vector<std::uint32_t> shell_of_input(welded_.facets.size(), kNoShell);
    for (std::size_t f = 0; f < source_.size(); ++f) shell_of_input[source_[f]] = result.shells.of_facet[f];
    crossed_.assign(result.shells.shells.size(), 0);
    bodies_ = UnionFind(crossed_.size());
    result.bodies_overlap = false;
    for (const auto& [f, g] : intersecting) {
      const std::uint32_t s = shell_of_input[f], t = shell_of_input[g];
      if (s == t || s == kNoShell || t == kNoShell) continue;
      crossed_[s] = crossed_[t] = 1;
      bodies_.unite(s, t);
      result.bodies_overlap = true;
    }
  }

  // A shell is no part of the surface of {winding >= 1} when that holds, or fails, on both its sides.
  void find_absorbed(PreparedInput& result) const {
    for (std::size_t s = 0; s < result.shells.shells.size(); ++s) {
      const Shell& shell = result.shells.shells[s];
      const bool outside = shell.wrapped >= 1, inside = shell.wrapped + (shell.volume > 0 ? 1 : -1) >= 1;
      const bool alone = shell.closed && !crossed_[s] && !shell.around.empty();
      result.shell_fates.push_back(!alone || outside != inside ? FacetFate::used : inside ? FacetFate::absorbed : FacetFate::nothing);
    }
  }

  static ComponentFate fate_of(const Shell& shell, std::string fate, std::string reason) {
    return {shell.at, 0, shell.area, shell.volume, std::move(fate), std::move(reason)};
  }

  // Facets of the input in each shell, and their area: caps are none of its.
  void count_facets(const Shells& shells, std::vector<ComponentFate>& fates) const {
    for (ComponentFate& fate : fates) fate.area = 0;
    for (std::size_t f = 0; f < soup_.facets.size(); ++f) {
      ComponentFate& fate = fates[shells.of_facet[f]];
      ++fate.facets;
      fate.area += 0.5 * norm(facet_normal_2a(soup_, f));
    }
  }

  void tell_components(const PreparedInput& result) {
    std::vector<ComponentFate> fates;
    for (std::size_t s = 0; s < result.shells.shells.size(); ++s) {
      const Shell& shell = result.shells.shells[s];
      if (result.shell_fates[s] == FacetFate::absorbed)
        fates.push_back(fate_of(shell, "absorbed", "lies inside the solid"));
      else if (result.shell_fates[s] == FacetFate::nothing)
        fates.push_back(fate_of(shell, "lost", "encloses nothing"));
      else if (crossed_[s])
        fates.push_back(fate_of(shell, "merged", "overlaps other components"));
      else if (shell.closed && shell.wrapped > 0 && shell.volume < 0)
        fates.push_back(fate_of(shell, "cavity", "oriented as the wall of a cavity"));
      else
        fates.push_back(fate_of(shell, "kept", ""));
    }
    count_facets(result.shells, fates);
    report_.components = std::move(fates);
    report_.components.insert(report_.components.end(), dropped_.begin(), dropped_.end());
    std::stable_sort(report_.components.begin(), report_.components.end(),
                     [](const ComponentFate& a, const ComponentFate& b) { return a.area > b.area; });
  }

  void tell_fates(PreparedInput& result) const {
    result.fates.assign(welded_.facets.size(), FacetFate::useless);
    for (std::size_t f = 0; f < source_.size(); ++f)
      result.fates[source_[f]] = result.shell_fates[result.shells.of_facet[f]];
    for (const auto& [f, fate] : removed_) result.fates[f] = fate;
  }

  static constexpr std::uint32_t kNoShell = 0xffffffffu;

  const TriangleSoup& welded_;
  const CleanOptions& options_;
  RepairReport& report_;
  TriangleSoup soup_;
  std::vector<std::uint32_t> source_;
  std::vector<char> crossed_;  // shells with facets that intersect another's
  UnionFind bodies_{0};        // shells, joined where they cross
  std::vector<ComponentFate> dropped_;
  std::vector<std::pair<std::uint32_t, FacetFate>> removed_;  // facets of the input, with their components
};

// Facets that contradict their neighbours, unless it is all of them that face inwards.
void warn_of_flips(const TriangleSoup& welded, RepairReport& report) {
  const double turned = static_cast<double>(report.actions.facets_flipped), all = static_cast<double>(welded.facets.size());
  if (report.before.misoriented_edges == 0 || std::min(turned, all - turned) < kManyFlipped * all) return;
  report.warnings.push_back(fmt::format("{} of {} facets were turned over: their orientation contradicts their neighbours', so that which side is "
                                        "inside was found from what can be seen from outside",
                                        report.actions.facets_flipped, welded.facets.size()));
}

}  // namespace

std::string_view reason(FacetFate fate) {
  switch (fate) {
    case FacetFate::useless: return "a copy, or without an area";
    case FacetFate::absorbed: return "inside the solid";
    case FacetFate::nothing: return "encloses nothing";
    case FacetFate::sheet: return "a sheet without thickness";
    case FacetFate::dropped: return "a component that was not wanted";
    case FacetFate::fragment: return "a stray fragment";
    case FacetFate::used: break;
  }
  return {};
}

PreparedInput prepare_input(const TriangleSoup& welded, const FacetPairs& intersecting, const CleanOptions& options,
                            RepairReport& report) {
  PreparedInput result = Preparation(welded, options, report).prepare(intersecting);
  RepairActions& actions = report.actions;
  actions.open_loops_capped = result.capped.caps.size();
  actions.cap_area = result.capped.cap_area;
  for (std::size_t f = 0; f < result.source.size(); ++f)
    actions.facets_flipped += dot(facet_normal_2a(result.oriented, f), facet_normal_2a(welded, result.source[f])) < 0;
  tell_holes(result, report);
  warn_of_flips(welded, report);
  return result;
}

void tell_holes(const PreparedInput& prepared, RepairReport& report) {
  report.holes.clear();
  for (const Cap& cap : prepared.capped.caps) {
    report.holes.push_back(cap.hole);
    report.holes.back().filled = !report.options.max_hole || cap.hole.width() <= *report.options.max_hole;
  }
  std::stable_sort(report.holes.begin(), report.holes.end(), [](const Hole& a, const Hole& b) { return a.perimeter > b.perimeter; });
}

std::optional<Error> reason_for_no_solid(const TriangleSoup& welded, const PreparedInput& prepared, const Defects& before) {
  const double input_area = area(welded);
  if (prepared.oriented.facets.empty() && std::find(prepared.fates.begin(), prepared.fates.end(), FacetFate::dropped) != prepared.fates.end())
    return Error(ErrorCode::guarantee_unmet, "nothing is left: every component is smaller than --min-component", "choose a smaller --min-component");
  if (prepared.oriented.facets.empty() || input_area <= 0)
    return Error(ErrorCode::guarantee_unmet, fmt::format("no solid: none of the {} facets has an area", welded.facets.size()),
                 "re-export the model; every facet in this file is a line or a point");
  const double roundness = isoperimetric_quotient(area(prepared.capped.soup), signed_volume(prepared.capped.soup));
  if (prepared.capped.cap_area > kSheetCapShare * input_area && roundness < kSheetRoundness)
    return Error(ErrorCode::guarantee_unmet,
                 fmt::format("no solid: an open sheet; its {} open edges in {} loops would need caps of {:.0f} % of the input's area",
                             before.open_edges, before.open_loops, 100 * prepared.capped.cap_area / input_area),
                 "--keep-openings of 'burnish IN -o OUT' cleans it as the open sheet it is; its --thicken T makes it a shell of thickness T");
  if (roundness < kFlatRoundness)
    return Error(ErrorCode::guarantee_unmet,
                 fmt::format("no solid: the surface encloses a volume of {:.3g} with an area of {:.3g}: it is flat, or its parts cancel",
                             std::abs(signed_volume(prepared.capped.soup)), input_area),
                 "--thicken T of 'burnish IN -o OUT' makes it a shell of thickness T; or check that the facets' orientation is consistent");
  return std::nullopt;
}

}  // namespace burnish
