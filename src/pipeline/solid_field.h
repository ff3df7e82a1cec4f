// A level set as the methods of volume fractions see it: distances and fronts at points of the mesh.
#pragma once

#include <memory>

#include "burnish/core/progress.h"
#include "burnish/levelset/level_set.h"
#include "burnish/surface/triangle_soup.h"
#include "burnish/volume/volume_fraction.h"

namespace burnish {

struct SolidLevelSet {
  std::shared_ptr<const LevelSet> set;
  SolidField field;  // of it: distances by cubic interpolation, fronts of fourth order
};

// Of a closed surface. `cell`: the level set's; `reach`: how far from the surface distances have to be known, as lengths.
SolidLevelSet solid_level_set(const TriangleSoup& surface, double cell, double reach, Progress& progress);

// Memory that its level set is expected to need.
std::uint64_t solid_level_set_bytes(const TriangleSoup& surface, double cell, double reach);

}  // namespace burnish
