#include "burnish/core/progress.h"

#include "burnish/core/error.h"

namespace burnish {

void Progress::check() const {
  if (cancelled()) throw Error(ErrorCode::interrupted, "interrupted", "start again: nothing half-written is left behind");
  if (out_of_time()) throw Error(ErrorCode::time_limit, "the time limit is over", "nothing was written; allow more with --time-limit, or choose a larger --cell");
}

Progress& no_progress() {
  static Progress instance;
  return instance;
}

}  // namespace burnish
