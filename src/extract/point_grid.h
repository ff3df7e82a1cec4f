// PointGrid: points by cubes, for finding those that are near.
#pragma once

#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "burnish/core/vec.h"

namespace burnish::detail {

// Numbers of points, or of things at points, in a hash of cubes. Cubes keep the order of insertion, and neighbours are visited in a fixed order.
class PointGrid {
 public:
  explicit PointGrid(double cube) : per_cube_(1 / cube) {}

  void insert(const Vec3& p, std::uint32_t number) { cubes_[key(cube_of(p), 0, 0, 0)].push_back(number); }

  // Whether test(number) holds for one in the cube of p or in one of the 26 around it: all within a cube's side of p, and more.
  template <class Test>
  bool any_near(const Vec3& p, Test&& test) const {
    const Cube c = cube_of(p);
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const auto found = cubes_.find(key(c, dx, dy, dz));
          if (found == cubes_.end()) continue;
          for (const std::uint32_t number : found->second)
            if (test(number)) return true;
        }
    return false;
  }
  template <class Visit>
  void for_each_near(const Vec3& p, Visit&& visit) const {
    any_near(p, [&](std::uint32_t number) {
      visit(number);
      return false;
    });
  }

 private:
  struct Cube {
    std::int64_t x, y, z;
  };
  struct Mixed {
    std::size_t operator()(std::uint64_t k) const { return static_cast<std::size_t>((k ^ k >> 29) * 0x9e3779b97f4a7c15u); }
  };
  static std::uint64_t key(const Cube& c, int dx, int dy, int dz) {
    constexpr std::uint64_t mask = (std::uint64_t{1} << 21) - 1;
    return (static_cast<std::uint64_t>(c.x + dx) & mask) | (static_cast<std::uint64_t>(c.y + dy) & mask) << 21 |
           (static_cast<std::uint64_t>(c.z + dz) & mask) << 42;
  }
  Cube cube_of(const Vec3& p) const {
    const auto along = [&](double x) { return static_cast<std::int64_t>(std::floor(x * per_cube_)); };
    return {along(p.x), along(p.y), along(p.z)};
  }

  double per_cube_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>, Mixed> cubes_;
};

}  // namespace burnish::detail
