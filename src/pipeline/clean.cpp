#include "burnish/pipeline/clean.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "burnish/io/mesh_io.h"
#include "burnish/levelset/from_triangles.h"
#include "burnish/levelset/smooth/mean_curvature_flow.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/weld.h"
#include "cleaned_output.h"
#include "prepare_input.h"
#include "resolve_options.h"

namespace burnish {
namespace {

constexpr double kLargestDiagonal = 1e60, kSmallestDiagonal = 1e-60;
constexpr double kLargeCaps = 0.1;        // of the input's area: caps beyond this are worth a warning
constexpr double kNegligibleArea = 1e-4;  // of the input's: unresolved details beyond this are worth a warning
constexpr double kVolumeKept = 1e-3;   // drift of the volume beyond which the user is told
constexpr double kUnsmoothedBand = 3;  // cells of exact distances around the surface
constexpr double kDomainMargin = 11;   // cells between the band and the walls

// One run: the stages write into the report as they go.
class Run {
 public:
  Run(const CleanJob& job, Progress& progress) : job_(job), progress_(progress) { report_.input = job.input; }

  RepairReport clean() {
    read();
    CleanedOutput output(job_.output, job_.overwrite);
    report_.output = job_.output;
    report_.output_format = name(output.format());
    if (prepare()) {
      resolve();
      build_level_set();
      smooth();
      extract(output);
      measure();
      publish(output);
    }
    clock_.end();
    report_.stages = clock_.stages();
    return std::move(report_);
  }

 private:
  void begin(const char* stage) {
    progress_.check();
    clock_.begin(stage);
    progress_.begin_stage(stage);
  }

  void read() {
    begin("reading");
    MeshFile file = read_mesh(job_.input, {.salvage = job_.salvage});
    report_.input_format = name(file.format);
    report_.warnings = std::move(file.warnings);
    input_ = weld(std::move(file.soup));
    report_.groups = summaries_of_groups(input_);
    const double diagonal = bounding_box(input_).diagonal();
    if (diagonal > kLargestDiagonal || (diagonal > 0 && diagonal < kSmallestDiagonal))
      throw Error(ErrorCode::unreadable_input,
                  fmt::format("{}: expected a size between {:g} and {:g}, found a bounding box with a diagonal of {:g}", job_.input,
                              kSmallestDiagonal, kLargestDiagonal, diagonal),
                  "areas and volumes of such a model are beyond double precision: scale it");
  }

  // Inspects, orients and caps the input. False if it bounds no solid.
  bool prepare() {
    begin("inspecting");
    report_.before = inspect(input_, {}, progress_).defects;
    begin("repairing");
    prepared_ = prepare_input(input_, report_.actions);
    report_.failure = reason_for_no_solid(input_, prepared_, report_.before, report_.actions);
    const double cap_share = report_.actions.cap_area / std::max(report_.before.area, 1e-300);
    if (!report_.failure && cap_share > kLargeCaps)
      report_.warnings.push_back(fmt::format("closing the {} open loops added {:.0f} % to the area; if the model is meant to be open there, "
                                             "this solid is not what you want", report_.actions.open_loops_capped, 100 * cap_share));
    return !report_.failure;
  }

  void resolve() { report_.options = resolve_options(job_.options, prepared_, report_.warnings); }

