#include "clean_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "burnish/surface/remesh.h"
#include "burnish/surface/simplify.h"
#include "burnish/surface/weld.h"
#include "losses.h"
#include "read_input.h"
#include "resolve_options.h"

namespace burnish {
namespace {

constexpr double kLocalTolerance = 1e-3;    // of the diagonal: what the local gear may be off the input
constexpr double kMostHeld = 0.02;          // of the facets may be left as they are without a word
constexpr double kLossCells = 1.5;          // parts of the input farther than this from the result are lost

void tell_creases(const ReferenceSurface& reference, double cell, SurfaceSummary& told) {
  const Creases& creases = reference.creases();
  told.creases = creases.chains.size();
  told.corners = creases.corners.size();
  told.crease_length = 0;
  for (const CreaseEdge& e : creases.edges) told.crease_length += cell * norm(reference.soup().points[e.points[1]] - reference.soup().points[e.points[0]]);
}

// Whether a facet reaches into the region that was smoothed.
bool may_have_moved(const TriangleSoup& soup, const Facet& f, const Region& region) {
  const Vec3 &a = soup.points[f[0]], &b = soup.points[f[1]], &c = soup.points[f[2]], middle = (a + b + c) / 3.0;
  return region.uniform_mobility(middle, std::max({norm(a - middle), norm(b - middle), norm(c - middle)}), 0) != 0.0;
}

// Those of the first facets that bound the solid, welded.
TriangleSoup surface_of(const TriangleSoup& all, const std::vector<FacetRole>& roles, std::size_t facets) {
  TriangleSoup surface{all.points, {}, {}};
  for (std::size_t f = 0; f < facets; ++f)
    if (roles[f] == FacetRole::boundary) surface.facets.push_back(all.facets[f]);
  return weld(std::move(surface));
}

}  // namespace

CleanRun::CleanRun(const CleanRun& base, const CleanJob& job, std::unique_ptr<CleanedOutput> output) : SolidRun(base), job_(job), region_(base.region_), noise_(base.noise_), volume_(base.volume_), shared_(base.shared_) {
  const bool cell_was_chosen = report_.options.cell_was_chosen;
  report_.options = resolve_lengths(job.options, report_.before.box.diagonal());
  report_.options.cell_was_chosen = cell_was_chosen;
  take_output(std::move(output));
}

void CleanRun::take_output(std::unique_ptr<CleanedOutput> output) {
  output_ = std::move(output);
  if (report_.unit) output_->set_unit(*report_.unit);
  report_.output = job_.output;
  report_.output_format = output_->format_name();
}

bool CleanRun::open(std::unique_ptr<CleanedOutput> output) {
  read();
  return begin_with(output ? std::move(output) : std::make_unique<CleanedOutput>(job_.output, job_.overwrite));
}

bool CleanRun::open(TriangleSoup input, std::unique_ptr<CleanedOutput> output) {
  take(std::move(input), job_.options);
  return begin_with(std::move(output));
}

bool CleanRun::begin_with(std::unique_ptr<CleanedOutput> output) {
  take_output(std::move(output));
  if (!job_.options.region.empty()) region_ = std::make_shared<const Region>(job_.options.region, report_.recentred_by);
  return prepare(job_.options);
}

void CleanRun::read() {
  if (!is_volume(job_.input, job_.options.volume)) return SolidRun::read(job_.salvage, job_.options);
  begin("reading");
  volume_ = std::make_shared<const VolumeInput>(job_.input, job_.options.volume, job_.options.share_of_memory(), report_, progress_);
  if (volume_->is_binary() && !(job_.options.smooth.value > 0))
    report_.warnings.push_back("the volume has two values only, so its surface is a staircase: --smooth 4h takes the steps off");
  begin("finding the surface");
  input_ = placed_input(volume_->surface(report_, progress_), job_.input, job_.options, report_);
}

void CleanRun::run() {
  plan();
  if (!repair_locally()) {
    rebuild();
  } else if (report_.verified && !report_.failure && options_.simplifies()) {
    resize_facets();
    measure_deviation(TriangleIndex(result_), {});
    if (!report_.failure && !before_denoising_.facets.empty()) hold_deviation(before_denoising_, kLocalTolerance * report_.options.deviation.value_or(0));
    tell_replaced();
  }
  if (report_.method == name(Method::local) && job_.options.crease_angle && !plan_.smooths() && !options_.simplifies())
    report_.warnings.push_back("--crease has no effect: the facets stay as they are");
  validate_result();
  publish();
}

void CleanRun::share_level_set(const std::vector<Length>& strengths) {
  plan();
  if (!plan_.flows()) return;
  begin("distances and signs");
  const double diagonal = report_.before.box.diagonal();
  const auto shorter = [&](const Length& a, const Length& b) { return a.in_model_units(diagonal, 1) < b.in_model_units(diagonal, 1); };
  const auto [least, most] = std::minmax_element(strengths.begin(), strengths.end(), shorter);
  options_.smooth = *most;
  if (report_.options.max_hole) close_sheet(prepared_, options_, report_);
  if (takes_volume()) {
    resolve_with(volume_->cell());
  } else {
    options_.smooth = *least;
    resolve_cell(options_, prepared_.capped, report_.options, report_.warnings);
    fit_cell_for(*most);
  }
  shared_ = std::make_shared<const BuiltLevelSet>(built_level_set());
}

void CleanRun::fit_cell_for(const Length& longest) {
  options_.smooth = longest;
  for (double cell = report_.options.cell;; cell *= 1.05) {
    try {
      return resolve_with(cell);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::memory_limit || !report_.options.cell_was_chosen) throw;
    }
  }
}

