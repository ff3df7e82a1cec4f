#include "solid_run.h"

#include <utility>

#include "burnish/surface/weld.h"
#include "read_input.h"

namespace burnish {

void SolidRun::read(bool salvage, const CleanOptions& options) {
  begin("reading");
  input_ = read_input(report_.input, salvage, options, report_);
}

void SolidRun::take(TriangleSoup input, const CleanOptions& options) {
  begin("welding");
  report_.input_format = kInMemory;
  input_ = placed_input(weld(std::move(input)), report_.input, options, report_);
}

bool SolidRun::prepare(const CleanOptions& options) {
  begin("inspecting");
  inspection_ = inspect(input_, {}, progress_);
  report_.before = inspection_.defects;
  begin("preparing");
  return prepare_solid(input_, inspection_, options, prepared_, report_);
}

}  // namespace burnish