  void build_level_set() {
    begin("distances and signs");
    const ResolvedOptions& options = report_.options;
    const double smooth_cells = options.smooth / options.cell;
    // Smoothing and extraction look no farther than the band, so the far field is left out.
    LevelSetOptions set{.band = kUnsmoothedBand, .room = 0, .far_field = false};
    if (smooth_cells > 0) {
      set.room = room_for_smoothing(smooth_cells);
      // A bound on the deviation is held against exact distances.
      const double bound = options.deviation ? *options.deviation / options.cell : 0;
      set.band = std::max(kFlowBand, std::min(bound, set.room) + 1);
    }
    const GridFrame frame = make_frame(bounding_box(prepared_), options.cell, set.band + set.room + kDomainMargin);
    LevelSetFromTriangles built = level_set_from_triangles(prepared_, frame, set, progress_);
    report_.actions.ambiguous_regions = built.ambiguous_regions;
    report_.actions.interior_facets_ignored = built.interior_facets;
    report_.actions.unresolved_facets = built.unresolved_facets;
    report_.actions.unresolved_area = built.unresolved_area * options.cell * options.cell;
    if (report_.actions.unresolved_area > kNegligibleArea * report_.before.area)
      report_.warnings.push_back(
          fmt::format("{} facets ({:.3g} of area) bound sheets or walls thinner than a cell of {:.4g} and are not in the result; "
                      "choose a smaller --cell if they matter",
                      built.unresolved_facets, report_.actions.unresolved_area, options.cell));
    level_set_ = std::move(built.level_set);
    const Octree& tree = level_set_.octree();
    report_.grid.blocks = tree.size();
    report_.grid.levels = tree.depth() + 1;
    for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) report_.grid.finest_blocks += tree.level(leaf) == 0;
    report_.grid.bytes_planned = planned_bytes(prepared_, options.cell, set.band + set.room);
  }

  void smooth() {
    const ResolvedOptions& options = report_.options;
    if (options.smooth <= 0) return;
    begin("smoothing");
    SmoothingOptions in_cells{.length = options.smooth / options.cell, .deviation = {}, .keep_volume = true};
    if (options.deviation) in_cells.deviation = *options.deviation / options.cell;
    const SmoothingResult done = smooth_by_flow(level_set_, in_cells, progress_);
    const double square = options.cell * options.cell;
    report_.smoothing = {options.smooth, done.flow.time * square, done.flow.steps,
                         done.volume_before * square * options.cell, done.volume_after * square * options.cell};
    const double drift = done.volume_after / done.volume_before - 1;
    if (!(std::abs(drift) <= kVolumeKept))
      report_.warnings.push_back(fmt::format("smoothing changed the volume by {:.2g} %: {}", 100 * drift,
                                             options.deviation ? "the bound on the deviation did not let it be restored"
                                                               : "the smoothing length is too large for this model"));
  }

  void extract(CleanedOutput& output) {
    begin("extracting and verifying");
    const Inspection inspection = output.write_verified(level_set_, progress_);
    report_.after = inspection.defects;
    report_.verified = inspection.defects.valid_solid();
    if (!report_.verified) report_.failure = output.reason_for_failure(inspection.defects, report_.options);
    result_ = output.take_result();
    level_set_ = {};
  }

  void measure() {
    if (result_.facets.empty()) return;
    begin("measuring");
    report_.deviation.output_to_input = one_sided_distance(result_, TriangleIndex(input_));
    progress_.check();
    const TriangleIndex result_index(result_);
    report_.deviation.input_to_output = one_sided_distance(input_, result_index);
    report_losses(result_index);
  }

  // Nothing is lost silently: names the components of the input that are gone.
  void report_losses(const TriangleIndex& result_index) {
    const double tolerance = 2 * report_.options.cell + 0.5 * report_.options.smooth;
    const MissingComponents missing = missing_components(input_, result_index, tolerance);
    report_.actions.components_lost = missing.count;
    report_.actions.area_lost = missing.area;
    if (missing.count == 0) return;
    const Vec3& at = missing.largest_at;
    report_.warnings.push_back(fmt::format(
        "{} of the input's components ({:.3g} of area) are not in the result, being thinner than a cell or smaller than the smoothing "
        "length; the largest is at ({:.6g}, {:.6g}, {:.6g})",
        missing.count, missing.area, at.x, at.y, at.z));
  }

  void publish(CleanedOutput& output) {
    if (report_.after.facets == 0 || (!report_.verified && !job_.allow_invalid)) return;
    begin("writing");
    output.publish();
    report_.written = true;
  }

  const CleanJob& job_;
  Progress& progress_;
  StageClock clock_;
  RepairReport report_;
  TriangleSoup input_;     // welded, otherwise as read
  TriangleSoup prepared_;  // oriented and capped
  LevelSet level_set_;
  TriangleSoup result_;    // read back, welded
};

}  // namespace

RepairReport clean(const CleanJob& job, Progress& progress) { return Run(job, progress).clean(); }

}  // namespace burnish