void CleanRun::resolve_with(double cell) {
  ResolvedOptions resolved = report_.options;
  options_.cell = Length{cell, LengthUnit::model};
  options_.resolution.reset();
  resolve_cell(options_, prepared_.capped, resolved, report_.warnings);
  resolved.cell_was_chosen = report_.options.cell_was_chosen;
  report_.options = resolved;
}

void CleanRun::plan() {
  if (job_.options.smooths()) {
    begin("estimating noise");
    if (!noise_) noise_ = estimate_noise(prepared_.oriented);
    plan_ = plan_smoothing(job_.options, *noise_, region_, prepared_, report_);
  }
  options_ = with_plan(job_.options, plan_);
}

// --- the local gear

double CleanRun::local_tolerance() const {
  // Joining both sides of a gap moves them as far as was asked for.
  return std::max(kLocalTolerance * report_.before.box.diagonal(), report_.options.gap.value_or(0));
}

bool CleanRun::repair_locally() {
  std::string why_not = reason_against_local(job_.options, plan_.flows());
  if (why_not.empty() && (plan_.denoises() ? try_denoised(why_not) : try_local(why_not))) return true;
  report_.method = name(Method::level_set);
  report_.method_reason = why_not;
  forget_attempt();
  if (job_.options.method != Method::local) return false;
  report_.method = name(Method::local);
  report_.failure = Error(ErrorCode::guarantee_unmet, "local repair cannot do it: " + why_not, "leave --method out, or say --method levelset");
  return true;
}

bool CleanRun::is_fine_as_it_is() const {
  return report_.before.valid_solid() && prepared_.source.size() == input_.facets.size() && report_.actions.facets_flipped == 0;
}

bool CleanRun::try_local(std::string& why_not) {
  begin("repairing locally");
  const bool fine = is_fine_as_it_is();
  std::optional<LocalSolution> solution = fine ? unchanged(input_) : solve_locally(input_, prepared_, {.max_hole = {}, .float32 = output_->stores_float32()}, report_, progress_, why_not);
  if (!solution || !verify_local(*solution, why_not)) return false;
  begin("measuring");
  why_not = objection_to(*solution, result_, input_, prepared_, local_tolerance(), report_);
  if (!why_not.empty()) return false;
  warn_of_losses({});
  sources_ = std::move(solution->source);
  report_.method = name(Method::local);
  report_.method_reason = fine ? "the input is valid as it is" : report_.losses.empty() ? "what is broken could be mended where it is, and nothing is lost"
                                                                                      : "what is broken could be mended where it is";
  return true;
}

