#include "burnish/extract/delaunay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/validate.h"
#include "delaunay_mesher.h"
#include "field_sampler.h"
#include "protected_curves.h"
#include "seeds.h"
#include "sizing.h"

namespace burnish {
namespace {

using namespace detail;

// Smaller facets find what larger ones miss, at four times the cost: once, and not of large surfaces.
constexpr int kAttempts = 2;
constexpr double kMostFacetsAgain = 100'000;
// Measured [T-DELAUNAY-5]: largest radius of facets over the mean length of their edges, and facets per area in units of that length.
constexpr double kRadiusPerEdge = 0.77;
constexpr double kFacetsPerArea = 2.3;
constexpr double kSpacingPerRadius = 0.95;  // of seeds [T-DELAUNAY-2]
constexpr double kSeedsFromBalls = 0.3;     // edges between seeds and the balls that protect creases
// Derived limits: ten times the points, and twenty times the calls, that were ever needed.
constexpr double kMostPointsPerFacet = 5, kMostCallsPerFacet = 1000;
constexpr double kLeastLimit = 1e5;

class Extraction {
 public:
  Extraction(const LevelSet& level_set, const DelaunayOptions& options, Progress& progress)
      : set_(level_set), options_(options), progress_(progress), field_(level_set, progress) {}

  DelaunaySurface run() {
    surface_ = zero_surface(set_, progress_);
    if (surface_.soup.facets.empty()) return {};
    result_.wanted = level_set_topology(set_, progress_);
    if (options_.edge_tolerance > 0) lengths_ = edge_lengths(set_, surface_, separated_curves(options_.creases, options_.edge), options_, progress_);
    else lengths_.assign(surface_.soup.points.size(), options_.edge);
    Mesh mesh;
    for (double share = 1; result_.attempts < kAttempts; share /= 2) {
      const std::size_t facets_before = mesh.made.soup.facets.size();
      if (4.0 * static_cast<double>(facets_before) > kMostFacetsAgain) break;
      mesh = attempt(share);
      ++result_.attempts;
      if (mesh.flaw.empty() || mesh.made.at_limit) break;  // smaller facets would need more
    }
    return finished(std::move(mesh));
  }

 private:
  struct Mesh {
    MesherResult made;
    std::string flaw;  // why it is not the result
  };

  DelaunaySurface finished(Mesh mesh) {
    result_.oracle_calls = field_.calls();
    result_.failure = std::move(mesh.flaw);
    if (!result_.failure.empty()) return std::move(result_);
    result_.soup = std::move(mesh.made.soup);
    result_.on_crease = std::move(mesh.made.on_crease);
    return std::move(result_);
  }

  // All lengths times `share`.
  Mesh attempt(double share) {
    const MesherRequest request = request_of(share);
    std::vector<double> spacing = lengths_;
    for (double& s : spacing) s *= share * kRadiusPerEdge * kSpacingPerRadius;
    Mesh mesh;
    mesh.made = mesh_surface(field_, request, [&](const std::vector<std::pair<Vec3, double>>& balls) {
      std::vector<SeedFreeBall> free_of;
      free_of.reserve(balls.size());
      for (const auto& [center, radius] : balls) free_of.push_back({center, radius + kSeedsFromBalls * share * options_.edge});
      return spread_seeds(surface_, spacing, free_of, field_);
    });
    result_.points += mesh.made.soup.points.size();
    judge(mesh);
    return mesh;
  }

  void judge(Mesh& mesh) const {
    mesh.flaw = mesh.made.failure;
    if (!mesh.flaw.empty()) return;
    if (mesh.made.soup.facets.empty() || !inspect(mesh.made.soup, {.self_intersections = false}).defects.closed_manifold()) {
      mesh.flaw = "the Delaunay surface is no closed manifold";
      return;
    }
    // Where tetrahedra decide otherwise within a cell than the interpolant, the meshes differ for good.
    const SurfaceTopology made = surface_topology(mesh.made.soup);
    const LevelSetTopology& wanted = result_.wanted;
    if (made.components.size() != wanted.surface_components)
      mesh.flaw = std::to_string(made.components.size()) + " components instead of " + std::to_string(wanted.surface_components);
    else if (made.euler_characteristic != wanted.euler_characteristic)
      mesh.flaw = "Euler characteristic " + std::to_string(made.euler_characteristic) + " instead of " + std::to_string(wanted.euler_characteristic);
  }

