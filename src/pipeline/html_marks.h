// Where a surface is broken, for an HTML page: what is drawn over it, and what is listed.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/surface/defect_map.h"
#include "burnish/surface/inspect.h"
#include "html_encode.h"
#include "json.h"

namespace burnish {

struct HtmlMarks {
  Inspection inspection;
  DefectMap map;
};

// Nothing where `counted`, the counts of the same surface, are all zero. Self-intersections are `intersecting`, an inspection's; they are looked for if that is empty
// and some were counted.
HtmlMarks find_marks(const TriangleSoup& welded, const Defects& counted, const std::vector<std::array<std::uint32_t, 2>>& intersecting, Progress& progress);

// Of each point whether something broken uses it: open and other defective edges, facets that intersect. Empty if nothing does.
std::vector<bool> marked_points(const TriangleSoup& welded, const HtmlMarks& marks);

// {kind: {total, listed: [{position, normal, radius, count, length, area}, ...], lines or triangles: base64, drawn}}: corners of the marks by
// `quantisation`, two or three each. No more than 100,000 of a kind are drawn; radius is that of a ball about all of the defect.
Json json_of(const TriangleSoup& welded, const HtmlMarks& marks, const Quantisation& quantisation);

}  // namespace burnish