bool CleanRun::try_denoised(std::string& why_not) {
  begin("smoothing");
  std::optional<DenoisedSolution> solution =
      solve_denoised(input_, prepared_, plan_, is_fine_as_it_is(), output_->stores_float32(), local_tolerance(), report_, progress_, why_not);
  if (!solution || !verify_local(solution->solution, why_not)) return false;
  begin("measuring");
  why_not = objection_to_mending(*solution, result_, local_tolerance() + report_.smoothing.max_moved, report_);
  if (!why_not.empty()) return false;
  measure_deviation(TriangleIndex(result_), {});
  if (options_.simplifies()) before_denoising_ = solution->surface.before;
  hold_deviation(solution->surface.before, kLocalTolerance * report_.options.deviation.value_or(0));
  warn_of_losses({});
  sources_ = std::move(solution->solution.source);
  report_.method = name(Method::local);
  report_.method_reason = "facets could be denoised where they are";
  return true;
}

bool CleanRun::verify_local(const LocalSolution& solution, std::string& why_not) {
  begin("verifying");
  inspect_result(output_->write_and_read_back(solution.soup));
  result_ = output_->take_result();
  if (!report_.verified) why_not = "its result is not valid once it is written";
  return report_.verified;
}

void CleanRun::hold_deviation(const TriangleSoup& repaired, double slack) {
  if (!report_.options.deviation || !plan_.smooths()) return;
  report_.smoothing.deviation = std::max(one_sided_distance(result_, TriangleIndex(repaired), {}, nullptr, progress_).max, one_sided_distance(repaired, TriangleIndex(result_), {}, nullptr, progress_).max);
  const double bound = *report_.options.deviation;
  if (report_.smoothing.deviation <= bound + slack) return;
  report_.verified = false;
  report_.failure = Error(ErrorCode::guarantee_unmet,
                          fmt::format("the result is {:.4g} from the repaired surface, and --deviation allows {:.4g}", report_.smoothing.deviation, bound),
                          "allow more, smooth less, or choose a smaller --cell; --allow-invalid writes the result as it is");
}

void CleanRun::inspect_result(const TriangleSoup& result) {
  const bool same = result.points == input_.points && result.facets == input_.facets;
  report_.after = same ? report_.before : inspect(result, {}, progress_).defects;
  judge_result();
}

void CleanRun::judge_result() {
  report_.is_sheet = job_.options.keeps_openings() && report_.after.open_edges > 0;
  report_.verified = report_.is_sheet ? report_.after.valid_sheet() : report_.after.valid_solid();
}

void CleanRun::forget_attempt() {
  RepairActions& a = report_.actions;
  a.facets_cut = a.needles_flipped = a.points_split = a.intersecting_pairs_removed = a.facets_kept = a.facets_moved = a.facets_removed = a.facets_added = 0;
  a.largest_split = 0;
  report_.surface = {};
  report_.changes.clear();
  report_.losses.clear();
  report_.deviation = {};
  report_.after = {};
  report_.verified = report_.is_sheet = false;
  tell_holes(prepared_, report_);
}

// --- the level set gear

void CleanRun::rebuild() {
  begin("distances and signs");
  if (options_.deviation) points_before_ = prepared_.capped.soup.points;
  if (plan_.denoises() || plan_.clamps_outliers) denoise_prepared(prepared_, plan_, report_, progress_);
  if (shared_ || takes_volume()) {
    resolve_with(shared_ ? shared_->level_set.frame.cell : volume_->cell());
  } else {
    if (report_.options.max_hole) close_sheet(prepared_, options_, report_);
    resolve_cell(options_, prepared_.capped, report_.options, report_.warnings);
  }
  const std::size_t warnings = report_.warnings.size();
  build_and_extract();
  if (!report_.failure || !report_.options.adapt || output_->float_steps_too_coarse()) return;
  // What is wrong at cells of two levels cannot be mended; finest cells everywhere can.
  report_.warnings.resize(warnings);
  report_.warnings.push_back("with coarser cells the result was no valid surface: --adapt was left out");
  report_.failure.reset();
  report_.options.adapt.reset();
  begin("distances and signs");
  build_and_extract();
}

