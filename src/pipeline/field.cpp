#include "burnish/pipeline/field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/levelset/volume.h"
#include "burnish/surface/noise.h"
#include "denoised.h"
#include "field_output.h"
#include "level_set_gear.h"
#include "octree_cells.h"
#include "prepare_input.h"
#include "region.h"
#include "resolve_options.h"
#include "smoothing_plan.h"
#include "solid_run.h"

namespace burnish {
namespace {

constexpr double kVoxelsOfBand = 3;  // of a .vdb, on either side

double cubed(double a) { return a * a * a; }

// One run: the stages write into the result as they go.
class FieldRun : SolidRun {
 public:
  FieldRun(const FieldJob& job, Progress& progress) : SolidRun(job.input, progress), job_(job), output_(job.output, job.overwrite) {
    refuse_clashes();
    if (job.band < least_band(job))
      throw Error(ErrorCode::usage, fmt::format("a band of {:g} cells is less than the {:g} that ACCEPTED cells need", job.band, least_band(job)),
                  "give a wider one, or leave it out");
    result_.input = job.input;
    result_.band = job.band;
  }

  FieldResult run() {
    read(job_.salvage, job_.options);
    if (prepare(job_.options)) {
      plan();
      build();
      if (plan_.flows())
        smooth();
      else if (job_.redistance)
        redistance_from_exact();
      measure();
      if (job_.verify > 0) verify();
      if (output_.is_wanted()) write();
    }
    return finish();
  }

 private:
  void refuse_clashes() const {
    if (!job_.options.smooths()) return;
    const auto refuse = [](const char* message) { throw Error(ErrorCode::usage, message, "leave one of the two out"); };
    if (job_.verify > 0) refuse("--verify-exact compares with the facets of the input, and --smooth moves the surface away from them");
    if (job_.redistance && job_.exact == ExactNodes::band) refuse("--accepted keeps distances to facets, and --smooth moves the surface away from them");
  }

  void plan() {
    options_ = job_.options;
    if (!options_.smooths()) return;
    options_.method = Method::level_set;
    begin("estimating noise");
    const NoiseEstimate noise = estimate_noise(prepared_.oriented);
    std::shared_ptr<const Region> region;
    if (!options_.region.empty()) region = std::make_shared<const Region>(options_.region, report_.recentred_by);
    plan_ = plan_smoothing(options_, noise, region, prepared_, report_);
    options_ = with_plan(options_, plan_);
    if (job_.redistance) report_.options.redistance = *job_.redistance;
  }

  // What decides on the octree stands here and nowhere else.
  void build() {
    begin("distances and signs");
    if (plan_.denoises() || plan_.clamps_outliers) denoise_prepared(prepared_, plan_, report_, progress_);
    if (report_.options.max_hole) close_sheet(prepared_, options_, report_);
    resolve_cell(options_, prepared_.capped, report_.options, report_.warnings, job_.band);
    if (plan_.flows()) {
      built_ = build_level_set(prepared_, report_, progress_);
      return;
    }
    LevelSetOptions set{.band = job_.band, .room = 0, .far_field = !job_.redistance, .keep_nearest = output_.is_wanted()};
    const ResolvedOptions& options = report_.options;
    set.adaptivity.limits = job_.limits;
    set.adaptivity.limits.coarsest_level = options.coarsest_level;
    if (options.adapt) set.adaptivity.tolerance = *options.adapt / options.cell;
    result_.limits = set.adaptivity.limits;
    built_ = build_level_set(prepared_, set, report_, progress_);
  }

  // The flow keeps distances within its band only: afterwards all are computed anew, from the surface as it is now.
  void smooth() {
    begin("smoothing");
    LevelSet& set = built_.level_set;
    smooth_level_set(set, plan_, report_, progress_);
    if (report_.options.adapt) coarsen_level_set(set, report_, progress_);
    begin("redistancing");
    set.phi.make_dense(set.octree().size());
    RedistanceOptions options;
    options.method = report_.options.redistance;
    const RedistanceResult done = redistance(set, options, progress_);
    tell_unsteady(done);
  }

  void tell_unsteady(const RedistanceResult& done) {
    if (!done.steady)
      report_.warnings.push_back(fmt::format("redistancing was not steady after {} steps: the last one's changes were {:.2g} of it", done.steps, done.residual));
  }

  // The facets that the octree's lists number, as a soup in lattice units.
  TriangleSoup listed_facets() const {
    TriangleSoup soup{prepared_.capped.soup.points, {}, {}};
    for (const std::uint32_t f : built_.facets) soup.facets.push_back(prepared_.capped.soup.facets[f]);
    return to_lattice(soup, built_.level_set.frame);
  }

