#include "polynomial_normals.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "burnish/core/parallel.h"
#include "disc_fit.h"
#include "stamped_set.h"

namespace burnish::denoising {
namespace {

constexpr double kFirstRadius = 1.6, kLastRadius = 12.2, kGrowth = 1.5;  // local edges: 1.6, 2.4, 3.6, 5.4, 8.1, 12.15
constexpr double kCut = 6;                     // squared ranges: normals that differ by more are another side's
constexpr double kAgreement = 2.2;             // standard deviations of slopes
constexpr double kMisfit = 2;                  // standard deviations of the mean square of residuals
constexpr double kBent = 6;                    // the part of the sum of squares, in sigma^2, from which a paraboloid is more than a plane: 1 % chance
constexpr double kFineEnough = 0.003;          // radians: a better slope is not looked for
constexpr double kLargestTurn = 0.6;           // radians: fits that turn a facet by more are not believed
constexpr double kLeastError = 0.01;           // radians: fits more precise than this are equal
constexpr double kAlike = 0.4;                 // radians: predictions that differ by less from a facet's own fit count
constexpr double kEdgePerRootArea = 1.5196713713031853;  // of equilateral triangles
constexpr std::size_t kClusterFacets = 32;
constexpr double kClusterReach = 2;          // local edges
constexpr std::size_t kMostFacets = 4000;      // that a cluster looks at

struct Frame {
  Vec3 origin, u, v, n;
};

// With u across `n` towards a point, so that it turns with the surface.
Frame frame_at(const Vec3& origin, const Vec3& n, const Vec3& towards) {
  const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  const Vec3 axis = x <= y && x <= z ? Vec3{1, 0, 0} : y <= z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  const Vec3 u = unit_or(cross(cross(n, towards - origin), n), unit_or(cross(axis, n), {}));
  return {origin, u, cross(n, u), n};
}

// The surface as the fits see it.
struct Scene {
  const FacetMesh& mesh;
  const std::vector<Vec3>&normals, &points, &noisy;
  const PolynomialOptions& options;
  std::vector<Vec3> centroid;
  std::vector<double> spacing;                    // of each facet: the edge of equilateral facets with the mean area of its ring
  std::vector<std::uint32_t> first_side;          // of each point, into `side`: normals of its facets, those alike together
  std::vector<Vec3> side;
  Rows clusters;                                  // facets close together with normals alike

  Scene(const FacetMesh& m, const std::vector<Vec3>& n, const std::vector<Vec3>& p, const std::vector<Vec3>& q, const PolynomialOptions& o);

