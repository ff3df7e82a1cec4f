#include "burnish/core/progress.h"

#include "burnish/core/error.h"

namespace burnish {

void Progress::check() const {
  if (cancelled()) throw Error(ErrorCode::interrupted, "interrupted");
}

Progress& no_progress() {
  static Progress instance;
  return instance;
}

}  // namespace burnish
