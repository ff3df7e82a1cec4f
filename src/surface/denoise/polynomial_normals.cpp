#include "polynomial_normals.h"

#include <algorithm>
#include <cmath>

#include "burnish/core/parallel.h"
#include "disc_fit.h"
#include "tune.h"

namespace burnish::denoising {
namespace {

struct Tuning {
  double grow = tune("PG", 1.5), first = tune("PF", 1.6), last = tune("PL", 12.2), range = tune("PT", .35), kappa = tune("PK", 2.2),
         moved = tune("PM", .6), misfit = tune("PX", 2), bent = tune("PQ", 6), stop = tune("PS", 0.003), floor = tune("AF", 0.01), wide = tune("AW", 1), alike = tune("AS", 0.2);
};

constexpr std::size_t kClusterFacets = 16;
constexpr double kClusterReach = 1.5;          // local edges
constexpr std::size_t kMostFacets = 4000;      // that a cluster looks at

// A set of small numbers that is emptied in no time.
class StampedSet {
 public:
  void clear() {
    if (++stamp_ == 0) {
      std::fill(stamps_.begin(), stamps_.end(), 0);
      stamp_ = 1;
    }
  }
  bool insert(std::uint32_t key) {
    std::size_t at = (key * 2654435761u >> 7) & kMask;
    while (stamps_[at] == stamp_ && keys_[at] != key) at = (at + 1) & kMask;
    if (stamps_[at] == stamp_) return false;
    stamps_[at] = stamp_;
    keys_[at] = key;
    return true;
  }

 private:
  static constexpr std::size_t kMask = 16383;
  std::vector<std::uint32_t> stamps_ = std::vector<std::uint32_t>(kMask + 1, 0), keys_ = std::vector<std::uint32_t>(kMask + 1, 0);
  std::uint32_t stamp_ = 0;
};

struct Frame {
  Vec3 origin, u, v, n;
};

Frame frame_at(const Vec3& origin, const Vec3& n) {
  const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  const Vec3 axis = x <= y && x <= z ? Vec3{1, 0, 0} : y <= z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  const Vec3 across = cross(axis, n), u = across / norm(across);
  return {origin, u, cross(n, u), n};
}

// The surface as the fits see it.
struct Scene {
  const FacetMesh& mesh;
  const std::vector<Vec3>&normals, &points, &noisy;
  const PolynomialOptions& options;
  std::vector<Vec3> centroid;
  std::vector<float> spacing;                     // of each facet: the edge of equilateral facets with the mean area of its ring
  std::vector<std::uint32_t> first_side;          // of each point, into `side`: normals of its facets, those alike together
  std::vector<Vec3> side;
  Rows clusters;                                  // facets close together with normals alike

  Scene(const FacetMesh& m, const std::vector<Vec3>& n, const std::vector<Vec3>& p, const std::vector<Vec3>& q, const PolynomialOptions& o, double range);