  // Those that are to be exact keep their values, all others start from the band's end, on their side. [T-ACC-2]
  void redistance_from_exact() {
    begin("finding ACCEPTED cells");
    LevelSet& set = built_.level_set;
    set.phi.make_dense(set.octree().size());
    std::vector<char> active;
    for (const std::uint32_t f : built_.facets) active.push_back(built_.roles[f] == FacetRole::boundary);
    AcceptedCells accepted = accepted_cells(listed_facets(), set, active, progress_);
    const bool whole_band = job_.exact == ExactNodes::band;
    accepted_ = whole_band ? nodes_within_band(set, progress_) : std::move(accepted.nodes);
    if (output_.is_wanted()) marks_ = whole_band ? accepted_ : std::move(accepted.cells);
    const auto band = static_cast<float>(set.band);
    parallel_for(set.phi.values().size(), [&](std::size_t n) {
      float& phi = set.phi.values()[n];
      if (accepted_.values()[n] == 0) phi = std::clamp(phi, -band, band);
    });
    begin(fmt::format("redistancing ({})", name(*job_.redistance)));
    RedistanceOptions options;
    options.method = *job_.redistance;
    options.accepted = &accepted_;
    const RedistanceResult done = redistance(set, options, progress_);
    const auto exact_nodes = static_cast<std::uint64_t>(std::count(accepted_.values().begin(), accepted_.values().end(), 1));
    result_.redistancing = {*job_.redistance, job_.exact, accepted.cells_cut, accepted.cells_accepted, exact_nodes, done};
    tell_unsteady(done);
  }

  void measure() {
    begin("measuring");
    const LevelSet& set = built_.level_set;
    FieldGrid& grid = result_.grid;
    grid.blocks = report_.grid.blocks;
    grid.finest_blocks = report_.grid.finest_blocks;
    grid.levels = report_.grid.levels;
    grid.bytes_planned = report_.grid.bytes_planned;
    grid.nodes = set.phi.values().size();
    grid.bytes = set.grid.bytes() + set.phi.bytes();
    grid.by_level.resize(static_cast<std::size_t>(set.octree().depth()) + 1);
    for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf) {
      FieldLevel& level = grid.by_level[static_cast<std::size_t>(set.octree().level(leaf))];
      ++level.blocks;
      level.near_blocks += set.grid.near_surface(leaf);
      grid.near_blocks += set.grid.near_surface(leaf);
    }
    result_.volume = {report_.before.volume, signed_volume(prepared_.capped.soup), enclosed_volume(set) * cubed(set.frame.cell)};
    result_.facets = built_.facets.size();
    result_.regions = built_.regions;
    result_.growth = built_.growth;
  }

  void verify() {
    begin("comparing with exact distances");
    std::vector<FacetRole> roles;
    for (const std::uint32_t f : built_.facets) roles.push_back(built_.roles[f]);
    const TriangleSoup soup = listed_facets();
    const DistanceCheckOptions options{.nodes = job_.verify, .diagonal = bounding_box(soup).diagonal(), .exact = accepted_.empty() ? nullptr : &accepted_};
    result_.verification = check_distances(soup, roles, built_.level_set, options, progress_);
  }

  void write() {
    // Every value is a distance now, however far.
    built_.level_set.band = std::numeric_limits<double>::infinity();
    if (holds_cells(output_.format()))
      write_cells();
    else
      write_samples();
  }

  bool wants(FieldArray array) const {
    const auto& arrays = job_.content.arrays;
    return arrays.empty() || std::find(arrays.begin(), arrays.end(), array) != arrays.end();
  }

  // In finest cells.
  std::optional<double> narrow_band() const {
    if (!job_.content.narrow_band) return std::nullopt;
    return job_.content.narrow_band->in_model_units(report_.before.box.diagonal(), report_.options.cell) / report_.options.cell;
  }

