#include "repaired_surface.h"

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "clean_run.h"

namespace burnish {

RepairedSurface repaired_surface(const CleanJob& job, Progress& progress, bool named) {
  RepairedSurface result;
  CleanRun run(job, progress);
  const bool solid = run.open(std::make_unique<CleanedOutput>(Precision::float64));
  if (solid) {
    run.run();
    result.surface = named ? run.take_named_result() : run.take_result();
  }
  result.report = run.take_report();
  RepairReport& report = result.report;
  if (!report.failure && report.is_sheet)
    report.failure = Error(ErrorCode::guarantee_unmet, fmt::format("{}: with its wide openings left open it bounds no volume: {} open edges", job.input, report.after.open_edges),
                           "close them with a larger --max-hole, or leave it out to close all");
  if (report.failure) result.surface = {};
  return result;
}

}  // namespace burnish
