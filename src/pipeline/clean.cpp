#include "burnish/pipeline/clean.h"

#include <fmt/format.h>

#include <algorithm>

#include "burnish/surface/transfer.h"
#include "burnish/surface/triangle_index.h"
#include "cleaned_output.h"
#include "level_set_gear.h"
#include "local_gear.h"
#include "losses.h"
#include "prepare_input.h"
#include "resolve_options.h"
#include "solid_run.h"

namespace burnish {
namespace {

constexpr double kLocalTolerance = 1e-3;    // of the diagonal: what the local gear may be off the input
constexpr double kLossCells = 1.5;          // parts of the input farther than this from the result are lost

// One run: the stages write into the report as they go.
class Run : SolidRun {
 public:
  Run(const CleanJob& job, Progress& progress) : SolidRun(job.input, progress), job_(job) {}

  RepairReport clean() {
    read(job_.salvage, job_.options);
    CleanedOutput output(job_.output, job_.overwrite);
    report_.output = job_.output;
    report_.output_format = name(output.format());
    if (prepare(job_.options)) {
      if (!repair_locally(output)) rebuild(output);
      publish(output);
    }
    clock_.end();
    report_.stages = clock_.stages();
    return std::move(report_);
  }

 private:
  // --- the local gear

  bool repair_locally(CleanedOutput& output) {
    std::string why_not = reason_against_local(job_.options);
    if (why_not.empty() && try_local(output, why_not)) return true;
    report_.method = name(Method::level_set);
    report_.method_reason = why_not;
    forget_attempt();
    if (job_.options.method != Method::local) return false;
    report_.method = name(Method::local);
    report_.failure = Error(ErrorCode::guarantee_unmet, "local repair cannot do it: " + why_not, "leave --method out, or say --method levelset");
    return true;
  }

  bool is_fine_as_it_is() const {
    return report_.before.valid_solid() && prepared_.source.size() == input_.facets.size() && report_.actions.facets_flipped == 0;
  }

  bool try_local(CleanedOutput& output, std::string& why_not) {
    begin("repairing locally");
    const bool fine = is_fine_as_it_is();
    std::optional<LocalSolution> solution = fine ? unchanged(input_) : solve_locally(input_, prepared_, stores_float32(output.format()), report_, progress_, why_not);
    if (!solution) return false;
    begin("verifying");
    inspect_result(output.write_and_read_back(solution->soup));
    result_ = output.take_result();
    if (!report_.verified) {
      why_not = "its result is not valid once it is written";
      return false;
    }
    begin("measuring");
    // Joining both sides of a gap moves them as far as was asked for.
    const double tolerance = std::max(kLocalTolerance * report_.before.box.diagonal(), report_.options.gap.value_or(0));
    why_not = objection_to(*solution, result_, input_, prepared_, tolerance, report_);
    if (!why_not.empty()) return false;
    warn_of_losses({});
    sources_ = std::move(solution->source);
    report_.method = name(Method::local);
    report_.method_reason = fine ? "the input is valid as it is" : report_.losses.empty() ? "what is broken could be mended where it is, and nothing is lost"
                                                                                        : "what is broken could be mended where it is";
    return true;
  }

  void inspect_result(const TriangleSoup& result) {
    const bool same = result.points == input_.points && result.facets == input_.facets;
    report_.after = same ? report_.before : inspect(result, {}, progress_).defects;
    judge_result();
  }

  void judge_result() {
    report_.is_sheet = job_.options.keeps_openings() && report_.after.open_edges > 0;
    report_.verified = report_.is_sheet ? report_.after.valid_sheet() : report_.after.valid_solid();
  }

  // What a local repair that was not taken has left in the report.
  void forget_attempt() {
    RepairActions& a = report_.actions;
    a.facets_cut = a.needles_flipped = a.points_split = a.intersecting_pairs_removed = a.facets_kept = a.facets_removed = a.facets_added = 0;
    a.largest_split = 0;
    report_.changes.clear();
    report_.losses.clear();
    report_.deviation = {};
    report_.after = {};
    report_.verified = report_.is_sheet = false;
    tell_holes(prepared_, report_);
  }

  // --- the level set gear

  void rebuild(CleanedOutput& output) {
    begin("distances and signs");
    if (report_.options.max_hole) close_sheet(prepared_, job_.options, report_);
    resolve_cell(job_.options, prepared_.capped, report_.options, report_.warnings);
    const std::size_t warnings = report_.warnings.size();
    build_and_extract(output);
    if (!report_.failure || !report_.options.adapt || output.float_steps_too_coarse()) return;
    // What is wrong at cells of two levels cannot be mended; finest cells everywhere can.
    report_.warnings.resize(warnings);
    report_.warnings.push_back("with coarser cells the result was no valid surface: --adapt was left out");
    report_.failure.reset();
    report_.options.adapt.reset();
    begin("distances and signs");
    build_and_extract(output);
  }

