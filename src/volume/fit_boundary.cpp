#include "fit_boundary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "assemble.h"
#include "burnish/core/parallel.h"
#include "burnish/volume/mesh_quality.h"
#include "mend.h"
#include "relax.h"

namespace burnish {
namespace {

// In half sides of the cells at the surface.
constexpr double kReach = 2;          // how far a point may go to the surface
constexpr double kCornerReach = 1.6;  // to a corner of the creases
constexpr double kConnected = 3;      // the ball in which a path around a crease counts
constexpr int kMendings = 6;
constexpr int kSweeps = 3, kRings = 2;  // of relaxing
constexpr int kSteps = 4;    // in which a point goes back
constexpr int kRounds = 24;  // of moving back, in the last one all the way
constexpr MeshQualityLimits kLimits{.non_orthogonality = 65, .internal_skewness = 1, .boundary_skewness = 1};

class Fitting {
 public:
  Fitting(VolumeMesh& mesh, const std::vector<std::uint8_t>& on_wall, const ReferenceSurface& reference, double sign, const std::vector<std::uint8_t>& level, Progress& progress)
      : volume_(mesh), mesh_(mesh.mesh), around_(mesh), on_wall_(on_wall), reference_(reference), sign_(sign), level_(level), largest_(1 << *std::max_element(level.begin(), level.end())), progress_(progress) {}

  BoundaryFit run() {
    start_ = mesh_.points;
    collect_wall();
    project();
    if (reference_.has_creases()) {
      place_corners();
      cover_crossed_edges();
    }
    progress_.check();
    relax(volume_, around_, free_points(), kSweeps);
    restore_quality();
    result_.corners = corner_points_.size();
    return result_;
  }

 private:
  // Half a side of the cells at a point.
  double cell(std::uint32_t p) const { return static_cast<double>(1 << level_[p]); }

  void collect_wall() {
    normal_.assign(mesh_.points.size(), {});
    at_end_ = points_at_end(mesh_, on_wall_);
    for (std::size_t i = 0; i < on_wall_.size(); ++i) {
      if (!on_wall_[i]) continue;
      const auto face = mesh_.face(mesh_.internal_faces() + i);
      Vec3 n;
      for (std::size_t k = 2; k < face.size(); ++k) n += cross(start_[face[k - 1]] - start_[face[0]], start_[face[k]] - start_[face[0]]);
      for (std::size_t k = 0; k < face.size(); ++k) {
        normal_[face[k]] += n;
        edges_.emplace_back(std::min(face[k], face[(k + 1) % face.size()]), std::max(face[k], face[(k + 1) % face.size()]));
      }
    }
    parallel_sort(edges_);
    edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
    for (std::uint32_t p = 0; p < normal_.size(); ++p)
      if (const double length = norm(normal_[p]); length > 0) normal_[p] *= sign_ / length, wall_.push_back(p);
  }

  void project() {
    facet_.assign(mesh_.points.size(), kNoFacet);
    parallel_for(wall_.size(), [&](std::size_t i) {
      const std::uint32_t p = wall_[i];
      const ReferenceSurface::Foot foot = reference_.closest(start_[p], kReach * cell(p), normal_[p]);
      if (!foot.found()) return;
      mesh_.points[p] = foot.point;
      facet_[p] = foot.facet;
    });
  }

