#include "burnish/pipeline/field.h"

#include <algorithm>
#include <utility>

#include "burnish/levelset/volume.h"
#include "field_output.h"
#include "level_set_gear.h"
#include "octree_cells.h"
#include "prepare_input.h"
#include "read_input.h"
#include "resolve_options.h"

namespace burnish {
namespace {

double cubed(double a) { return a * a * a; }

// One run: the stages write into the result as they go.
class FieldRun {
 public:
  FieldRun(const FieldJob& job, Progress& progress) : job_(job), progress_(progress), output_(job.output, job.overwrite) {
    report_.input = job.input;
    result_.input = job.input;
    result_.band = job.band;
  }

  FieldResult run() {
    if (prepare()) {
      build();
      measure();
      if (job_.verify > 0) verify();
      if (output_.is_wanted()) write();
    }
    return finish();
  }

 private:
  void begin(const std::string& stage) {
    progress_.check();
    clock_.begin(stage);
    progress_.begin_stage(stage);
  }

  bool prepare() {
    begin("reading");
    input_ = read_input(job_.input, job_.salvage, job_.options, report_);
    begin("inspecting");
    const Inspection inspection = inspect(input_, {}, progress_);
    report_.before = inspection.defects;
    begin("preparing");
    return prepare_solid(input_, inspection, job_.options, prepared_, report_);
  }

  // What decides on the octree stands here and nowhere else.
  void build() {
    begin("distances and signs");
    if (report_.options.max_hole) close_sheet(prepared_, job_.options, report_);
    resolve_cell(job_.options, prepared_.capped, report_.options, report_.warnings, job_.band);
    LevelSetOptions set{.band = job_.band, .room = 0, .far_field = true, .keep_nearest = output_.is_wanted()};
    const ResolvedOptions& options = report_.options;
    set.adaptivity.limits = job_.limits;
    set.adaptivity.limits.coarsest_level = options.coarsest_level;
    if (options.adapt) set.adaptivity.tolerance = *options.adapt / options.cell;
    result_.limits = set.adaptivity.limits;
    built_ = build_level_set(prepared_, set, report_, progress_);
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
    TriangleSoup soup{prepared_.capped.soup.points, {}, {}};
    std::vector<FacetRole> roles;
    for (const std::uint32_t f : built_.facets) {
      soup.facets.push_back(prepared_.capped.soup.facets[f]);
      roles.push_back(built_.roles[f]);
    }
    soup = to_lattice(soup, built_.level_set.frame);
    const double diagonal = bounding_box(soup).diagonal();
    result_.verification = check_distances(soup, roles, built_.level_set, {.nodes = job_.verify, .diagonal = diagonal}, progress_);
  }

  void write() {
    std::vector<std::uint32_t> input_facet(built_.roles.size(), kNoFacet);
    std::copy(prepared_.source.begin(), prepared_.source.end(), input_facet.begin());
    const OctreeCells cells(built_, input_facet, job_.cells);
    output_.require_memory(cells.count(), result_.grid.bytes + built_.nearest.bytes(), job_.options.memory_bytes,
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
  Progress& progress_;
  FieldOutput output_;
  StageClock clock_;
  RepairReport report_;  // what preparation tells
  FieldResult result_;
  TriangleSoup input_;  // welded, otherwise as read
  PreparedInput prepared_;
  BuiltLevelSet built_;
};

}  // namespace

std::string_view name(FieldCells cells) {
  return cells == FieldCells::near ? "near" : cells == FieldCells::blocks ? "blocks" : "cells";
}

FieldResult field(const FieldJob& job, Progress& progress) { return FieldRun(job, progress).run(); }

}  // namespace burnish
