#include "burnish/surface/denoise.h"

namespace burnish {

DenoiseResult denoise(const TriangleSoup& oriented, const DenoiseOptions& options, Progress& progress) {
  static_cast<void>(options);
  progress.check();
  DenoiseResult result;
  result.soup = oriented;
  result.noise = estimate_noise(oriented);
  return result;
}

}  // namespace burnish