  MesherRequest request_of(double share) {
    MesherRequest request;
    const double edge = options_.edge * share, room = std::max(options_.largest_edge, options_.edge) + 2;
    request.facet_size = kRadiusPerEdge * edge;
    request.edge_size = edge;
    request.distance = options_.distance;
    request.min_angle = options_.min_angle;
    request.creases = separated_curves(options_.creases, edge);
    request.box = bounding_box(surface_.soup);
    request.box.lower -= Vec3{room, room, room};
    request.box.upper += Vec3{room, room, room};
    if (options_.edge_tolerance > 0) {
      if (!by_cell_) by_cell_.emplace(surface_.soup.points, lengths_, options_.edge);
      request.sizing = [this, share](const Vec3& p) { return share * kRadiusPerEdge * (*by_cell_)(p); };
    }
    const double facets = kFacetsPerArea * surface_.area / (edge * edge);
    request.max_points = options_.max_points ? options_.max_points : static_cast<std::size_t>(kMostPointsPerFacet * facets + kLeastLimit);
    field_.limit(options_.max_oracle_calls ? options_.max_oracle_calls : static_cast<std::size_t>(kMostCallsPerFacet * (facets + kLeastLimit)));
    return request;
  }

  const LevelSet& set_;
  const DelaunayOptions& options_;
  Progress& progress_;
  FieldSampler field_;
  ZeroSurface surface_;
  std::vector<double> lengths_;  // of edges, for each point of surface_
  std::optional<LengthByCell> by_cell_;
  DelaunaySurface result_;
};

// Area of the zero surface in a leaf's own cells: an edge along axis a that is crossed stands for |n_a| cells squared, and |n_a| is the change of a distance
// along it. [T-DELAUNAY-6]
double crossed_area(const LevelSet& set, std::size_t leaf) {
  constexpr std::array<std::size_t, 3> strides{1, kBlockSide, kBlockSide * kBlockSide};
  const double cell = 1 << set.octree().level(leaf);
  const float* phi = set.phi.block(leaf);
  double area = 0;
  const auto add = [&](float here, float next) {
    if ((here >= 0) != (next >= 0)) area += cell * std::min(cell, static_cast<double>(std::abs(next - here)));
  };
  for (std::size_t n = 0; n < kBlockNodes; ++n)
    for (int axis = 0; axis < 3; ++axis) {
      const std::size_t stride = strides[static_cast<std::size_t>(axis)];
      if (n / stride % kBlockSide < kBlockSide - 1) {
        add(phi[n], phi[n + stride]);
        continue;
      }
      const StoredNode end = next_node(set.octree(), leaf, n, axis);
      if (end.leaf != Octree::kNone) add(phi[n], set.phi.block(end.leaf)[end.node]);
    }
  return area;
}

}  // namespace

DelaunaySurface extract_delaunay(const LevelSet& level_set, const DelaunayOptions& options, Progress& progress) {
  progress.begin_stage("Delaunay surface");
  return Extraction(level_set, options, progress).run();
}

std::size_t predicted_facets(const LevelSet& level_set, const DelaunayOptions& options) {
  std::vector<double> area(level_set.octree().size(), 0);
  parallel_for(
      area.size(), [&](std::size_t leaf) { if (level_set.phi.stores(leaf)) area[leaf] = crossed_area(level_set, leaf); }, 64);
  const double whole = std::accumulate(area.begin(), area.end(), 0.0);
  return static_cast<std::size_t>(kFacetsPerArea * whole / (options.edge * options.edge));
}

}  // namespace burnish
