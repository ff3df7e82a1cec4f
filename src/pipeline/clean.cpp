#include "burnish/pipeline/clean.h"

#include <memory>
#include <utility>

#include "clean_run.h"
#include "read_input.h"

namespace burnish {

RepairReport clean(const CleanJob& job, Progress& progress) {
  CleanRun run(job, progress);
  if (run.open()) run.run();
  return run.take_report();
}

RepairReport clean(const CleanJob& job, CleanSurfaces& surfaces, Progress& progress) {
  CleanRun run(job, progress);
  if (run.open()) run.run();
  surfaces = run.take_surfaces();
  return run.take_report();
}

namespace {

CleanedSurface finish(CleanRun& run, bool opened) {
  CleanedSurface result;
  if (opened) {
    run.run();
    result.surface = run.take_written();
  }
  result.report = run.take_report();
  return result;
}

}  // namespace

CleanedSurface clean(TriangleSoup input, const CleanOptions& options, Precision precision, Progress& progress) {
  if (input.facets.empty()) throw Error(ErrorCode::unreadable_input, "the surface has no facets", "there is nothing to work on");
  if (options.volume.any()) throw Error(ErrorCode::usage, "options of volumes are for files of values", "leave them out, or name the file");
  CleanJob job;
  job.input = kInMemory;
  job.options = options;
  CleanRun run(job, progress);
  return finish(run, run.open(std::move(input), std::make_unique<CleanedOutput>(precision, true)));
}

CleanedSurface clean_to_memory(const CleanJob& job, Precision precision, Progress& progress) {
  CleanJob no_output = job;
  no_output.output.clear();
  CleanRun run(no_output, progress);
  return finish(run, run.open(std::make_unique<CleanedOutput>(precision, true)));
}

}  // namespace burnish