 private:
  void measure();
  void split_sides(double range);
  void gather_clusters(double range);
};

Scene::Scene(const FacetMesh& m, const std::vector<Vec3>& n, const std::vector<Vec3>& p, const std::vector<Vec3>& q, const PolynomialOptions& o)
    : mesh(m), normals(n), points(p), noisy(q), options(o) {
  measure();
  split_sides(o.range);
  gather_clusters(o.range);
}

void Scene::measure() {
  const FacetGeometry g(mesh, points);
  centroid = g.centroid;
  spacing.resize(centroid.size());
  parallel_for(centroid.size(), [&](std::size_t f) {
    double sum = g.area[f];
    for (const std::uint32_t h : mesh.ring[f]) sum += g.area[h];
    spacing[f] = kEdgePerRootArea * std::sqrt(sum / static_cast<double>(mesh.ring[f].size() + 1));
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
  void start(std::uint32_t seed, double range) {
    seed_ = seed;
    far_ = (std::sqrt(kCut) + 1) * (std::sqrt(kCut) + 1) * range * range;  // facets of a cluster differ from its seed by up to one range
    seen_facets_.clear();
    seen_points_.clear();
    waiting_.assign(1, seed);
    sights_.clear();
    marks_.clear();
    seen_facets_.insert(seed);
    facets_ = 0;
    reach_ = 0;
  }
  // All points of facets whose centroids lie within `to` of the seed's.
  void extend(const Scene& scene, double to) {
    if (to <= reach_) return;
    reach_ = to;
    grow(scene, to);
    marks_.push_back({to, sights_.size()});
  }
  // A point on one side of a crease; points on it are there once for each side, one after another.
  struct Sight {
    Vec3 point, noisy, side;
    double trust = 0;
    bool same_point = false;  // as the entry before
  };
  // The entries gathered within the least reach of those asked for that is `to` at least.
  std::span<const Sight> within(double to) const {
    for (const Mark& m : marks_)
      if (m.reach >= to) return {sights_.data(), m.count};
    return sights_;
  }

 private:
  struct Mark {
    double reach;
    std::size_t count;
  };

  void grow(const Scene& scene, double to) {
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
        if (seen_points_.insert(p)) see(scene, p);
      for (const std::uint32_t next : scene.mesh.across[f])
        if (next != kNoFacet && squared_norm(scene.normals[next] - scene.normals[seed_]) <= far_ && seen_facets_.insert(next)) waiting_.push_back(next);
    }
    waiting_.swap(beyond);
  }
  void see(const Scene& scene, std::uint32_t p) {
    for (std::uint32_t s = scene.first_side[p]; s < scene.first_side[p + 1]; ++s)
      sights_.push_back({scene.points[p], scene.noisy[p], scene.side[s], static_cast<double>(scene.options.trust[p]), s != scene.first_side[p]});
  }

  StampedSet<16384> seen_facets_, seen_points_;
  std::vector<std::uint32_t> waiting_, beyond_;
  std::uint32_t seed_ = 0;
  std::size_t facets_ = 0;
  double far_ = 0, reach_ = 0;
  std::vector<Sight> sights_;
  std::vector<Mark> marks_;
};

// Heights of the points around one facet, up to a radius. [T-DENOISE-3] Likeness weighs (1 - u / 16)^8, u the squared difference of normals in ranges: about
// exp(-u / 2), in less time; and nothing from another side of a crease.
void see(std::span<const Surroundings::Sight> sights, const Frame& frame, double radius, double range, HeightSamples& samples) {
  const double per_range = 1 / (range * range), r2 = radius * radius;
  samples.resize(sights.size());
  std::size_t n = 0;
  bool taken = false;  // the point of the entry before, from another side
  for (const Surroundings::Sight& s : sights) {
    const double unlike = squared_norm(s.side - frame.n) * per_range, d2 = squared_norm(s.point - frame.origin);
    const double like = 1 - unlike / 16, like2 = like * like, like4 = like2 * like2, weight = like4 * like4 * s.trust;
    if (unlike >= kCut || d2 >= r2) {
      taken = taken && s.same_point;
      continue;
    }
    if (s.same_point && taken) {
      samples.weight[n - 1] = std::max(samples.weight[n - 1], weight);
      continue;
    }
    const Vec3 d = s.noisy - frame.origin;
    samples.x[n] = dot(d, frame.u);
    samples.y[n] = dot(d, frame.v);
    samples.z[n] = dot(d, frame.n);
    samples.squared_distance[n] = d2;
    samples.weight[n++] = weight;
    taken = true;
  }
  samples.resize(n);
  samples.resize((n + 3) / 4 * 4);  // new ones weigh nothing
}

// The choice among fits, offered with growing radii: of those that agree with all accepted before them, the one with the least variance. [T-DENOISE-4]
class Lepski {
 public:
  void clear() { accepted_.clear(); }
  bool offer(const DiscFit& fit, double radius) {
    if (!fit.valid || (any() && fit.residual > 1 + kMisfit * fit.residual_error)) return false;
    for (const DiscFit& finer : accepted_)
      if (std::hypot(fit.slope_x - finer.slope_x, fit.slope_y - finer.slope_y) > kAgreement * finer.error) return false;
    if (!any() || fit.error < best.error) best = fit, best_radius = radius;
    accepted_.push_back(fit);
    return true;
  }
  bool any() const { return !accepted_.empty(); }
  DiscFit best;
  double best_radius = 0;

 private:
  std::vector<DiscFit> accepted_;
};

// In the noise's units.
DiscFit scaled(DiscFit fit, const PolynomialOptions& o) {
  fit.error *= o.sigma * o.correlation;
  fit.residual /= o.sigma * o.sigma;
  fit.residual_error *= o.correlation;
  fit.explained /= o.sigma * o.sigma * o.correlation * o.correlation;
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

// Fits around the facets of a cluster.
class ClusterFits {
 public:
  explicit ClusterFits(const Scene& scene) : scene_(scene) {}
  void start(std::uint32_t seed) {
    seed_ = seed;
    around_.start(seed, scene_.options.range);
  }
  Chosen choose(std::uint32_t f) {
    const Frame frame = frame_at(scene_.centroid[f], scene_.normals[f], scene_.points[scene_.mesh.facets[f][0]]);
    const double spacing = scene_.spacing[f], first = std::max(kFirstRadius * spacing, scene_.options.least_radius), last = std::max(kLastRadius * spacing, first);
    choice_.clear();
    if (spacing == 0) return {};
    double seen = 0;
    for (double radius = first; radius <= last; radius *= kGrowth) {
      if (radius > seen) {
        seen = std::min(last, radius * kGrowth);
        const double reach = seen + norm(frame.origin - scene_.centroid[seed_]) + spacing;
        around_.extend(scene_, reach);
        see(around_.within(reach), frame, seen, scene_.options.range, samples_);
      }
      const bool accepted = offer(radius);
      if (choice_.any() && (!accepted || choice_.best.error < kFineEnough)) break;
    }
    const Chosen chosen{frame, choice_.best, choice_.best_radius};
    return choice_.any() && norm(normal_of(chosen, 0, 0) - frame.n) <= kLargestTurn ? chosen : Chosen{};
  }

 private:
  // A plane and a paraboloid have the same slope in the middle of a full disc, at the same variance, but not the same height: a plane must be good enough.
  bool offer(double radius) {
    const DiscMoments moments = disc_moments(samples_, samples_.size(), radius);
    const DiscFit paraboloid = scaled(fit_paraboloid(moments), scene_.options), plane = scaled(fit_plane(moments), scene_.options);
    const bool curved = choice_.offer(paraboloid, radius), bent = paraboloid.valid && paraboloid.explained - plane.explained > kBent;
    return (!bent && choice_.offer(plane, radius)) || curved;
  }

  const Scene& scene_;
  Surroundings around_;
  HeightSamples samples_;
  Lepski choice_;
  std::uint32_t seed_ = 0;
};

std::vector<Chosen> choose_fits(const Scene& scene, Progress& progress) {
  constexpr std::size_t kClustersAtOnce = 32;
  std::vector<Chosen> chosen(scene.normals.size());
  parallel_ranges(scene.clusters.first.size() - 1, kClustersAtOnce, [&](std::size_t begin, std::size_t end) {
    progress.check();
    ClusterFits fits(scene);
    for (std::size_t c = begin; c < end; ++c) {
      const auto cluster = scene.clusters[c];
      fits.start(cluster[0]);
      for (const std::uint32_t f : cluster) chosen[f] = fits.choose(f);
    }
  });
  return chosen;
}

// The mean of what fits say about facet g.
class Consensus {
 public:
  Consensus(const Scene& scene, const std::vector<Chosen>& chosen, std::size_t g)
      : at_(scene.centroid[g]), own_(chosen[g].radius > 0 ? normal_of(chosen[g], 0, 0) : scene.normals[g]) {
    add(chosen[g]);
    for (const std::uint32_t f : scene.mesh.two_rings[g]) add(chosen[f]);
  }
  void write(Vec3& normal, Vec3& foot) const {
    if (sum_ == 0) return;
    normal = unit_or(normal_, own_);
    foot = foot_ / sum_;
  }

 private:
  void add(const Chosen& c) {
    if (c.radius == 0) return;
    const Vec3 d = at_ - c.frame.origin;
    const double q = 1 - squared_norm(d) / (c.radius * c.radius);
    if (q <= 0) return;
    const double x = dot(d, c.frame.u), y = dot(d, c.frame.v);
    const Vec3 n = normal_of(c, x, y);
    const double weight = q * q / (c.fit.error * c.fit.error + kLeastError * kLeastError) * std::exp(-0.5 * squared_norm(n - own_) / (kAlike * kAlike));
    normal_ += n * weight;
    foot_ += foot_of(c, x, y) * weight;
    sum_ += weight;
  }

  Vec3 at_, own_, normal_, foot_;
  double sum_ = 0;
};

}  // namespace

LocalPolynomials local_polynomials(const FacetMesh& mesh, const std::vector<Vec3>& normals, const std::vector<Vec3>& points,
                                   const std::vector<Vec3>& noisy, const PolynomialOptions& options, Progress& progress) {
  const Scene scene(mesh, normals, points, noisy, options);
  const std::vector<Chosen> chosen = choose_fits(scene, progress);
  LocalPolynomials result{normals, scene.centroid};
  parallel_for(chosen.size(), [&](std::size_t g) { Consensus(scene, chosen, g).write(result.normal[g], result.foot[g]); });  // [T-DENOISE-5]
  return result;
}

}  // namespace burnish::denoising
