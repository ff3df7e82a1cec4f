#include "burnish/extract/delaunay.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "burnish/core/parallel.h"
#include "delaunay_mesher.h"
#include "field_sampler.h"
#include "seeds.h"

namespace burnish {
namespace {

using namespace detail;

constexpr int kAttempts = 3;
constexpr double kRadiusPerEdge = 0.80;   // largest radius of facets over the mean length of their edges [T-DELAUNAY-3]
constexpr double kSpacingPerRadius = 0.95;

class Extraction {
 public:
  Extraction(const LevelSet& level_set, const DelaunayOptions& options, Progress& progress)
      : set_(level_set), options_(options), progress_(progress), field_(level_set, progress) {}

  DelaunaySurface run() {
    surface_ = zero_surface(set_, progress_);
    if (surface_.soup.facets.empty()) return {};
    double edge = options_.edge;
    for (int attempt = 0; attempt < kAttempts; ++attempt, edge /= 2) {
      result_.attempts = attempt + 1;
      mesh(edge);
      if (result_.failure.empty()) break;
    }
    result_.oracle_calls = field_.calls();
    if (!result_.failure.empty()) result_.soup = {}, result_.on_crease = {};
    return std::move(result_);
  }

 private:
  void mesh(double edge) {
    MesherRequest request;
    request.facet_size = kRadiusPerEdge * edge;
    request.distance = options_.distance;
    request.min_angle = options_.min_angle;
    request.edge_size = edge;
    request.box = bounding_box(surface_.soup);
    request.box.lower -= Vec3{1, 1, 1} * (edge + 2);
    request.box.upper += Vec3{1, 1, 1} * (edge + 2);
    const double expected = surface_.area / (edge * edge);
    request.max_points = options_.max_points ? options_.max_points : static_cast<std::size_t>(20 * expected) + 100000;
    field_.limit(options_.max_oracle_calls ? options_.max_oracle_calls : static_cast<std::size_t>(4000 * expected) + 20000000);
    MesherResult made = mesh_surface(field_, request, [&](const std::vector<std::pair<Vec3, double>>& balls) {
      std::vector<SeedFreeBall> free_of;
      for (const auto& [center, radius] : balls) free_of.push_back({center, radius + 0.3 * edge});
      return spread_seeds(surface_, std::vector<double>(surface_.soup.points.size(), kSpacingPerRadius * request.facet_size), free_of, field_);
    });
    result_.points += made.soup.points.size();
    result_.failure = made.failure.empty() ? flaw_of(made.soup) : made.failure;
    result_.soup = std::move(made.soup);
    result_.on_crease = std::move(made.on_crease);
  }

  std::string flaw_of(const TriangleSoup& soup) const {
    if (soup.facets.empty() || !is_closed_manifold(soup)) return "the Delaunay surface is no closed manifold";
    const Topology made = topology_of(soup), wanted = surface_.topology;
    if (made.components != wanted.components)
      return std::to_string(made.components) + " components instead of " + std::to_string(wanted.components);
    if (made.euler != wanted.euler)
      return "Euler characteristic " + std::to_string(made.euler) + " instead of " + std::to_string(wanted.euler);
    return {};
  }

  const LevelSet& set_;
  const DelaunayOptions& options_;
  Progress& progress_;
  FieldSampler field_;
  ZeroSurface surface_;
  DelaunaySurface result_;
};

}  // namespace

DelaunaySurface extract_delaunay(const LevelSet& level_set, const DelaunayOptions& options, Progress& progress) {
  return Extraction(level_set, options, progress).run();
}

}  // namespace burnish
