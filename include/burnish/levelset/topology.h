// The topology of the zero surface, from the signs of the level set alone.
//
// The lattice is cut into tetrahedra as the extraction does it (extract/marching_tetrahedra.h): Kuhn tetrahedra, and fans in
// cells with hanging nodes. In each of them phi is taken as linear, so signs at the nodes say which simplices the surface cuts, and
// with that everything about its topology, before there is a surface: what an extraction gives can be held against it.
//
// phi >= 0 is inside. The level set has to be outside (or all inside) at the walls of its domain, so that the surface ends nowhere.
//
// Linear in the number of leaves, and in the nodes of those that the surface cuts. Same bits for any number of threads.
#pragma once

#include <cstdint>

#include "burnish/core/progress.h"
#include "burnish/levelset/level_set.h"

namespace burnish {

struct LevelSetTopology {
  std::size_t inside_components = 0;      // connected through edges of tetrahedra
  std::size_t outside_components = 0;
  std::size_t surface_components = 0;     // each parts one inside from one outside component, and none is parted twice: a tree
  std::int64_t euler_characteristic = 0;  // of the surface
  std::int64_t genus = 0;                 // handles of all components together

  // Outside components but one are enclosed: empty cavities.
  std::size_t cavities() const { return outside_components > 0 ? outside_components - 1 : 0; }
};

template <class T>
LevelSetTopology level_set_topology(const BasicLevelSet<T>& set, Progress& progress = no_progress());

}  // namespace burnish
