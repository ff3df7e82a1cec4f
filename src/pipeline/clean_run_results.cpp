// How a cleaning run ends: the result gets its names and its place, or is handed over.
#include <algorithm>
#include <utility>

#include "burnish/surface/transfer.h"
#include "clean_run.h"

namespace burnish {

void CleanRun::publish() {
  if (report_.failure && !job_.allow_invalid) return;
  if (report_.after.facets == 0 || output_->is_in_memory()) return;
  begin("writing");
  if (!input_.groups.empty() || !input_.colors.empty()) {
    name_result();
    output_->write_and_read_back(result_);
  }
  output_->publish();
  report_.written = true;
}

TriangleSoup CleanRun::take_named_result() {
  name_result();
  return take_result();
}

TriangleSoup CleanRun::take_written() {
  if (result_.facets.empty() || !input_.groups.empty() || !input_.colors.empty()) return take_named_result();
  return output_->take_written();
}

void CleanRun::name_result() {
  if (input_.groups.empty() && input_.colors.empty()) return;
  const bool all_known = !sources_.empty() && std::find(sources_.begin(), sources_.end(), kNoFacet) == sources_.end();
  transfer_attributes(input_, TriangleIndex(all_known ? TriangleSoup{} : input_), result_, sources_);
}

RepairReport CleanRun::take_report() {
  if (plan_.denoises()) report_.options.smooth = plan_.length;
  clock_.end();
  report_.stages = clock_.stages();
  return std::move(report_);
}

}  // namespace burnish
