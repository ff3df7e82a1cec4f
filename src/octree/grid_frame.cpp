#include "burnish/octree/grid_frame.h"

#include <fmt/format.h>

#include "burnish/core/error.h"

namespace burnish {
namespace {

// Parts of a cell by which the lattice is moved off the box' corner. [T-FRAME-1]
constexpr Vec3 kOffset{0.371029, 0.412937, 0.297183};

}  // namespace

GridFrame make_frame(const Box3& box, double cell, double margin) {
  const double cells = box.longest_side() / cell + 2 * margin + 2;
  GridFrame frame;
  frame.cell = cell;
  while (frame.depth < morton::kMaxDepth && frame.lattice_side() < cells) ++frame.depth;
  if (frame.lattice_side() < cells)
    throw Error(ErrorCode::memory_limit, fmt::format("a cell of {} needs {:.3g} cells a side; 8388608 are possible", cell, cells),
                "choose a larger --cell");
  const Vec3 low = box.center() - Vec3{1, 1, 1} * (0.5 * frame.lattice_side() * cell);
  frame.origin = low + kOffset * cell;
  return frame;
}

}  // namespace burnish
