// What a block sees of its neighbours' published closest points, across level jumps too.
#pragma once

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "../octree/lattice_lookup.h"
#include "burnish/octree/octree.h"
#include "closest_point_kernel.h"

namespace burnish::detail {

// Fills the front of one leaf from its neighbours, direction by direction.
template <class T>
class FrontReader {
 public:
  FrontReader(const Octree& tree, std::size_t leaf, FrontPoints<T>& front) : tree_(tree), leaf_(leaf), front_(front) {}

  // The neighbour in a direction, or the leaf itself.
  void read_same(int dir, const PublishedPoints<T>& from) {
    const auto [dx, dy, dz] = offset_of(dir);
    const Range x = halo_range(dx, 1), y = halo_range(dy, 1), z = halo_range(dz, 1);
    const unsigned wanted = dx == 0 ? 0xffu : dx < 0 ? 0x80u : 0x01u;
    for (int k = z.begin; k < z.end; ++k)
      for (int j = y.begin; j < y.end; ++j) {
        const auto row = static_cast<std::size_t>((j - kBlockSide * dy) + kBlockSide * (k - kBlockSide * dz));
        if ((from.nodes[row] & wanted) == 0) continue;
        const std::size_t source = row * kBlockSide + static_cast<std::size_t>(x.begin - kBlockSide * dx), to = front_.index(x.begin, j, k);
        if (dx == 0) {
          copy<kBlockSide>(from, source, to);
        } else {
          copy<1>(from, source, to);
        }
        front_.note(j, k);
      }
  }

  // One of the finer neighbours in a direction: every second of its nodes is one of the halo's.
  void read_finer(int dir, std::size_t finer, const PublishedPoints<T>& from) {
    const std::array<int, 3> at = corner_from_here(finer, tree_.level(finer));
    for_each(dir, [&](int i, int j, int k) {
      const int x = 2 * i - at[0], y = 2 * j - at[1], z = 2 * k - at[2];
      if (((x | y | z) & ~(kBlockSide - 1)) != 0) return;
      const std::size_t n = node_index(x, y, z);
      if (has(from.nodes, n)) set(i, j, k, from.x[n] / 2, from.y[n] / 2, from.z[n] / 2);
    });
  }

  // The coarser neighbour: halo nodes take the best of the corners of the coarse cell, edge or face that they are on.
  void read_coarser(int dir, std::size_t coarser, const PublishedPoints<T>& from) {
    const std::array<int, 3> at = corner_from_here(coarser, tree_.level(leaf_));
    for_each(dir, [&](int i, int j, int k) {
      const std::array<int, 3> q{i - at[0], j - at[1], k - at[2]};
      std::array<T, 3> best{};
      T least = std::numeric_limits<T>::infinity();
      for (int corner = 0; corner < 8; ++corner) {
        const int cx = corner & 1, cy = corner >> 1 & 1, cz = corner >> 2;
        if ((cx & ~q[0]) | (cy & ~q[1]) | (cz & ~q[2])) continue;
        const int x = (q[0] >> 1) + cx, y = (q[1] >> 1) + cy, z = (q[2] >> 1) + cz;
        if (((x | y | z) & ~(kBlockSide - 1)) != 0) continue;
        const std::size_t n = node_index(x, y, z);
        if (!has(from.nodes, n)) continue;
        const std::array<T, 3> d{2 * from.x[n] + static_cast<T>(2 * x - q[0]), 2 * from.y[n] + static_cast<T>(2 * y - q[1]),
                                 2 * from.z[n] + static_cast<T>(2 * z - q[2])};
        const T d2 = d[0] * d[0] + (d[1] * d[1] + d[2] * d[2]);
        if (d2 < least) least = d2, best = d;
      }
      if (least < std::numeric_limits<T>::infinity()) set(i, j, k, best[0], best[1], best[2]);
    });
  }

 private:
  template <int count>
  void copy(const PublishedPoints<T>& from, std::size_t source, std::size_t to) {
    std::memcpy(&front_.x[to], &from.x[source], count * sizeof(T));
    std::memcpy(&front_.y[to], &from.y[source], count * sizeof(T));
    std::memcpy(&front_.z[to], &from.z[source], count * sizeof(T));
  }

  template <class Visit>
  static void for_each(int dir, Visit&& visit) {
    const auto [dx, dy, dz] = offset_of(dir);
    const Range x = halo_range(dx, 1), y = halo_range(dy, 1), z = halo_range(dz, 1);
    for (int k = z.begin; k < z.end; ++k)
      for (int j = y.begin; j < y.end; ++j)
        for (int i = x.begin; i < x.end; ++i) visit(i, j, k);
  }

  void set(int i, int j, int k, T x, T y, T z) {
    const std::size_t n = front_.index(i, j, k);
    front_.x[n] = x;
    front_.y[n] = y;
    front_.z[n] = z;
    front_.note(j, k);
  }

  // Another leaf's lower corner from this one's, in cells of a level.
  std::array<int, 3> corner_from_here(std::size_t other, int level) const {
    const morton::Position a = tree_.corner(leaf_), b = tree_.corner(other);
    const auto along = [&](std::uint32_t from, std::uint32_t to) {
      return (static_cast<int>(to) - static_cast<int>(from)) * kBlockSide / (1 << level);
    };
    return {along(a.x, b.x), along(a.y, b.y), along(a.z, b.z)};
  }

  const Octree& tree_;
  std::size_t leaf_;
  FrontPoints<T>& front_;
};

}  // namespace burnish::detail
