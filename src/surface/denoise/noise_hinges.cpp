#include "noise_hinges.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "burnish/core/parallel.h"

namespace burnish {
namespace {

constexpr std::size_t kHinges = 50000;
constexpr double kShare = 0.4, kNormalQuantile = 0.52440;  // |x| < 0.5244 for 40 % of a standard normal distribution

std::uint32_t opposite(const TriangleSoup& soup, const EdgeUse& use) { return soup.facets[use.facet][(use.side + 2u) % 3]; }

// Distance from a plane, as the linear combination of heights that is 0 for any plane, of norm 1: displacements with standard deviation sigma
// give sigma. [T-NOISE-4] Negative: no hinge here.
double hinge_residual(const TriangleSoup& soup, const EdgeTable& edges, std::size_t e) {
  const auto uses = edges.uses(e);
  if (uses.size() != 2) return -1;
  const Vec3 normal = facet_normal_2a(soup, uses[0].facet) + facet_normal_2a(soup, uses[1].facet);
  const double length = norm(normal);
  const Vec3 origin = soup.points[edges.edge(e)[0]];
  const std::array<Vec3, 4> p{Vec3{}, soup.points[edges.edge(e)[1]] - origin, soup.points[opposite(soup, uses[0])] - origin,
                              soup.points[opposite(soup, uses[1])] - origin};
  const auto area = [&](std::size_t i, std::size_t j, std::size_t k) { return dot(cross(p[j] - p[i], p[k] - p[i]), normal); };
  const std::array<double, 4> weight{area(1, 2, 3), -area(0, 2, 3), area(0, 1, 3), -area(0, 1, 2)};
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    sum += weight[i] * dot(p[i], normal);
    squares += weight[i] * weight[i];
  }
  return length > 0 && squares > 0 ? std::abs(sum) / (std::sqrt(squares) * length) : -1;
}

}  // namespace

double hinge_level(const TriangleSoup& soup, const EdgeTable& edges) {
  const std::size_t step = std::max<std::size_t>(1, edges.size() / kHinges), count = (edges.size() + step - 1) / step;
  std::vector<double> residuals(count);
  parallel_for(count, [&](std::size_t i) { residuals[i] = hinge_residual(soup, edges, i * step); });
  std::erase_if(residuals, [](double r) { return !(r >= 0); });
  if (residuals.empty()) return 0;
  const auto at = residuals.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(residuals.size()));
  std::nth_element(residuals.begin(), at, residuals.end());
  return *at / kNormalQuantile;
}

}  // namespace burnish
