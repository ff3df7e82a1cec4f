// Geometry in messages and summaries.
#pragma once

#include <string>

#include "burnish/core/vec.h"

namespace burnish {

// "(0, 0, 0) to (1, 2, 3)": its corners, to four digits.
std::string text_of(const Box3& box);

}  // namespace burnish