 private:
  void measure();
  void split_sides(double range);
  void gather_clusters(double range);
};

Scene::Scene(const FacetMesh& m, const std::vector<Vec3>& n, const std::vector<Vec3>& p, const std::vector<Vec3>& q, const PolynomialOptions& o,
             double range)
    : mesh(m), normals(n), points(p), noisy(q), options(o) {
  measure();
  split_sides(range);
  gather_clusters(range);
}

void Scene::measure() {
  const FacetGeometry g(mesh, points);
  centroid = g.centroid;
  spacing.resize(centroid.size());
  parallel_for(centroid.size(), [&](std::size_t f) {
    double sum = g.area[f];
    for (const std::uint32_t h : mesh.ring[f]) sum += g.area[h];
    spacing[f] = static_cast<float>(1.5197 * std::sqrt(sum / static_cast<double>(mesh.ring[f].size() + 1)));  // sqrt(4 / sqrt(3))
  });
}

void Scene::split_sides(double range) {
  first_side.assign(points.size() + 1, 0);
  const auto sides_of = [&](std::size_t p, std::vector<Vec3>& sides) {
    sides.clear();
    for (const std::uint32_t f : mesh.facets_of_point[p]) {
      const auto alike = std::find_if(sides.begin(), sides.end(), [&](const Vec3& s) { return squared_norm(unit_or(s, {}) - normals[f]) < range * range; });
      if (alike == sides.end()) sides.push_back(normals[f]);
      else *alike += normals[f];
    }
  };
  parallel_ranges(points.size(), kDefaultGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Vec3> sides;
    for (std::size_t p = begin; p < end; ++p) sides_of(p, sides), first_side[p] = static_cast<std::uint32_t>(sides.size());
  });
  side.resize(exclusive_scan_in_place(first_side));
  parallel_ranges(points.size(), kDefaultGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Vec3> sides;
    for (std::size_t p = begin; p < end; ++p) {
      sides_of(p, sides);
      for (std::size_t i = 0; i < sides.size(); ++i) side[first_side[p] + i] = unit_or(sides[i], {});
    }
  });
}

void Scene::gather_clusters(double range) {
  std::vector<std::uint8_t> taken(mesh.facets.size(), 0);
  clusters.first.push_back(0);
  for (std::uint32_t seed = 0; seed < taken.size(); ++seed) {
    if (taken[seed] || norm(normals[seed]) == 0) continue;
    const double reach = kClusterReach * spacing[seed];
    const std::size_t begin = clusters.entries.size();
    clusters.entries.push_back(seed);
    taken[seed] = 1;
    for (std::size_t at = begin; at < clusters.entries.size(); ++at)
      for (const std::uint32_t next : mesh.across[clusters.entries[at]]) {
        if (next == kNoFacet || taken[next] || clusters.entries.size() - begin >= kClusterFacets) continue;
        if (squared_norm(normals[next] - normals[seed]) > range * range || squared_norm(centroid[next] - centroid[seed]) > reach * reach) continue;
        taken[next] = 1;
        clusters.entries.push_back(next);
      }
    clusters.first.push_back(static_cast<std::uint32_t>(clusters.entries.size()));
  }
}

// The points that the facets of a cluster see, gathered farther out as they ask for more.
class Surroundings {
 public:
  void start(const Scene& scene, std::uint32_t seed, double range) {
    seed_ = seed;
    far_ = 16 * range * range;
    seen_facets_.clear();
    seen_points_.clear();
    waiting_.assign(1, seed);
    points.clear();
    seen_facets_.insert(seed);
    facets_ = 0;
    reach = 0;
    static_cast<void>(scene);
  }
  // All points of facets whose centroids lie within `to` of the seed's.
  void extend(const Scene& scene, double to) {
    if (to <= reach) return;
    reach = to;
    std::vector<std::uint32_t>& beyond = beyond_;
    beyond.clear();
    for (std::size_t at = 0; at < waiting_.size(); ++at) {
      const std::uint32_t f = waiting_[at];
      if (squared_norm(scene.centroid[f] - scene.centroid[seed_]) > to * to) {
        beyond.push_back(f);
        continue;
      }
      if (++facets_ > kMostFacets) break;
      for (const std::uint32_t p : scene.mesh.facets[f])
        if (seen_points_.insert(p)) points.push_back(p);
      for (const std::uint32_t next : scene.mesh.across[f])
        if (next != kNoFacet && squared_norm(scene.normals[next] - scene.normals[seed_]) <= far_ && seen_facets_.insert(next)) waiting_.push_back(next);
    }
    waiting_.swap(beyond);
  }
  std::vector<std::uint32_t> points;
  double reach = 0;

 private:
  StampedSet seen_facets_, seen_points_;
  std::vector<std::uint32_t> waiting_, beyond_;
  std::uint32_t seed_ = 0;
  std::size_t facets_ = 0;
  double far_ = 0;
};

