#include "support/shapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace burnish::test {
namespace {

// Each facet in four, the midpoints on the unit sphere.
TriangleSoup subdivided(const TriangleSoup& soup) {
  TriangleSoup result;
  result.points = soup.points;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [at, is_new] =
        middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(result.points.size()));
    if (is_new) {
      const Vec3 sum = soup.points[a] + soup.points[b];
      result.points.push_back(sum / norm(sum));
    }
    return at->second;
  };
  for (const auto& [a, b, c] : soup.facets) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    result.facets.insert(result.facets.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return result;
}

}  // namespace

TriangleSoup cube() {
  TriangleSoup soup;
  for (int i = 0; i < 8; ++i)
    soup.points.push_back({double(i & 1), double(i >> 1 & 1), double(i >> 2)});
  soup.facets = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return soup;
}

TriangleSoup tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  TriangleSoup soup;
  soup.points = {a, b, c, d};
  soup.facets = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  return soup;
}

TriangleSoup icosphere(int level) {
  const double t = std::numbers::phi;
  TriangleSoup soup;
  soup.points = {{-1, t, 0}, {1, t, 0}, {-1, -t, 0}, {1, -t, 0}, {0, -1, t}, {0, 1, t},
                 {0, -1, -t}, {0, 1, -t}, {t, 0, -1}, {t, 0, 1}, {-t, 0, -1}, {-t, 0, 1}};
  for (Vec3& p : soup.points) p = p / norm(p);
  soup.facets = {{0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                 {11, 10, 2}, {10, 7, 6}, {7, 1, 8}, {3, 9, 4}, {3, 4, 2}, {3, 2, 6}, {3, 6, 8},
                 {3, 8, 9}, {4, 9, 5}, {2, 4, 11}, {6, 2, 10}, {8, 6, 7}, {9, 8, 1}};
  for (int i = 0; i < level; ++i) soup = subdivided(soup);
  return soup;
}

TriangleSoup torus(int n, int m) {
  TriangleSoup soup;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const double u = 2 * std::numbers::pi * i / n, v = 2 * std::numbers::pi * j / m;
      const double r = 1 + 0.4 * std::cos(v);
      soup.points.push_back({r * std::cos(u), r * std::sin(u), 0.4 * std::sin(v)});
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i % n * m + j % m); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      soup.facets.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      soup.facets.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return soup;
}

TriangleSoup height_field(int n, const std::function<double(int, int)>& z) {
  TriangleSoup soup;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) soup.points.push_back({1.0 * i / n, 1.0 * j / n, z(i, j)});
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i + (n + 1) * j); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      soup.facets.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      soup.facets.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return soup;
}

TriangleSoup unwelded(const TriangleSoup& soup) {
  TriangleSoup result;
  result.groups = soup.groups;
  for (const Facet& facet : soup.facets) {
    const auto first = static_cast<std::uint32_t>(result.points.size());
    for (const std::uint32_t p : facet) result.points.push_back(soup.points[p]);
    result.facets.push_back({first, first + 1, first + 2});
  }
  return result;
}

TriangleSoup flipped(TriangleSoup soup) {
  for (Facet& facet : soup.facets) std::swap(facet[1], facet[2]);
  return soup;
}

TriangleSoup with_flipped_facet(TriangleSoup soup, std::size_t facet) {
  std::swap(soup.facets[facet][1], soup.facets[facet][2]);
  return soup;
}

TriangleSoup with_copied_facet(TriangleSoup soup, std::size_t facet) {
  const Facet copy = soup.facets[facet];
  soup.facets.push_back(copy);
  return soup;
}

TriangleSoup without_facets(TriangleSoup soup, std::vector<std::size_t> facets) {
  std::sort(facets.begin(), facets.end());
  std::vector<Facet> kept;
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    if (!std::binary_search(facets.begin(), facets.end(), f)) kept.push_back(soup.facets[f]);
  soup.facets = std::move(kept);
  return soup;
}

TriangleSoup mapped(TriangleSoup soup, const std::function<Vec3(const Vec3&)>& map) {
  for (Vec3& p : soup.points) p = map(p);
  return soup;
}

TriangleSoup moved(const TriangleSoup& soup, const Vec3& by) {
  return mapped(soup, [&](const Vec3& p) { return p + by; });
}

TriangleSoup scaled(const TriangleSoup& soup, double by) {
  return mapped(soup, [&](const Vec3& p) { return p * by; });
}

TriangleSoup merged(TriangleSoup a, const TriangleSoup& b) {
  const auto offset = static_cast<std::uint32_t>(a.points.size());
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  for (const auto& [i, j, k] : b.facets) a.facets.push_back({i + offset, j + offset, k + offset});
  return a;
}

}  // namespace burnish::test
