#include "burnish/pipeline/clean.h"

#include "clean_run.h"

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

}  // namespace burnish
