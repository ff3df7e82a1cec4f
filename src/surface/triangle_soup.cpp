#include "burnish/surface/triangle_soup.h"

#include "burnish/core/parallel.h"

namespace burnish {
namespace {

constexpr std::size_t kGrain = 16384;

// Sum over all facets of f(facet), with the same bits for any number of threads.
template <class PerFacet>
double facet_sum(const TriangleSoup& soup, PerFacet&& per_facet) {
  return parallel_reduce(
      soup.facets.size(), kGrain, 0.0,
      [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t f = begin; f < end; ++f) sum += per_facet(f);
        return sum;
      },
      [](double a, double b) { return a + b; });
}

}  // namespace

Box3 bounding_box(const TriangleSoup& soup) {
  return parallel_reduce(
      soup.facets.size(), kGrain, Box3{},
      [&](std::size_t begin, std::size_t end) {
        Box3 box;
        for (std::size_t f = begin; f < end; ++f)
          for (int i = 0; i < 3; ++i) box.extend(soup.corner(f, i));
        return box;
      },
      [](Box3 a, const Box3& b) {
        a.extend(b);
        return a;
      });
}

double area(const TriangleSoup& soup) {
  return facet_sum(soup, [&](std::size_t f) { return 0.5 * norm(facet_normal_2a(soup, f)); });
}

double signed_volume(const TriangleSoup& soup) {
  const Box3 box = bounding_box(soup);
  const Vec3 origin = box.empty() ? Vec3{} : box.center();
  return facet_sum(soup, [&](std::size_t f) {
    return dot(soup.corner(f, 0) - origin, facet_normal_2a(soup, f)) / 6.0;
  });
}

double mean_edge_length(const TriangleSoup& soup) {
  if (soup.facets.empty()) return 0;
  const double sum = facet_sum(soup, [&](std::size_t f) {
    return norm(soup.corner(f, 1) - soup.corner(f, 0)) + norm(soup.corner(f, 2) - soup.corner(f, 1)) +
           norm(soup.corner(f, 0) - soup.corner(f, 2));
  });
  return sum / (3.0 * static_cast<double>(soup.facets.size()));
}

}  // namespace burnish