// Heights of the points around one facet, up to a radius.
void see(const Scene& scene, const Surroundings& around, const Frame& frame, double radius, double range, HeightSamples& samples) {
  const double r2 = radius * radius, far = 9 * range * range, per_range = -0.5 / (range * range);
  samples.resize(0);
  for (const std::uint32_t p : around.points) {
    const double d2 = squared_norm(scene.points[p] - frame.origin);
    if (d2 >= r2) continue;
    double unlike = far;
    for (std::uint32_t s = scene.first_side[p]; s < scene.first_side[p + 1]; ++s) unlike = std::min(unlike, squared_norm(scene.side[s] - frame.n));
    if (unlike >= far) continue;
    const Vec3 d = scene.noisy[p] - frame.origin;
    samples.x.push_back(dot(d, frame.u));
    samples.y.push_back(dot(d, frame.v));
    samples.z.push_back(dot(d, frame.n));
    samples.squared_distance.push_back(d2);
    samples.weight.push_back(std::exp(per_range * unlike) * static_cast<double>(scene.options.trust[p]));
  }
  samples.resize((samples.size() + 3) / 4 * 4);  // new ones weigh nothing
}

// The choice among fits, finest first.
class Lepski {
 public:
  Lepski(double kappa, double misfit) : kappa_(kappa), misfit_(misfit) {}
  void clear() { accepted_.clear(); }
  bool offer(const DiscFit& fit, double radius) {
    if (!fit.valid || (!accepted_.empty() && fit.residual > 1 + misfit_ * fit.residual_error)) return false;
    for (const DiscFit& finer : accepted_)
      if (std::hypot(fit.slope_x - finer.slope_x, fit.slope_y - finer.slope_y) > kappa_ * finer.error) return false;
    if (accepted_.empty() || fit.error < best.error) best = fit, best_radius = radius;
    accepted_.push_back(fit);
    return true;
  }
  bool any() const { return !accepted_.empty(); }
  DiscFit best;
  double best_radius = 0;

 private:
  double kappa_, misfit_;
  std::vector<DiscFit> accepted_;
};

DiscFit scaled(DiscFit fit, double sigma, double correlation) {
  fit.error *= sigma * correlation;
  fit.residual_error *= correlation;
  fit.explained /= correlation * correlation;
  fit.residual /= sigma * sigma;
  fit.explained /= sigma * sigma;
  return fit;
}

// The fit chosen for a facet.
struct Chosen {
  Frame frame;
  DiscFit fit;
  double radius = 0;  // 0: none
};

Vec3 normal_of(const Chosen& c, double x, double y) {
  const double sx = c.fit.slope_x + 2 * c.fit.xx * x + c.fit.xy * y, sy = c.fit.slope_y + c.fit.xy * x + 2 * c.fit.yy * y;
  return unit_or(c.frame.n - c.frame.u * sx - c.frame.v * sy, c.frame.n);
}

Vec3 foot_of(const Chosen& c, double x, double y) {
  return c.frame.origin + c.frame.u * x + c.frame.v * y +
         c.frame.n * (c.fit.z + (c.fit.slope_x + c.fit.xx * x + c.fit.xy * y) * x + (c.fit.slope_y + c.fit.yy * y) * y);
}