  void build_and_extract(CleanedOutput& output) {
    BuiltLevelSet built = build_level_set(prepared_, report_, progress_);
    if (report_.options.smooth > 0) {
      begin("smoothing");
      smooth_level_set(built.level_set, report_, progress_);
    }
    if (report_.options.adapt && (report_.options.smooth > 0 || report_.options.thicken)) {
      begin("coarsening");
      coarsen_level_set(built.level_set, report_, progress_);
    }
    extract(output, built.level_set);
    measure(built.roles);
  }

  void extract(CleanedOutput& output, const LevelSet& level_set) {
    begin("extracting and verifying");
    CleanedOutput::Finish finish;
    if (report_.options.max_hole && !job_.options.thicken)
      finish = [&](TriangleSoup surface) { return without_kept_caps(surface, prepared_, report_.options); };
    const auto sift = [&](TriangleSoup& surface) {
      report_.actions.debris_dropped = leave_out_debris(surface, prepared_, level_set.frame);
    };
    report_.after = output.write_verified(level_set, sift, finish, progress_).defects;
    if (report_.actions.debris_dropped > 0)
      report_.warnings.push_back(fmt::format("{} small pieces that stand for no component of the input were left out", report_.actions.debris_dropped));
    judge_result();
    if (!report_.verified || output.float_steps_too_coarse()) {
      report_.verified = false;
      report_.failure = output.reason_for_failure(report_.after, report_.options);
    }
    result_ = output.take_result();
  }

  void measure(const std::vector<FacetRole>& roles) {
    if (result_.facets.empty()) return;
    begin("measuring");
    report_.deviation.output_to_input = one_sided_distance(result_, TriangleIndex(input_));
    progress_.check();
    const TriangleIndex result_index(result_);
    const double limit = kLossCells * report_.options.cell + 0.5 * report_.options.smooth + 0.5 * report_.options.thicken.value_or(0) + 2 * report_.options.adapt.value_or(0);
    std::vector<FarSample> far;
    report_.deviation.input_to_output = one_sided_distance(input_, result_index, {.far_beyond = limit}, &far);
    tell_losses(far, roles, result_index, limit);
  }

  // Nothing is lost silently.
  void tell_losses(const std::vector<FarSample>& far, const std::vector<FacetRole>& roles, const TriangleIndex& result_index, double limit) {
    std::vector<std::uint32_t> prepared_facet(input_.facets.size(), kNoFacet);
    for (std::uint32_t f = 0; f < prepared_.source.size(); ++f) prepared_facet[prepared_.source[f]] = f;
    const auto role = [&](std::uint32_t f) { return prepared_facet[f] == kNoFacet ? FacetRole::boundary : roles[prepared_facet[f]]; };
    report_.losses = gather_losses(far, report_.before.box.diagonal(), [&](const FarSample& sample) -> std::string {
      const FacetFate fate = prepared_.fates[sample.facet];
      const bool inside = role(sample.facet) == FacetRole::interior || result_index.winding_number(sample.at) > 0.5;
      if (!report_.is_sheet && inside) return std::string(reason(FacetFate::absorbed));
      if (fate != FacetFate::used) return std::string(reason(fate));
      if (role(sample.facet) == FacetRole::unresolved) return "thinner than a cell";
      return report_.options.smooth > 0 ? "smoothed away" : "not resolved";
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
      c.reason = report_.options.smooth > 0 ? "thinner than a cell, or smoothed away" : "thinner than a cell";
    }
    warn_of_losses(missing);
  }

  void warn_of_losses(const MissingComponents& missing) {
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

  void publish(CleanedOutput& output) {
    if (report_.failure && !job_.allow_invalid) return;
    if (report_.after.facets == 0) return;
    begin("writing");
    if (!input_.groups.empty() || !input_.colors.empty()) decorate(output);
    output.publish();
    report_.written = true;
  }

  // The result with the input's names and colours: the same facets, in another order.
  void decorate(CleanedOutput& output) {
    const bool all_known = !sources_.empty() && std::find(sources_.begin(), sources_.end(), kNoFacet) == sources_.end();
    transfer_attributes(input_, TriangleIndex(all_known ? TriangleSoup{} : input_), result_, sources_);
    output.write_and_read_back(result_);
  }

  const CleanJob& job_;
  TriangleSoup result_;  // read back, welded
  std::vector<std::uint32_t> sources_;  // facets of the input behind those of the result, after a local repair
};

}  // namespace

RepairReport clean(const CleanJob& job, Progress& progress) { return Run(job, progress).clean(); }

}  // namespace burnish