  // Each corner of the creases takes the nearest point of the boundary, the nearest pairs first.
  void place_corners() {
    fixed_.assign(mesh_.points.size(), 0);
    const auto& corners = reference_.creases().corners;
    if (corners.empty()) return;
    using Bin = std::array<std::int64_t, 3>;
    const auto bin_of = [&](const Vec3& p) { return Bin{std::llround(std::floor(p.x / (2 * largest_))), std::llround(std::floor(p.y / (2 * largest_))), std::llround(std::floor(p.z / (2 * largest_)))}; };
    std::map<Bin, std::vector<std::uint32_t>> bins;
    for (std::uint32_t c = 0; c < corners.size(); ++c) bins[bin_of(reference_.soup().points[corners[c]])].push_back(c);
    std::vector<std::tuple<double, std::uint32_t, std::uint32_t>> pairs;
    for (const std::uint32_t p : wall_) {
      const Bin at = bin_of(start_[p]);
      for (std::int64_t n = 0; n < 27; ++n) {
        const auto found = bins.find({at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1});
        if (found == bins.end()) continue;
        for (const std::uint32_t c : found->second)
          if (const double d = norm(reference_.soup().points[corners[c]] - start_[p]); d < kCornerReach * cell(p)) pairs.emplace_back(d, p, c);
      }
    }
    std::sort(pairs.begin(), pairs.end());
    std::vector<std::uint8_t> taken(corners.size(), 0);
    for (const auto& [d, p, c] : pairs) {
      if (taken[c] || fixed_[p]) continue;
      taken[c] = fixed_[p] = 1;
      mesh_.points[p] = reference_.soup().points[corners[c]];
      corner_points_.push_back(p);
    }
  }

  bool is_parted(std::uint32_t a, std::uint32_t b) const {
    if (facet_[a] == kNoFacet || facet_[b] == kNoFacet) return false;
    return !reference_.connected(facet_[a], facet_[b], (start_[a] + start_[b]) * 0.5, kConnected * std::max(cell(a), cell(b)));
  }

  void cover_crossed_edges() {
    std::vector<std::uint8_t> near(mesh_.points.size(), 0);
    parallel_for(wall_.size(), [&](std::size_t i) {
      std::uint32_t hint = kNoFacet;
      near[wall_[i]] = reference_.is_near_creases(start_[wall_[i]], kConnected * cell(wall_[i]), hint);
    });
    struct Wish {
      double distance;
      std::uint32_t point, edge;
      Vec3 at;
      bool operator<(const Wish& o) const { return std::tie(distance, point, edge) < std::tie(o.distance, o.point, o.edge); }
    };
    std::vector<std::uint32_t> parted;
    for (std::uint32_t e = 0; e < edges_.size(); ++e)
      if (near[edges_[e].first] && near[edges_[e].second] && is_parted(edges_[e].first, edges_[e].second)) parted.push_back(e);
    std::vector<Wish> wishes(2 * parted.size());
    parallel_for(wishes.size(), [&](std::size_t i) {
      const auto [a, b] = edges_[parted[i / 2]];
      const std::uint32_t p = i % 2 == 0 ? a : b;
      const double reach = kReach * cell(p);
      const ReferenceSurface::Foot foot = reference_.closest_between(mesh_.points[p], reach, facet_[a], facet_[b]);
      wishes[i] = {foot.found() ? std::sqrt(foot.squared_distance) : reach, p, static_cast<std::uint32_t>(i / 2), foot.found() ? foot.point : mesh_.points[p]};
    });
    std::sort(wishes.begin(), wishes.end());
    for (const Wish& w : wishes) {
      const auto [a, b] = edges_[parted[w.edge]];
      if (fixed_[a] || fixed_[b] || w.distance >= kReach * cell(w.point)) continue;
      fixed_[w.point] = 1;
      mesh_.points[w.point] = w.at;
      ++result_.crease_points;
    }
  }

  // Inner points within a few cells of the wall, of cells that are not cubes any more; those of hexahedra keep their right angles.
  std::vector<std::uint8_t> free_points() const {
    std::vector<std::uint8_t> near(mesh_.points.size(), 0);
    for (const std::uint32_t p : wall_) near[p] = 1;
    for (int ring = 0; ring < kRings; ++ring) {
      std::vector<std::uint8_t> wider = near;
      for (std::size_t c = 0; c < volume_.cells(); ++c) {
        const auto cell = volume_.cell(c);
        if (std::any_of(cell.begin(), cell.end(), [&](std::uint32_t p) { return near[p] != 0; }))
          for (const std::uint32_t p : cell) wider[p] = 1;
      }
      near = std::move(wider);
    }
    for (std::size_t f = mesh_.internal_faces(); f < mesh_.faces(); ++f)
      for (const std::uint32_t p : mesh_.face(f)) near[p] = 0;
    for (std::size_t c = 0; c < volume_.cells(); ++c)
      if (volume_.shape[c] == CellShape::hexahedron || volume_.shape[c] == CellShape::polyhedron)
        for (const std::uint32_t p : volume_.cell(c)) near[p] = 0;
    return near;
  }

