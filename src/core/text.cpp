#include "burnish/core/text.h"

#include <fmt/format.h>

namespace burnish {

std::string text_of(const Box3& b) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g})", b.lower.x, b.lower.y, b.lower.z, b.upper.x, b.upper.y, b.upper.z);
}

}  // namespace burnish
