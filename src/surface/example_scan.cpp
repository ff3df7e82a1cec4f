// The nozzle as x-ray tomography sees it: grey values on a voxel grid, and the surface extracted from them.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "burnish/core/parallel.h"
#include "example_parts.h"

namespace burnish::example {
namespace {

constexpr std::size_t kFacets = 496'658;
constexpr std::size_t kFragments = 48;
constexpr std::size_t kFacetsPerFragment = 8;
constexpr std::size_t kWallFacets = kFacets - kFragments * kFacetsPerFragment;

// Lengths in cells.
constexpr double kMargin = 6;
constexpr std::array<std::size_t, 3> kVoxel{2, 2, 3};  // slices are thicker than pixels are wide
constexpr double kStaircase = 0.55;                    // 0: no steps, 1: voxels as in a building game
constexpr double kVoxelNoise = 0.22;                   // standard deviations of the grey values
constexpr double kNodeNoise = 0.10;
constexpr double kSpeckle = 1.1;                       // height of the speckles,
constexpr std::uint64_t kSpeckleRarity = 150;          // one voxel in so many is one

Grid empty_grid(double cell) {
  constexpr Vec3 kLower{-1.65, -1.65, 0}, kUpper{1.65, 1.65, 6};
  const auto nodes = [cell](double length) {
    return static_cast<std::size_t>(std::ceil(length / cell + 2 * kMargin)) + 1;
  };
  const Vec3 size = kUpper - kLower;
  Grid grid{nodes(size.x), nodes(size.y), nodes(size.z), cell, {}, {}};
  // Off the lattice of round numbers: no wall lies in a plane of nodes.
  grid.lower = kLower - Vec3{kMargin + 0.13, kMargin + 0.29, kMargin - 0.37} * cell;
  return grid;
}

// How far the grey value of a node says it is from the wall, in cells: partly that of its own place,
// partly that of its voxel's centre, which makes the steps.
double grey_value(const Grid& grid, std::size_t i, std::size_t j, std::size_t k, std::uint64_t seed) {
  const std::array<std::size_t, 3> node{i, j, k};
  Vec3 place = grid.lower;
  std::uint64_t voxel = seed;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t pitch = kVoxel[axis];
    const std::size_t v = node[axis] / pitch;
    const double center = static_cast<double>(v * pitch) + 0.5 * static_cast<double>(pitch - 1);
    const double own = static_cast<double>(node[axis]);
    place[static_cast<int>(axis)] += (own + kStaircase * (center - own)) * grid.cell;
    voxel = scramble(voxel + v + 1);
  }
  const double distance = nozzle_distance(place) / grid.cell;
  if (std::abs(distance) > kMargin) return distance;  // no noise gets that far
  Random of_voxel(voxel), of_node(seed, grid.node(i, j, k));
  const double noise = kVoxelNoise * of_voxel.gaussian() + kNodeNoise * of_node.gaussian();
  const bool speckle = of_voxel.bits() % kSpeckleRarity == 0;
  return distance + noise + (speckle ? of_voxel.uniform(-kSpeckle, kSpeckle) : 0);
}

Grid scanned(double cell, std::uint64_t seed) {
  Grid grid = empty_grid(cell);
  grid.values.resize(grid.nx * grid.ny * grid.nz);
  parallel_for(grid.ny * grid.nz, [&](std::size_t row) {
    const std::size_t j = row % grid.ny, k = row / grid.ny;
    for (std::size_t i = 0; i < grid.nx; ++i) {
      const double value = grey_value(grid, i, j, k, seed);
      grid.values[grid.node(i, j, k)] = value == 0 ? 1e-3 : value;
    }
  }, 16);
  return grid;
}

// The finest scan that does not exceed the number of facets: how many there are depends on the noise.
TriangleSoup scanned_wall(std::uint64_t seed) {
  constexpr double kFinestCell = 0.04144;
  constexpr double kCoarser = 1.0005;
  for (double cell = kFinestCell;; cell *= kCoarser) {
    TriangleSoup wall = zero_surface(scanned(cell, seed));
    if (wall.facets.size() <= kWallFacets) return wall;
  }
}

// Splits the largest facets into three about their centroids until there are `count`. A closed surface
// has an even number of facets, so `count` is met when it is even.
void split_facets_up_to(TriangleSoup& soup, std::size_t count) {
  const std::size_t old = soup.facets.size();
  std::vector<std::pair<double, std::size_t>> by_size;
  for (std::size_t f = 0; f < old; ++f) by_size.emplace_back(-squared_norm(facet_normal_2a(soup, f)), f);
  std::sort(by_size.begin(), by_size.end());
  for (std::size_t n = 0; n < (count - old) / 2; ++n) {
    const std::size_t f = by_size[n].second;
    const auto [a, b, c] = soup.facets[f];
    const auto center = static_cast<std::uint32_t>(soup.points.size());
    soup.points.push_back((soup.points[a] + soup.points[b] + soup.points[c]) / 3);
    soup.facets[f] = {a, b, center};
    soup.facets.push_back({b, c, center});
    soup.facets.push_back({c, a, center});
  }
}

// A crooked octahedron.
void add_fragment(TriangleSoup& soup, const Vec3& center, double radius, Random& random) {
  const auto first = static_cast<std::uint32_t>(soup.points.size());
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      Vec3 p = center;
      p[axis] += sign * radius * random.uniform(0.6, 1.3);
      soup.points.push_back(p);
    }
  for (std::uint32_t octant = 0; octant < kFacetsPerFragment; ++octant) {
    const std::uint32_t x = octant & 1, y = octant >> 1 & 1, z = octant >> 2;
    Facet facet{first + x, first + 2 + y, first + 4 + z};
    if (((x + y + z) & 1) != 0) std::swap(facet[1], facet[2]);
    soup.facets.push_back(facet);
  }
}

// A place off the wall, but not far, and clear of the fragments already there.
Vec3 fragment_place(const std::vector<Vec3>& taken, Random& random) {
  constexpr double kClear = 0.16, kFar = 0.7, kApart = 0.2;
  for (;;) {
    const Vec3 p{random.uniform(-2.4, 2.4), random.uniform(-2.4, 2.4), random.uniform(-0.6, 6.6)};
    const double distance = nozzle_distance(p);
    const bool alone = std::all_of(taken.begin(), taken.end(),
                                   [&](const Vec3& q) { return norm(p - q) > kApart; });
    if (distance > kClear && distance < kFar && alone) return p;
  }
}

}  // namespace

Scan scan_nozzle(std::uint64_t seed) {
  Scan scan{scanned_wall(seed), kWallFacets};
  split_facets_up_to(scan.soup, kWallFacets);
  Random random(seed);
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < kFragments; ++i) {
    places.push_back(fragment_place(places, random));
    add_fragment(scan.soup, places.back(), random.uniform(0.025, 0.07), random);
  }
  return scan;
}

}  // namespace burnish::example