bool CleanRun::takes_volume() const {
  const CleanOptions& o = job_.options;
  if (!volume_ || o.cell || o.resolution || o.adapt || o.thicken || o.keeps_openings() || plan_.denoises() || plan_.clamps_outliers) return false;
  return prepared_.source.size() == input_.facets.size() && std::all_of(prepared_.fates.begin(), prepared_.fates.end(), [](FacetFate fate) { return fate == FacetFate::used; });
}

BuiltLevelSet CleanRun::built_level_set() {
  return takes_volume() ? build_level_set(*volume_, prepared_, report_, progress_) : build_level_set(prepared_, report_, progress_);
}

void CleanRun::build_and_extract() {
  BuiltLevelSet built = shared_ ? *shared_ : built_level_set();
  if (plan_.flows()) {
    begin("smoothing");
    smooth_level_set(built.level_set, plan_, report_, progress_);
  }
  if (report_.options.moves_walls()) {
    begin("moving walls");
    move_walls(built.level_set, report_.options, progress_);
  }
  if (report_.options.adapt && (plan_.flows() || report_.options.thicken || report_.options.moves_walls())) {
    begin("coarsening");
    coarsen_level_set(built.level_set, report_, progress_);
  }
  extract(built);
  if (report_.verified) resize_facets();
  measure(built.roles);
}

std::shared_ptr<const SharpReference> CleanRun::reference_for(const BuiltLevelSet& built) {
  // A volume has values where a surface has creases.
  if (takes_volume() || (plan_.flows() && !plan_.region) || report_.options.thicken || report_.options.moves_walls()) return nullptr;
  const GridFrame& frame = built.level_set.frame;
  TriangleSoup surface = surface_of(prepared_.capped.soup, built.roles, built.roles.size());
  if (plan_.flows()) std::erase_if(surface.facets, [&](const Facet& f) { return may_have_moved(surface, f, *plan_.region); });
  surface = to_lattice(surface, frame);
  if (surface.facets.empty()) return nullptr;
  // What has been denoised is not noisy any more.
  if (!noise_ && !plan_.denoises()) noise_ = estimate_noise(prepared_.oriented);
  const double sigma = !plan_.denoises() && noise_->noisy() ? noise_->sigma / frame.cell : 0;
  auto reference = make_reference(std::move(surface), options_.crease_angle, sigma);
  tell_creases(reference->surface, frame.cell, report_.surface);
  report_.surface.crease_angle = crease_angle();
  return reference;
}

void CleanRun::extract(const BuiltLevelSet& built) {
  begin("extracting and verifying");
  CleanedOutput::Finish finish;
  if (report_.options.max_hole && !job_.options.thicken)
    finish = [&](const TriangleSoup& surface) { return without_kept_caps(surface, prepared_, report_.options); };
  SurfaceMaker maker(built.level_set, prepared_, reference_for(built), output_->stores_float32(), report_, progress_);
  report_.after = output_->write_verified(maker, built.level_set.frame, finish, progress_).defects;
  if (!finish) {
    report_.surface.topology.wanted_components = maker.wanted_topology().components;
    report_.surface.topology.wanted_genus = maker.wanted_topology().genus;
  }
  if (report_.actions.debris_dropped > 0)
    report_.warnings.push_back(fmt::format("{} small pieces that stand for no component of the input were left out", report_.actions.debris_dropped));
  judge_result();
  if (!report_.verified || output_->float_steps_too_coarse()) {
    report_.verified = false;
    report_.failure = output_->reason_for_failure(report_.after, report_.options);
  }
  result_ = output_->take_result();
  if (!report_.failure) compare_topology();
}

