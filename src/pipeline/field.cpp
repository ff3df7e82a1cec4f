#include "burnish/pipeline/field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/levelset/volume.h"
#include "field_output.h"
#include "level_set_gear.h"
#include "octree_cells.h"
#include "prepare_input.h"
#include "resolve_options.h"
#include "solid_run.h"

namespace burnish {
namespace {

double cubed(double a) { return a * a * a; }

// One run: the stages write into the result as they go.
class FieldRun : SolidRun {
 public:
  FieldRun(const FieldJob& job, Progress& progress) : SolidRun(job.input, progress), job_(job), output_(job.output, job.overwrite) {
    if (job.band < least_band(job))
      throw Error(ErrorCode::usage, fmt::format("a band of {:g} cells is less than the {:g} that ACCEPTED cells need", job.band, least_band(job)),
                  "give a wider one, or leave it out");
    result_.input = job.input;
    result_.band = job.band;
  }

  FieldResult run() {
    read(job_.salvage, job_.options);
    if (prepare(job_.options)) {
      build();
      if (job_.redistance) redistance_from_exact();
      measure();
      if (job_.verify > 0) verify();
      if (output_.is_wanted()) write();
    }
    return finish();
  }

 private:
  // What decides on the octree stands here and nowhere else.
  void build() {
    begin("distances and signs");
    if (report_.options.max_hole) close_sheet(prepared_, job_.options, report_);
    resolve_cell(job_.options, prepared_.capped, report_.options, report_.warnings, job_.band);
    LevelSetOptions set{.band = job_.band, .room = 0, .far_field = !job_.redistance, .keep_nearest = output_.is_wanted()};
    const ResolvedOptions& options = report_.options;
    set.adaptivity.limits = job_.limits;
    set.adaptivity.limits.coarsest_level = options.coarsest_level;
    if (options.adapt) set.adaptivity.tolerance = *options.adapt / options.cell;
    result_.limits = set.adaptivity.limits;
    built_ = build_level_set(prepared_, set, report_, progress_);
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
    if (!done.steady)
      report_.warnings.push_back(fmt::format("redistancing was not steady after {} steps: the last one's changes were {:.2g} of it", done.steps, done.residual));
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
    std::vector<std::uint32_t> input_facet(built_.roles.size(), kNoFacet);
    std::copy(prepared_.source.begin(), prepared_.source.end(), input_facet.begin());
    const OctreeCells cells(built_, input_facet, job_.cells, marks_.empty() ? nullptr : &marks_);
    output_.require_memory(cells.count(), result_.grid.bytes + built_.nearest.bytes() + accepted_.bytes() + marks_.bytes(), job_.options.memory_bytes,
                           job_.cells == FieldCells::blocks
                               ? "choose a larger --cell, or raise --memory"
                               : "write the octree's blocks with --blocks, choose a larger --cell, or raise --memory");
    begin(FieldOutput::stage(cells.count()));
    output_.write(cells.grid(), progress_);
  }

  FieldResult finish() {
    clock_.end();
    result_.output = output_.told();
    result_.output.cells = job_.cells;
    result_.input_format = report_.input_format;
    result_.warnings = std::move(report_.warnings);
    result_.options = report_.options;
    result_.before = report_.before;
    result_.ambiguous_regions = report_.actions.ambiguous_regions;
    result_.interior_facets = report_.actions.interior_facets_ignored;
    result_.unresolved_facets = report_.actions.unresolved_facets;
    result_.failure = std::move(report_.failure);
    result_.stages = clock_.stages();
    return std::move(result_);
  }

  const FieldJob& job_;
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

std::string_view name(ExactNodes nodes) { return nodes == ExactNodes::cells ? "cells" : "band"; }

double least_band(const FieldJob& job) {
  if (!job.redistance || job.exact != ExactNodes::cells) return 0;
  const bool several_levels = job.options.adapt || job.limits.max_face_limit || job.limits.max_face_cut || job.limits.refine_tol;
  return 0.5 * std::ceil(2 * accepted_band(several_levels));
}

FieldResult field(const FieldJob& job, Progress& progress) { return FieldRun(job, progress).run(); }

}  // namespace burnish
