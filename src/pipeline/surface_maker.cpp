#include "surface_maker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "burnish/surface/creases.h"
#include "level_set_gear.h"

namespace burnish {
namespace {

constexpr std::size_t kMostDelaunayFacets = 50'000;
constexpr double kResolvedAngle = 5, kResolvedReach = 1;  // degrees, cells
constexpr double kDistancePerEdge = 0.1;                  // of Delaunay facets, where no tolerance is given
constexpr double kLeastDistance = 0.02;                   // cells
constexpr double kReachPerEdge = 1.5;
constexpr int kSharpeningRounds = 2;
constexpr int kSharpenedRounds = 4;                       // of mending; then the surface stays as it was extracted
constexpr double kShortestNoisyCrease = 8;                // mean edges

std::vector<std::vector<Vec3>> polylines(const TriangleSoup& surface, const Creases& creases) {
  std::vector<std::vector<Vec3>> lines;
  for (const auto& chain : creases.chains) {
    lines.emplace_back();
    for (const std::uint32_t p : chain) lines.back().push_back(surface.points[p]);
  }
  return lines;
}

// What is beyond the range of float32 stays: writing it tells.
Vec3 as_float32(const Vec3& p) {
  const Vec3 rounded{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
  return is_finite(rounded) ? rounded : p;
}

void mark_with_neighbours(const TriangleSoup& soup, const std::vector<std::uint32_t>& vertices, std::vector<std::uint8_t>& marks) {
  std::vector<char> given(soup.points.size(), 0);
  for (const std::uint32_t v : vertices) given[v] = 1;
  for (const Facet& f : soup.facets)
    if (given[f[0]] || given[f[1]] || given[f[2]])
      for (const std::uint32_t v : f) marks[v] = 1;
}

}  // namespace

std::shared_ptr<const SharpReference> make_reference(TriangleSoup surface, std::optional<double> crease_angle, double sigma) {
  CreaseOptions options{.angle = crease_angle.value_or(kCreaseAngle), .sigma = sigma};
  if (sigma > 0) options.least_length = kShortestNoisyCrease * mean_edge_length(surface);
  std::vector<std::vector<Vec3>> sharp = polylines(surface, find_creases(surface, options));
  if (sigma == 0 && !crease_angle) {
    options.resolved_angle = kResolvedAngle;
    options.resolved = kResolvedReach;
  }
  Creases creases = find_creases(surface, options);
  return std::make_shared<const SharpReference>(SharpReference{ReferenceSurface(std::move(surface), std::move(creases)), std::move(sharp)});
}

SurfaceMaker::SurfaceMaker(const LevelSet& level_set, const PreparedInput& prepared, std::shared_ptr<const SharpReference> reference, bool float32,
                           RepairReport& report, Progress& progress)
    : set_(level_set), prepared_(prepared), reference_(std::move(reference)), float32_(float32), report_(report), progress_(progress) {
  choose_extractor();
}

// [T-SURFACE-1]
void SurfaceMaker::choose_extractor() {
  SurfaceSummary& told = report_.surface;
  const ResolvedOptions& options = report_.options;
  const auto choose = [&](Extractor extractor, std::string why) {
    extractor_ = told.extractor = extractor;
    told.reason = std::move(why);
  };
  if (options.surface != Extractor::automatic) return choose(options.surface, "asked for");
  if (options.max_hole) return choose(Extractor::tetrahedra, "openings are to stay");
  if (options.edge || options.edge_tolerance || options.min_angle) return choose(Extractor::delaunay, "its sizes were asked for");
  told.predicted_facets = predicted_facets(set_, delaunay_options());
  if (told.predicted_facets <= kMostDelaunayFacets)
    return choose(Extractor::delaunay, fmt::format("about {} facets are expected, of {} at most", told.predicted_facets, kMostDelaunayFacets));
  choose(Extractor::tetrahedra, fmt::format("{} facets are expected of Delaunay, which is for {} at most", told.predicted_facets, kMostDelaunayFacets));
}

DelaunayOptions SurfaceMaker::delaunay_options() const {
  const ResolvedOptions& asked = report_.options;
  const double cell = set_.frame.cell;
  DelaunayOptions options;
  if (asked.edge) options.edge = *asked.edge / cell;
  options.distance = asked.edge_tolerance ? std::max(kLeastDistance, *asked.edge_tolerance / cell) : kDistancePerEdge * std::max(1.0, options.edge);
  if (asked.edge_tolerance) options.edge_tolerance = *asked.edge_tolerance / cell;
  if (asked.min_angle) options.min_angle = *asked.min_angle;
  return options;
}

// Creases are looked for along edges that are near to one.
SharpenOptions SurfaceMaker::sharpen_options() const {
  double longest = 0;
  for (const Facet& f : raw_.soup.facets)
    for (std::size_t i = 0; i < 3; ++i) longest = std::max(longest, squared_norm(raw_.soup.points[f[(i + 1) % 3]] - raw_.soup.points[f[i]]));
  SharpenOptions options;
  options.crease_reach = std::max(options.crease_reach, kReachPerEdge * std::sqrt(longest));
  if (float32_) options.written = [frame = set_.frame](const Vec3& p) { return as_float32(frame.to_model(p)); };
  return options;
}

const TriangleSoup& SurfaceMaker::make() {
  if (raw_.soup.facets.empty()) {
    extract();
    if (reference_) sharpen_and_settle();
  }
  if (!sharpening_) return raw_.soup;
  SharpenedSurface sharpened = sharpening_->surface();
  SurfaceSummary& told = report_.surface;
  told.sharpened = true;
  told.points_moved = sharpened.moved;
  told.edges_cut = sharpened.cut;
  told.points_kept = sharpened.kept;
  sharpened_ = std::move(sharpened.soup);
  return sharpened_;
}

void SurfaceMaker::extract() {
  if (extractor_ != Extractor::delaunay || !extract_by_delaunay()) extract_by_tetrahedra();
  if (!field_) field_ = level_set_topology(set_, progress_);
  wanted_ = {field_->surface_components, field_->genus};
  const std::vector<Facet> debris = leave_out_debris(raw_.soup, prepared_, set_.frame);
  report_.actions.debris_dropped = 0;
  if (debris.empty()) return;
  const SurfaceTopology dropped = surface_topology({raw_.soup.points, debris, {}});
  report_.actions.debris_dropped = dropped.components.size();
  wanted_.components -= dropped.components.size();
  wanted_.genus -= dropped.genus.value_or(0);
}

bool SurfaceMaker::extract_by_delaunay() {
  DelaunayOptions options = delaunay_options();
  if (reference_) options.creases = reference_->sharp;
  DelaunaySurface surface = extract_delaunay(set_, options, progress_);
  if (!surface.failure.empty()) {
    use_tetrahedra(surface.failure);
    return false;
  }
  field_ = surface.wanted;
  raw_ = {std::move(surface.soup), {}, 0};
  return true;
}

void SurfaceMaker::extract_by_tetrahedra() { raw_ = extract_surface(set_, {.snap = true, .plain = plain_.marked.empty() ? nullptr : &plain_}, progress_); }

void SurfaceMaker::use_tetrahedra(const std::string& why) {
  extractor_ = report_.surface.extractor = Extractor::tetrahedra;
  report_.surface.reason = "instead of delaunay: " + why;
  report_.warnings.push_back("the Delaunay surface could not be made, and the octree's is the result: " + why);
}

void SurfaceMaker::sharpen_and_settle() {
  std::vector<std::uint8_t> stays;
  for (int round = 0; round < kSharpeningRounds; ++round) {
    sharpening_.emplace(raw_.soup, reference_->surface, stays, sharpen_options(), progress_);
    const std::vector<std::uint32_t> stuck = sharpening_->settle(progress_);
    if (stuck.empty()) return;
    stays.resize(raw_.soup.points.size(), 0);
    mark_with_neighbours(raw_.soup, stuck, stays);
  }
}

bool SurfaceMaker::mend(const std::vector<std::uint32_t>& facets) {
  if (sharpening_) {
    if (++mended_ > kSharpenedRounds || !sharpening_->take_back(facets, progress_)) give_up_sharpening();
    return true;
  }
  if (facets.empty()) return false;
  if (extractor_ == Extractor::delaunay) {
    use_tetrahedra("rounding to the file's precision breaks it");
    raw_ = {};
    return true;
  }
  return leave_unsnapped(facets);
}

void SurfaceMaker::give_up_sharpening() {
  report_.warnings.push_back("creases were not cut into the result: it would have met itself there");
  SurfaceSummary& told = report_.surface;
  told.sharpened = false;
  told.points_moved = told.edges_cut = told.points_kept = 0;
  reference_ = nullptr;
  sharpening_.reset();
  sharpened_ = {};
}

bool SurfaceMaker::leave_unsnapped(const std::vector<std::uint32_t>& facets) {
  if (raw_.origins.empty()) return false;
  std::vector<VertexOrigin> origins;
  for (const std::uint32_t f : facets)
    for (const std::uint32_t v : raw_.soup.facets[f]) origins.push_back(raw_.origins[v]);
  mark_plain(set_.octree(), origins, plain_);
  raw_ = {};
  return true;
}

}  // namespace burnish
