// What a Sharpening keeps, so that places can be taken back.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "burnish/core/union_find.h"
#include "sharpen_mesh.h"

namespace burnish::detail {

struct SharpeningState {
  SharpenMesh mesh;
  std::vector<Vec3> points;               // where they are
  std::vector<std::uint8_t> steps_back;   // per point: 0 to 3 steps back to mesh.start
  std::vector<Facet> before;              // facets before their shape was improved, with the same numbers
  UnionFind edits{0};                     // facets that one change has changed, and another one after it, are in one set
  std::size_t cut = 0;
  std::function<Vec3(const Vec3&)> written;  // of SharpenOptions
};

SharpenedSurface collected(const SharpeningState& state);

}  // namespace burnish::detail