  void write_cells() {
    const auto& arrays = job_.content.arrays;
    if (plan_.flows() && std::find(arrays.begin(), arrays.end(), FieldArray::facet) != arrays.end())
      report_.warnings.push_back("there is no array 'facet': a surface that was smoothed has left the facets");
    std::vector<std::uint32_t> input_facet(built_.roles.size(), kNoFacet);
    std::copy(prepared_.source.begin(), prepared_.source.end(), input_facet.begin());
    Field<float> curvature;
    if (wants(FieldArray::curvature)) {
      begin("curvatures");
      curvature = curvature_of_cells(built_.level_set, progress_);
    }
    const bool is_vtu = output_.format() == FieldFormat::vtu;
    CellChoice choice;
    choice.arrays = arrays;
    choice.at_points = !job_.content.cell_centred;
    if (!marks_.empty()) choice.accepted = &marks_;
    if (!curvature.empty()) choice.curvature = &curvature;
    (is_vtu ? choice.within : choice.clamp) = narrow_band();
    const OctreeCells cells(built_, input_facet, job_.cells, choice);
    const std::uint64_t held = held_bytes() + curvature.bytes();
    output_.require_memory(cells.count(), held, job_.options.memory_bytes,
                           job_.cells == FieldCells::blocks
                               ? "choose a larger --cell, or raise --memory"
                               : "write the octree's blocks with --blocks, choose a larger --cell, or raise --memory");
    begin(FieldOutput::stage(cells.count()));
    output_.write(cells.grid(), progress_);
  }

  std::uint64_t held_bytes() const { return result_.grid.bytes + built_.nearest.bytes() + accepted_.bytes() + marks_.bytes() + built_.certainty.bytes(); }

  void write_samples() {
    const LevelSet& set = built_.level_set;
    const double half_width = narrow_band().value_or(kVoxelsOfBand);
    const bool are_exact = !plan_.flows() && !job_.redistance && !built_.nearest.empty();
    const TriangleSoup facets = are_exact ? to_lattice(prepared_.capped.soup, set.frame) : TriangleSoup{};
    const double band = job_.band * (result_.is_adaptive() ? 1 << report_.options.coarsest_level : 1);
    const FieldSamples samples = are_exact ? FieldSamples(set, facets, built_.roles, built_.nearest, std::max(band, half_width)) : FieldSamples(set);
    if (output_.format() == FieldFormat::vdb) {
      begin("writing");
      return output_.write(set, samples, half_width, held_bytes(), job_.options.memory_bytes, progress_);
    }
    const SampleGrid grid = sample_grid(job_.content, report_.before.box, report_.options.cell);
    output_.require_memory(grid, held_bytes(), job_.options.memory_bytes);
    begin(FieldOutput::stage(std::size_t{grid.nodes[0]} * grid.nodes[1] * grid.nodes[2], "samples"));
    output_.write(grid, samples, set.frame, narrow_band(), progress_);
  }

  FieldResult finish() {
    clock_.end();
    result_.output = output_.told();
    result_.output.cells = job_.cells;
    result_.input_format = report_.input_format;
    result_.unit = report_.unit;
    result_.warnings = std::move(report_.warnings);
    result_.options = report_.options;
    if (plan_.denoises()) result_.options.smooth = plan_.length;
    result_.smoothing = report_.smoothing;
    result_.before = report_.before;
    result_.ambiguous_regions = report_.actions.ambiguous_regions;
    result_.interior_facets = report_.actions.interior_facets_ignored;
    result_.unresolved_facets = report_.actions.unresolved_facets;
    result_.failure = std::move(report_.failure);
    result_.stages = clock_.stages();
    return std::move(result_);
  }

  const FieldJob& job_;
  CleanOptions options_;  // the job's, with what smoothing comes down to
  SmoothingPlan plan_;
  FieldOutput output_;
  FieldResult result_;
  BuiltLevelSet built_;
  // Where others are recomputed: nodes that keep exact distances; of each cell, if they are to be written, whether it is one of those.
  Field<std::uint8_t> accepted_, marks_;
};

}  // namespace

std::string_view name(FieldCells cells) {
  return cells == FieldCells::near ? "near" : cells == FieldCells::blocks ? "blocks" : "cells";
}

std::string_view name(FieldArray array) {
  constexpr std::array<std::string_view, kFieldArrays> names{"phi", "level", "inside", "block", "facet", "mean_curvature", "sign_confidence", "accepted"};
  return names[static_cast<std::size_t>(array)];
}

std::string_view name(ExactNodes nodes) { return nodes == ExactNodes::cells ? "cells" : "band"; }

double least_band(const FieldJob& job) {
  if (!job.redistance || job.exact != ExactNodes::cells || job.options.smooths()) return 0;
  const bool several_levels = job.options.adapt || job.limits.max_face_limit || job.limits.max_face_cut || job.limits.refine_tol;
  return 0.5 * std::ceil(2 * accepted_band(several_levels));
}

FieldResult field(const FieldJob& job, Progress& progress) { return FieldRun(job, progress).run(); }

}  // namespace burnish
