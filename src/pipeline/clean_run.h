// One cleaning run: the stages, in order, and what goes from one to the next.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "burnish/pipeline/clean.h"
#include "burnish/surface/compare.h"
#include "burnish/surface/triangle_index.h"
#include "cleaned_output.h"
#include "denoised.h"
#include "level_set_gear.h"
#include "local_gear.h"
#include "smoothing_plan.h"
#include "solid_run.h"
#include "volume_input.h"

namespace burnish {

class CleanRun : private SolidRun {
 public:
  CleanRun(const CleanJob& job, Progress& progress) : SolidRun(job.input, progress), job_(job) {}
  // A run with other options and another output on the input that `base` has prepared, and on its level set if it shares one.
  CleanRun(const CleanRun& base, const CleanJob& job, std::unique_ptr<CleanedOutput> output);

  // Reads the input, creates the output's temporary file (unless `output` is given), and prepares the input. False if it bounds no solid: the report says why.
  bool open(std::unique_ptr<CleanedOutput> output = nullptr);
  // The same of a surface that is in memory already.
  bool open(TriangleSoup input, std::unique_ptr<CleanedOutput> output);
  // Builds a level set that smoothing by any of these lengths can start from, if the level set is to be smoothed: cells are those of the shortest
  // length, the band and the room those of the longest.
  void share_level_set(const std::vector<Length>& strengths);
  // Repairs, smooths, verifies, measures and publishes.
  void run();

  // The surface as written and read back, welded.
  TriangleSoup take_result() { return std::move(result_); }
  // The same with the names and colours of the input.
  TriangleSoup take_named_result();
  // What `clean` would write, from an output that keeps it: take_named_result, or where there is nothing to name the points in the order of the file.
  TriangleSoup take_written();
  // What was read, and what take_result gives. To be called after `run`, or after `open` has failed.
  CleanSurfaces take_surfaces() { return {std::move(input_), std::move(result_), std::move(inspection_.self_intersections)}; }
  // To be called last.
  RepairReport take_report();

 private:
  void read();
  // What `open` does behind reading.
  bool begin_with(std::unique_ptr<CleanedOutput> output);
  void take_output(std::unique_ptr<CleanedOutput> output);
  // Coarsens a cell that was chosen until the longest length, too, fits the budget.
  void fit_cell_for(const Length& longest);
  // Resolves the rest of the options for this cell, whoever chose it.
  void resolve_with(double cell);
  // Chooses how to smooth.
  void plan();

  // --- the local gear
  double local_tolerance() const;
  bool repair_locally();
  bool is_fine_as_it_is() const;
  bool try_local(std::string& why_not);
  bool try_denoised(std::string& why_not);
  bool verify_local(const LocalSolution& solution, std::string& why_not);
  // The bound on the deviation is one from the surface before it was smoothed.
  void hold_deviation(const TriangleSoup& repaired, double slack);
  void inspect_result(const TriangleSoup& result);
  void judge_result();
  // What a local repair that was not taken has left in the report.
  void forget_attempt();

  // --- the level set gear
  void rebuild();
  // Whether the volume's own level set stands for the prepared input: nothing was dropped or moved, and no other lattice is needed.
  bool takes_volume() const;
  BuiltLevelSet built_level_set();
  void build_and_extract();
  void extract(const BuiltLevelSet& built);
  // The facets that the level set was built from, if it still stands for them.
  std::shared_ptr<const SharpReference> reference_for(const BuiltLevelSet& built);
  double crease_angle() const { return options_.crease_angle.value_or(kCreaseAngle); }
  // Both ways; returns the samples of the input that are farther than options.far_beyond from the result.
  std::vector<FarSample> measure_deviation(const TriangleIndex& result_index, const CompareOptions& options);
  // What the level set resolved of the surface before it was denoised or smoothed: facets that bound the solid.
  TriangleSoup surface_before_smoothing(const std::vector<FacetRole>& roles) const;
  void measure(const std::vector<FacetRole>& roles);
  // Nothing is lost silently.
  void tell_losses(const std::vector<FarSample>& far, const std::vector<FacetRole>& roles, const TriangleIndex& result_index, double limit);
  void warn_of_losses(const MissingComponents& missing);
  bool remeshes() const;
  // Remeshes and simplifies the verified result, writes and verifies it again.
  void resize_facets();
  // What local repair kept is replaced now.
  void tell_replaced();
  // The shape of the result's facets, and its topology beside the level set's.
  void validate_result();
  void compare_topology();
  void publish();
  // The result with the input's names and colours: the same facets, in another order.
  void name_result();

  CleanJob job_;
  CleanOptions options_;  // the job's, with what was chosen for it
  SmoothingPlan plan_;
  std::unique_ptr<CleanedOutput> output_;
  std::shared_ptr<const Region> region_;
  std::optional<NoiseEstimate> noise_;  // of the prepared facets, once it was asked for
  std::shared_ptr<const VolumeInput> volume_;    // of which the input is an iso-surface
  std::shared_ptr<const BuiltLevelSet> shared_;  // before smoothing
  std::vector<Vec3> points_before_;     // of the prepared input, before denoising; where a bound on the deviation was given
  TriangleSoup before_denoising_;       // the repaired surface, where facets were denoised and are to be simplified
  TriangleSoup result_;                 // read back, welded
  std::vector<std::uint32_t> sources_;  // facets of the input behind those of the result, after a local repair
};

}  // namespace burnish
