#include "noise_patch.h"

#include <algorithm>
#include <cmath>

#include "burnish/core/parallel.h"

namespace burnish {
namespace {

constexpr std::size_t kCoefficients = kQuadricCoefficients;
using Row = QuadricRow;
using Matrix = std::array<Row, kCoefficients>;

void set_neighbors(const EdgeTable& edges, PointGraph& graph) {
  for (std::size_t e = 0; e < edges.size(); ++e)
    for (const std::uint32_t p : edges.edge(e)) ++graph.first[p];
  exclusive_scan_in_place(graph.first);
  graph.neighbor.resize(2 * edges.size());
  std::vector<std::uint32_t> next(graph.first.begin(), graph.first.end() - 1);
  // Lexicographic order of the edges: first all lower neighbours of a point come, ascending, then all upper ones.
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto [a, b] = edges.edge(e);
    graph.neighbor[next[a]++] = b;
    graph.neighbor[next[b]++] = a;
  }
}

void set_frame(const Vec3& n, PatchSystem& system) {
  const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  const Vec3 axis = x <= y && x <= z ? Vec3{1, 0, 0} : y <= z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  const Vec3 across = cross(axis, n);
  system.u = across / norm(across);
  system.v = cross(n, system.u);
  system.n = n;
}

// Lower triangle of a symmetric matrix, factorised in place by Cholesky. False: not positive definite to rounding.
bool factorise(Matrix& a) {
  constexpr double kDependent = 1e-9;  // of the diagonal: squares of lengths of about 1
  for (std::size_t j = 0; j < kCoefficients; ++j) {
    const double before = a[j][j];
    double pivot = before;
    for (std::size_t k = 0; k < j; ++k) pivot -= a[j][k] * a[j][k];
    if (!(pivot > kDependent * before)) return false;
    a[j][j] = std::sqrt(pivot);
    for (std::size_t i = j + 1; i < kCoefficients; ++i) {
      double sum = a[i][j];
      for (std::size_t k = 0; k < j; ++k) sum -= a[i][k] * a[j][k];
      a[i][j] = sum / a[j][j];
    }
  }
  return true;
}

Row solve(const Matrix& l, Row b) {
  for (std::size_t i = 0; i < kCoefficients; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= l[i][k] * b[k];
    b[i] /= l[i][i];
  }
  for (std::size_t i = kCoefficients; i-- > 0;) {
    for (std::size_t k = i + 1; k < kCoefficients; ++k) b[i] -= l[k][i] * b[k];
    b[i] /= l[i][i];
  }
  return b;
}

double product(const Row& a, const Row& b) {
  double sum = 0;
  for (std::size_t i = 0; i < kCoefficients; ++i) sum += a[i] * b[i];
  return sum;
}

struct Equations {
  Matrix matrix{};  // the lower triangle
  Row right{};
};

template <class Weight>
Equations equations_of(const PatchSystem& system, Weight&& weight) {
  Equations result;
  for (std::size_t i = 0; i < system.count; ++i)
    for (std::size_t j = 0; j < kCoefficients; ++j) {
      const double weighted = system.rows[i][j] * weight(i);
      for (std::size_t k = 0; k <= j; ++k) result.matrix[j][k] += weighted * system.rows[i][k];
      result.right[j] += weighted * system.heights[i];
    }
  return result;
}

}  // namespace

PointGraph point_graph(const TriangleSoup& soup, const EdgeTable& edges) {
  PointGraph graph;
  graph.first.assign(soup.points.size() + 1, 0);
  graph.normal_area.assign(soup.points.size(), {});
  graph.irregular.assign(soup.points.size(), 0);
  set_neighbors(edges, graph);
  for (std::size_t f = 0; f < soup.facets.size(); ++f) {
    const Vec3 normal = facet_normal_2a(soup, f);
    for (const std::uint32_t p : soup.facets[f]) graph.normal_area[p] += normal;
  }
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (edges.is_non_manifold(e) || edges.is_misoriented(e))
      for (const std::uint32_t p : edges.edge(e)) graph.irregular[p] = 1;
  return graph;
}

