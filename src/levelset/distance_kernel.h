// The inner loops of the distance scatter, in a unit of their own that is compiled for several processors.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "burnish/core/vec.h"
#include "burnish/octree/field.h"

namespace burnish::detail {

// Nodes while facets are scattered to them, in rows of eight along x: node (i, j, k), in cells, with i < 8 rows, j < height,
// k < depth. A node whose squared distance is 0 from the start is none.
struct NodeRows {
  int rows, height, depth;  // `height` is a multiple of eight
  // Of row r at (j, k): eight values from 8 row_index(r, j, k). Ids are doubles, so that they live in the same vector lanes.
  double* squared;
  double* id;
  double* row_max;  // the largest of a row's squared distances, at row_index(r, j, k)

  std::size_t row_index(int r, int j, int k) const {
    return static_cast<std::size_t>(j + height * (k + depth * r));
  }
};

// The nodes of one block.
struct alignas(64) BlockDistances {
  std::array<double, kBlockNodes> squared;
  std::array<double, kBlockNodes> id;
  std::array<double, kBlockSide * kBlockSide> row_max;

  void reset(double squared_distance, double facet) {
    squared.fill(squared_distance);
    id.fill(facet);
    row_max.fill(squared_distance);
  }
  NodeRows rows() { return {1, kBlockSide, kBlockSide, squared.data(), id.data(), row_max.data()}; }
};

// A triangle to be scattered, with its box.
struct ScatterItem {
  std::array<Vec3, 3> corners;
  Vec3 low, high;
  double facet;
};

// Rows run along the axis to which the surface is most parallel: x and that axis change places. `across`: the sum of the facets'
// |normals|, component by component.
inline int row_axis(const Vec3& across) {
  return across.x <= across.y && across.x <= across.z ? 0 : across.y <= across.z ? 1 : 2;
}
inline Vec3 swapped(Vec3 v, int axis) {
  std::swap(v.x, v[axis]);
  return v;
}
inline ScatterItem item_of(const Vec3& a, const Vec3& b, const Vec3& c, std::uint32_t facet) {
  return {{a, b, c}, min(min(a, b), c), max(max(a, b), c), static_cast<double>(facet)};
}

// Where the squared distance of a node to an item is below what it has, replaces that, and sets its id. Rows whose box distance
// to the item's box is above `reach`, or no less than the largest of the row's distances, are skipped: nothing changes there, or another
// call has to come. The same bits on every processor.
void scatter(const ScatterItem* items, std::size_t count, double reach, NodeRows nodes);

// distance[i] = the float next to the root of squared[i], for a block's nodes.
void roots(const double* squared, float* distance);

}  // namespace burnish::detail