  void restore_quality() {
    const CellFaces faces = cell_faces(mesh_);
    const std::vector<std::uint8_t> held = held_points();
    Mending mending(volume_, around_, faces, held, kLimits, largest_, progress_);
    const std::vector<Vec3> wanted = mesh_.points;
    std::vector<std::uint8_t> steps(mesh_.points.size(), 0);
    std::vector<BadCell> bad = without_split_ones(volume_, bad_cells(mesh_, kLimits, progress_));
    for (int round = 0; round < kRounds && !bad.empty(); ++round) {
      progress_.check();
      const std::vector<std::uint32_t> points = culprits(faces, bad, round);
      for (const std::uint32_t p : points) {
        ++steps[p];
        const double part = steps[p] >= kSteps || round + 2 >= kRounds ? 0 : 1 - static_cast<double>(steps[p]) / kSteps;
        mesh_.points[p] = start_[p] + (wanted[p] - start_[p]) * part;
      }
      bad = mending.judged_again(bad, points);
    }
    // What is bad without any point having moved; at corners only where nothing else helps.
    bad = mending.mend(std::move(bad), kMendings);
    Mending last(volume_, around_, faces, at_end_, kLimits, largest_, progress_);
    result_.bad = last.mend(std::move(bad), kMendings).size();
    result_.mended = mending.moves() + last.moves();
    for (const std::uint8_t s : steps) result_.moved_back += s > 0;
  }

  // On the domain's sides, or at corners of the creases.
  std::vector<std::uint8_t> held_points() const {
    std::vector<std::uint8_t> held = at_end_;
    for (const std::uint32_t p : corner_points_) held[p] = 1;
    return held;
  }

  // Of each bad cell the point that has moved farthest; in later rounds all of them, then those of the neighbours too.
  std::vector<std::uint32_t> culprits(const CellFaces& faces, const std::vector<BadCell>& bad, int round) const {
    std::vector<std::uint32_t> cells, points;
    for (const BadCell& b : bad) {
      cells.push_back(b.cell);
      if (round < kRounds / 2) continue;
      for (const std::uint32_t f : faces[b.cell])
        if (f < mesh_.internal_faces()) cells.push_back(mesh_.owner[f] == b.cell ? mesh_.neighbour[f] : mesh_.owner[f]);
    }
    const auto moved = [&](std::uint32_t p) { return squared_norm(mesh_.points[p] - start_[p]); };
    for (const std::uint32_t c : cells) {
      const auto cell = volume_.cell(c);
      if (round < kRounds / 2) points.push_back(*std::max_element(cell.begin(), cell.end(), [&](std::uint32_t a, std::uint32_t b) { return std::pair(moved(a), b) < std::pair(moved(b), a); }));
      else points.insert(points.end(), cell.begin(), cell.end());
    }
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    std::erase_if(points, [&](std::uint32_t p) { return !(moved(p) > 0); });
    return points;
  }

  VolumeMesh& volume_;
  PolyhedralMesh& mesh_;
  const PointCells around_;
  const std::vector<std::uint8_t>& on_wall_;
  const ReferenceSurface& reference_;
  const double sign_;
  const std::vector<std::uint8_t>& level_;
  const double largest_;  // cell
  Progress& progress_;
  std::vector<Vec3> start_, normal_;
  std::vector<std::uint32_t> wall_;  // points on the surface
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges_;  // of the boundary
  std::vector<std::uint8_t> at_end_;  // on a side of the domain
  std::vector<std::uint32_t> facet_;
  std::vector<std::uint8_t> fixed_;  // on a crease or a corner
  std::vector<std::uint32_t> corner_points_;
  BoundaryFit result_;
};

}  // namespace

BoundaryFit fit_boundary(VolumeMesh& mesh, const std::vector<std::uint8_t>& on_wall, const ReferenceSurface& reference, double sign, const std::vector<std::uint8_t>& level, Progress& progress) {
  return Fitting(mesh, on_wall, reference, sign, level, progress).run();
}

}  // namespace burnish