std::vector<Chosen> choose_fits(const Scene& scene, const Tuning& t) {
  std::vector<Chosen> chosen(scene.normals.size());
  parallel_ranges(scene.clusters.first.size() - 1, 32, [&](std::size_t begin, std::size_t end) {
    Surroundings around;
    HeightSamples samples;
    Lepski choice(t.kappa, t.misfit);
    for (std::size_t c = begin; c < end; ++c) {
      const auto cluster = scene.clusters[c];
      around.start(scene, cluster[0], t.range);
      for (const std::uint32_t f : cluster) {
        const Frame frame = frame_at(scene.centroid[f], scene.normals[f]);
        const double spacing = scene.spacing[f];
        choice.clear();
        double seen = 0;
        for (double multiple = t.first; multiple <= t.last * 1.0001; multiple *= t.grow) {
          const double r = multiple * spacing;
          if (r > seen) {
            seen = std::min(t.last * 1.0001 * spacing, r * t.grow * 1.0001);
            around.extend(scene, seen + norm(frame.origin - scene.centroid[cluster[0]]) + spacing);
            see(scene, around, frame, seen, t.range, samples);
          }
          const DiscMoments moments = disc_moments(samples, samples.size(), r);
          const DiscFit paraboloid = scaled(fit_paraboloid(moments), scene.options.sigma, scene.options.correlation), plane = scaled(fit_plane(moments), scene.options.sigma, scene.options.correlation);
          const bool curved = choice.offer(paraboloid, r);
          const bool bent = paraboloid.valid && paraboloid.explained - plane.explained > t.bent;
          const bool flat = !bent && choice.offer(plane, r);
          if (choice.any() && ((!curved && !flat) || choice.best.error < t.stop)) break;
        }
        if (!choice.any()) continue;
        const Chosen c2{frame, choice.best, choice.best_radius};
        if (norm(normal_of(c2, 0, 0) - frame.n) > t.moved) continue;
        chosen[f] = c2;
      }
    }
  });
  return chosen;
}

// The mean of what the fits of facets nearby say about a facet, weighted by their precision.
void aggregate(const Scene& scene, const std::vector<Chosen>& chosen, const Tuning& t, LocalPolynomials& result) {
  const double floor = t.floor;
  parallel_ranges(chosen.size(), kDefaultGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> near;
    for (std::size_t g = begin; g < end; ++g) {
      const Vec3 own = chosen[g].radius > 0 ? normal_of(chosen[g], 0, 0) : scene.normals[g];
      const auto around = t.wide > 0 ? scene.mesh.two_rings[g] : scene.mesh.ring[g];
      near.assign(around.begin(), around.end());
      near.push_back(static_cast<std::uint32_t>(g));
      Vec3 normal, foot;
      double sum = 0;
      for (const std::uint32_t f : near) {
        const Chosen& c = chosen[f];
        if (c.radius == 0) continue;
        const Vec3 d = scene.centroid[g] - c.frame.origin;
        const double q = 1 - squared_norm(d) / (c.radius * c.radius);
        if (q <= 0) continue;
        const double x = dot(d, c.frame.u), y = dot(d, c.frame.v);
        const Vec3 n = normal_of(c, x, y);
        const double w = q * q / (c.fit.error * c.fit.error + floor * floor) * std::exp(-0.5 * squared_norm(n - own) / (t.alike * t.alike));
        normal += n * w;
        foot += foot_of(c, x, y) * w;
        sum += w;
      }
      if (sum == 0) continue;
      result.normal[g] = unit_or(normal, own);
      result.foot[g] = foot / sum;
      result.slope_error[g] = static_cast<float>(chosen[g].fit.error);
      result.radius[g] = static_cast<float>(chosen[g].radius);
    }
  });
}

}  // namespace

LocalPolynomials local_polynomials(const FacetMesh& mesh, const std::vector<Vec3>& normals, const std::vector<Vec3>& points,
                                   const std::vector<Vec3>& noisy, const PolynomialOptions& o) {
  const Tuning t;
  const Scene scene(mesh, normals, points, noisy, o, t.range);
  const std::size_t count = mesh.facets.size();
  LocalPolynomials result{normals, scene.centroid, std::vector<float>(count, 0), std::vector<float>(count, 0)};
  const std::vector<Chosen> chosen = choose_fits(scene, t);
  if (t.alike > 0) {
    aggregate(scene, chosen, t, result);
    return result;
  }
  for (std::size_t f = 0; f < count; ++f)
    if (chosen[f].radius > 0) {
      result.normal[f] = normal_of(chosen[f], 0, 0);
      result.foot[f] = foot_of(chosen[f], 0, 0);
    }
  return result;
}

}  // namespace burnish::denoising
