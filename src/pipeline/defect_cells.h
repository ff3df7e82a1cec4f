// Located defects as cells for a viewer.
#pragma once

#include "burnish/io/marked_cells.h"
#include "burnish/surface/defect_map.h"

namespace burnish {

// As burnish/pipeline/check.h describes `defects_output`; vert i is defect i. Linear in points and elements.
MarkedCells defect_cells(const TriangleSoup& welded, const DefectiveElements& elements, const DefectMap& map);

}  // namespace burnish