std::vector<FarSample> CleanRun::measure_deviation(const TriangleIndex& result_index, const CompareOptions& options) {
  report_.deviation.output_to_input = one_sided_distance(result_, TriangleIndex(input_), {}, nullptr, progress_);
  progress_.check();
  std::vector<FarSample> far;
  report_.deviation.input_to_output = one_sided_distance(input_, result_index, options, &far, progress_);
  return far;
}

TriangleSoup CleanRun::surface_before_smoothing(const std::vector<FacetRole>& roles) const {
  TriangleSoup all{prepared_.capped.soup.points, prepared_.capped.soup.facets, {}};
  std::copy(points_before_.begin(), points_before_.begin() + static_cast<std::ptrdiff_t>(std::min(points_before_.size(), all.points.size())), all.points.begin());
  const bool trimmed = report_.options.max_hole.has_value();
  return surface_of(all, roles, trimmed ? prepared_.oriented.facets.size() : roles.size());
}

void CleanRun::measure(const std::vector<FacetRole>& roles) {
  if (result_.facets.empty()) return;
  begin("measuring");
  const ResolvedOptions& o = report_.options;
  const TriangleIndex result_index(result_);
  const double limit = kLossCells * o.cell + 0.5 * o.smooth + 0.5 * o.thicken.value_or(0) + 2 * o.adapt.value_or(0) + report_.smoothing.max_moved + std::abs(o.offset.value_or(0)) +
                       report_.surface.simplify_deviation + 0.5 * o.edge.value_or(0) + o.edge_tolerance.value_or(0);
  tell_losses(measure_deviation(result_index, {.far_beyond = limit}), roles, result_index, limit);
  if (o.deviation && !o.moves_walls() && !report_.failure) hold_deviation(surface_before_smoothing(roles), o.cell);
}

void CleanRun::tell_losses(const std::vector<FarSample>& far, const std::vector<FacetRole>& roles, const TriangleIndex& result_index, double limit) {
  std::vector<std::uint32_t> prepared_facet(input_.facets.size(), kNoFacet);
  for (std::uint32_t f = 0; f < prepared_.source.size(); ++f) prepared_facet[prepared_.source[f]] = f;
  const auto role = [&](std::uint32_t f) { return prepared_facet[f] == kNoFacet ? FacetRole::boundary : roles[prepared_facet[f]]; };
  report_.losses = gather_losses(far, report_.before.box.diagonal(), [&](const FarSample& sample) -> std::string {
    const FacetFate fate = prepared_.fates[sample.facet];
    const bool inside = role(sample.facet) == FacetRole::interior || result_index.winding_number(sample.at) > 0.5;
    if (!report_.is_sheet && inside) return std::string(reason(FacetFate::absorbed));
    if (fate != FacetFate::used) return std::string(reason(fate));
    if (role(sample.facet) == FacetRole::unresolved) return "thinner than a cell";
    return plan_.smooths() ? "smoothed away" : "not resolved";
  });
  // What was dropped, or lies inside, is missing on purpose.
  TriangleSoup wanted{input_.points, {}, {}};
  for (std::uint32_t f = 0; f < input_.facets.size(); ++f)
    if (prepared_.fates[f] == FacetFate::sheet || (prepared_.fates[f] == FacetFate::used && role(f) != FacetRole::interior))
      wanted.facets.push_back(input_.facets[f]);
  const MissingComponents missing = missing_components(wanted, result_index, limit);
  report_.actions.components_lost = missing.count;
  for (ComponentFate& c : report_.components) {
    if (missing.count == 0 || c.fate != "kept" || result_index.closest(c.position, limit * limit).facet != kNoFacet) continue;
    c.fate = "lost";
    c.reason = plan_.smooths() ? "thinner than a cell, or smoothed away" : "thinner than a cell";
  }
  warn_of_losses(missing);
}

