// Whether a model and a mesh may have the same unit of length.
#pragma once

#include <optional>
#include <string>

#include "burnish/core/error.h"
#include "burnish/core/vec.h"

namespace burnish {

struct UnitsCheck {
  std::optional<Error> failure;  // their boxes do not meet
  std::string warning;           // the sizes are far apart; empty: nothing strange
};

// `scale`: what the model's coordinates were multiplied by already.
UnitsCheck check_units(const Box3& solid, const Box3& mesh, double scale);

}  // namespace burnish
