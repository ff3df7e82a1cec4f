// Marching tetrahedra on Kuhn's division of the cube: six tetrahedra around the main diagonal, one for
// each order in which the axes can be walked from the lowest corner to the highest. Neighbouring cubes
// divide their common face alike, so the surface closes.
#include <algorithm>
#include <array>
#include <utility>

#include "example_parts.h"

namespace burnish::example {
namespace {

// Every edge of the division leads from a node to the one that is a step further along one, two or
// three axes: node * 8 + the axes as bits.
using EdgeKey = std::uint64_t;
using KeyedFacet = std::array<EdgeKey, 3>;

struct Walk {
  std::array<unsigned, 4> corners;  // as bits of the axes walked so far
  bool right_handed;
};

constexpr std::array<Walk, 6> kWalks{{
    {{0, 1, 3, 7}, true}, {{0, 2, 6, 7}, true}, {{0, 4, 5, 7}, true},
    {{0, 1, 5, 7}, false}, {{0, 2, 3, 7}, false}, {{0, 4, 6, 7}, false},
}};

class Marcher {
 public:
  explicit Marcher(const Grid& grid) : grid_(grid) {}

  std::vector<KeyedFacet> run() {
    for (std::size_t k = 0; k + 1 < grid_.nz; ++k)
      for (std::size_t j = 0; j + 1 < grid_.ny; ++j)
        for (std::size_t i = 0; i + 1 < grid_.nx; ++i) cube(grid_.node(i, j, k));
    return std::move(facets_);
  }

  std::size_t corner_node(std::size_t base, unsigned axes) const {
    return base + (axes & 1) + (axes >> 1 & 1) * grid_.nx + (axes >> 2) * grid_.nx * grid_.ny;
  }

 private:
  void cube(std::size_t base) {
    unsigned inside = 0;
    for (unsigned c = 0; c < 8; ++c)
      if (grid_.values[corner_node(base, c)] < 0) inside |= 1u << c;
    if (inside == 0 || inside == 255) return;
    for (const Walk& walk : kWalks) tetrahedron(base, walk, inside);
  }

  EdgeKey edge(std::size_t base, unsigned a, unsigned b) const {
    return corner_node(base, std::min(a, b)) * 8 + (a ^ b);
  }

  // Puts the corners inside first, by neighbour swaps that keep track of the handedness.
  void tetrahedron(std::size_t base, const Walk& walk, unsigned inside) {
    std::array<unsigned, 4> v = walk.corners;
    bool right_handed = walk.right_handed;
    const auto is_in = [inside](unsigned c) { return (inside >> c & 1) != 0; };
    for (int pass = 0; pass < 3; ++pass)
      for (std::size_t i = 0; i < 3; ++i)
        if (!is_in(v[i]) && is_in(v[i + 1])) {
          std::swap(v[i], v[i + 1]);
          right_handed = !right_handed;
        }
    const auto cut = [&](std::size_t a, std::size_t b) { return edge(base, v[a], v[b]); };
    switch (std::count_if(v.begin(), v.end(), is_in)) {
      case 1: add(cut(0, 1), cut(0, 2), cut(0, 3), right_handed); break;
      case 2:
        add(cut(0, 2), cut(0, 3), cut(1, 3), right_handed);
        add(cut(0, 2), cut(1, 3), cut(1, 2), right_handed);
        break;
      case 3: add(cut(0, 3), cut(1, 3), cut(2, 3), right_handed); break;
      default: break;
    }
  }

  void add(EdgeKey a, EdgeKey b, EdgeKey c, bool right_handed) {
    if (right_handed) facets_.push_back({a, b, c});
    else facets_.push_back({a, c, b});
  }

  const Grid& grid_;
  std::vector<KeyedFacet> facets_;
};

// Where the values along an edge cross zero, but not next to a node: facets there would be needles.
Vec3 crossing(const Grid& grid, const Marcher& marcher, EdgeKey key) {
  const std::size_t a = key / 8;
  const std::size_t b = marcher.corner_node(a, static_cast<unsigned>(key % 8));
  const double s = grid.values[a] / (grid.values[a] - grid.values[b]);
  return grid.position(a) + std::clamp(s, 0.12, 0.88) * (grid.position(b) - grid.position(a));
}

}  // namespace

TriangleSoup zero_surface(const Grid& grid) {
  Marcher marcher(grid);
  const std::vector<KeyedFacet> keyed = marcher.run();
  std::vector<EdgeKey> keys;
  for (const KeyedFacet& facet : keyed) keys.insert(keys.end(), facet.begin(), facet.end());
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());

  TriangleSoup soup;
  for (const EdgeKey key : keys) soup.points.push_back(crossing(grid, marcher, key));
  const auto index = [&keys](EdgeKey key) {
    return static_cast<std::uint32_t>(std::lower_bound(keys.begin(), keys.end(), key) - keys.begin());
  };
  for (const KeyedFacet& facet : keyed)
    soup.facets.push_back({index(facet[0]), index(facet[1]), index(facet[2])});
  return soup;
}

}  // namespace burnish::example
