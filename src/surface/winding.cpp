#include "burnish/surface/winding.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>

#include "burnish/core/parallel.h"
#include "ray_winding.h"

namespace burnish {
namespace {

constexpr std::size_t kGrain = 4096;

// A number for an edge between two points, without its direction. Finaliser of MurmurHash3 (Appleby 2008).
std::uint64_t hash_of(std::uint32_t a, std::uint32_t b) {
  std::uint64_t h = static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b);
  h = (h ^ h >> 33) * 0xff51afd7ed558ccdull;
  h = (h ^ h >> 33) * 0xc4ceb9fe1a85ec53ull;
  return h ^ h >> 33;
}

}  // namespace

bool is_closed_chain(const TriangleSoup& soup) {
  if (soup.facets.empty()) return false;
  const auto sum = [&](std::size_t begin, std::size_t end) {
    std::uint64_t boundary = 0;
    for (std::size_t f = begin; f < end; ++f)
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = soup.facets[f][i], b = soup.facets[f][(i + 1) % 3];
        if (a != b) boundary += a < b ? hash_of(a, b) : 0 - hash_of(a, b);
      }
    return boundary;
  };
  return parallel_reduce(soup.facets.size(), kGrain, std::uint64_t{0}, sum, std::plus<>()) == 0;
}

std::vector<std::int32_t> winding_numbers(const TriangleSoup& soup, const std::vector<Vec3>& points) {
  std::vector<std::int32_t> winding(points.size(), 0);
  if (points.empty()) return winding;
  const PointColumns columns(points);
  parallel_ranges(soup.facets.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const std::array<Vec3, 3> corners{soup.corner(f, 0), soup.corner(f, 1), soup.corner(f, 2)};
      Box3 box;
      for (const Vec3& c : corners) box.extend(c);
      columns.for_each_in(box, [&](std::uint32_t i) {
        if (box.upper.z < points[i].z) return;
        const int sign = passes(corners, points[i]);
        if (sign != 0) std::atomic_ref<std::int32_t>(winding[i]).fetch_add(sign, std::memory_order_relaxed);
      });
    }
  });
  return winding;
}

}  // namespace burnish
