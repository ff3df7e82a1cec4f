#include "burnish/pipeline/sweep.h"

#include <memory>
#include <utility>

#include "clean_run.h"

namespace burnish {
namespace {

CleanJob job_of(const CleanJob& job, const SweepStep& step) {
  CleanJob one = job;
  one.options.smooth = step.smooth;
  one.output = step.output;
  return one;
}

}  // namespace

std::vector<RepairReport> sweep(const CleanJob& job, const std::vector<SweepStep>& steps, Progress& progress) {
  std::vector<std::unique_ptr<CleanedOutput>> outputs;
  for (std::size_t i = 1; i < steps.size(); ++i) outputs.push_back(std::make_unique<CleanedOutput>(steps[i].output, job.overwrite));
  std::vector<RepairReport> reports;
  CleanRun base(job_of(job, steps.front()), progress);
  const bool solid = base.open();
  if (solid) {
    std::vector<Length> strengths;
    strengths.reserve(steps.size());
    for (const SweepStep& step : steps) strengths.push_back(step.smooth);
    base.share_level_set(strengths);
    for (std::size_t i = 1; i < steps.size(); ++i) {
      CleanRun run(base, job_of(job, steps[i]), std::move(outputs[i - 1]));
      run.run();
      reports.push_back(run.take_report());
    }
    base.run();
  }
  reports.insert(reports.begin(), base.take_report());
  return reports;
}

}  // namespace burnish