void CleanRun::warn_of_losses(const MissingComponents& missing) {
  report_.actions.area_lost = 0;
  for (const Loss& loss : report_.losses) report_.actions.area_lost += loss.reason == reason(FacetFate::absorbed) ? 0 : loss.area;
  if (missing.count > 0)
    report_.warnings.push_back(fmt::format(
        "{} of the input's components ({:.3g} of area) are not in the result, being thinner than a cell or smaller than the smoothing "
        "length; the largest is at ({:.6g}, {:.6g}, {:.6g})",
        missing.count, missing.area, missing.largest_at.x, missing.largest_at.y, missing.largest_at.z));
  const auto worst = std::find_if(report_.losses.begin(), report_.losses.end(), [](const Loss& l) { return l.reason != reason(FacetFate::absorbed) && l.area > 0; });
  if (worst != report_.losses.end())
    report_.warnings.push_back(fmt::format("parts of the input with {:.3g} of area are not in the result; the largest is at ({:.6g}, {:.6g}, {:.6g}): {}",
                                           report_.actions.area_lost, worst->position.x, worst->position.y, worst->position.z, worst->reason));
}

bool CleanRun::remeshes() const { return report_.options.edge && report_.surface.extractor == Extractor::tetrahedra; }

void CleanRun::resize_facets() {
  if (!remeshes() && !options_.simplifies()) return;
  TriangleSoup surface = std::move(result_);
  if (remeshes()) {
    begin("remeshing");
    RemeshedSurface remeshed = remesh(surface, {.edge = *report_.options.edge, .crease_angle = crease_angle()}, progress_);
    if (!remeshed.why_not.empty()) report_.warnings.push_back("the surface was not remeshed: " + remeshed.why_not);
    if (static_cast<double>(remeshed.held_facets) > kMostHeld * static_cast<double>(surface.facets.size()))
      report_.warnings.push_back(fmt::format("{} of {} facets were not remeshed: they would have met others", remeshed.held_facets, surface.facets.size()));
    surface = std::move(remeshed.soup);
  }
  if (options_.simplifies()) {
    begin("simplifying");
    report_.surface.facets_before = surface.facets.size();
    SimplifiedSurface simplified = simplify(surface, {.facets = report_.options.facets, .deviation = report_.options.simplify, .crease_angle = crease_angle()}, progress_);
    report_.surface.simplify_deviation = std::max(simplified.deviation.input_to_output.max, simplified.deviation.output_to_input.max);
    if (!simplified.why_not.empty())
      report_.warnings.push_back(fmt::format("simplified to {} facets: {}", simplified.soup.facets.size(), simplified.why_not));
    if (simplified.crease_angle > crease_angle())
      report_.warnings.push_back(fmt::format("for so few facets, creases below {:.0f} degrees were given up", simplified.crease_angle));
    report_.surface.crease_angle = simplified.crease_angle;
    surface = std::move(simplified.soup);
  }
  begin("verifying");
  sources_.clear();
  inspect_result(output_->write_and_read_back(surface));
  result_ = output_->take_result();
  if (!report_.verified)
    report_.failure = Error(ErrorCode::guarantee_unmet, "with other facets the surface is no valid solid once it is written",
                            "leave more of them, or write .ply (double precision); --allow-invalid writes the result as it is");
}

void CleanRun::tell_replaced() {
  RepairActions& a = report_.actions;
  a.facets_kept = a.facets_moved = 0;
  a.facets_removed = input_.facets.size();
  a.facets_added = result_.facets.size();
  report_.changes.clear();
}

void CleanRun::validate_result() {
  if (result_.facets.empty()) return;
  begin("validating");
  report_.surface.shapes = facet_shapes(result_);
  progress_.check();
  if (!report_.failure) compare_topology();
}

void CleanRun::compare_topology() {
  const SurfaceTopology topology = surface_topology(result_);
  TopologySummary& told = report_.surface.topology;
  told.components = topology.components.size();
  told.cavities = topology.cavities;
  told.genus = topology.genus;
  if (told.agrees()) return;
  report_.verified = false;
  report_.failure = Error(ErrorCode::guarantee_unmet,
                          fmt::format("the result has {} components and genus {}; the level set has {} and {}", told.components, told.genus.value_or(-1),
                                      *told.wanted_components, *told.wanted_genus),
                          "try --surface tetrahedra, another --cell, or .ply (double precision); --allow-invalid writes the result as it is");
}

}  // namespace burnish