std::span<const std::uint32_t> PatchCollector::collect(std::uint32_t center, std::size_t at_least, double radius, const std::vector<Vec3>& points) {
  seen_.clear();
  members_.assign(1, center);
  seen_.insert(center);
  std::size_t ring_begin = 0;
  for (int ring = 1;; ++ring) {
    const std::size_t ring_end = members_.size();
    double reach = 0;
    for (std::size_t i = ring_begin; i < ring_end && members_.size() < kMost; ++i)
      for (const std::uint32_t q : graph_.neighbors(members_[i])) {
        if (!seen_.insert(q)) continue;
        members_.push_back(q);
        reach += norm(points[q] - points[center]);
        if (members_.size() == kMost) break;
      }
    const std::size_t added = members_.size() - ring_end;
    if (added == 0 || members_.size() == kMost) break;
    if (ring >= 2 && members_.size() >= at_least && reach >= radius * static_cast<double>(added)) break;
    ring_begin = ring_end;
  }
  return members_;
}

PatchSystem patch_system(std::span<const std::uint32_t> patch, const PointGraph& graph, const std::vector<Vec3>& points) {
  PatchSystem system;
  Vec3 normal;
  for (const std::uint32_t p : patch) {
    normal += graph.normal_area[p];
    system.size = std::max(system.size, norm(points[p] - points[patch[0]]));
  }
  const double length = norm(normal);
  if (patch.size() <= kQuadricCoefficients || !(system.size > 0) || !(length > 0)) return system;
  set_frame(normal / length, system);
  system.count = patch.size();
  for (std::size_t i = 0; i < patch.size(); ++i) {
    const Vec3 d = (points[patch[i]] - points[patch[0]]) / system.size;  // lengths of about 1: well-conditioned
    const double x = dot(d, system.u), y = dot(d, system.v);
    system.heights[i] = dot(d, system.n);
    system.rows[i] = {1, x, y, x * x, x * y, y * y};
  }
  system.valid = true;
  return system;
}

double PatchSystem::residual(const QuadricRow& coefficients, std::size_t i) const { return heights[i] - product(coefficients, rows[i]); }

Vec3 PatchSystem::normal(const QuadricRow& c) const { return (n - u * c[1] - v * c[2]) / std::sqrt(1 + c[1] * c[1] + c[2] * c[2]); }

std::optional<QuadricRow> weighted_quadric(const PatchSystem& system, std::span<const double> weights) {
  Equations equations = equations_of(system, [&](std::size_t i) { return weights[i]; });
  if (!factorise(equations.matrix)) return std::nullopt;
  return solve(equations.matrix, equations.right);
}

PatchFit fit_patch(std::span<const std::uint32_t> patch, const PointGraph& graph, const std::vector<Vec3>& points) {
  PatchFit fit;
  const PatchSystem system = patch_system(patch, graph, points);
  if (!system.valid) return fit;
  Equations equations = equations_of(system, [](std::size_t) { return 1.0; });
  if (!factorise(equations.matrix)) return fit;
  const QuadricRow c = solve(equations.matrix, equations.right), at_center = solve(equations.matrix, system.rows[0]);
  fit.freedom = static_cast<int>(patch.size() - kQuadricCoefficients);
  fit.normal = system.normal(c);
  // Heights are taken along the patch' mean normal; a frame tilted against the fit stretches them by sqrt(1 + slope^2).
  const double upright = system.size * dot(fit.normal, system.n);
  for (std::size_t i = 0; i < patch.size(); ++i) {
    const double r = system.residual(c, i) * upright;
    fit.rss += r * r;
    fit.influence[i] = product(at_center, system.rows[i]);
  }
  fit.residual = system.residual(c, 0) * upright;
  fit.leverage = fit.influence[0];
  fit.valid = true;
  return fit;
}

}  // namespace burnish
