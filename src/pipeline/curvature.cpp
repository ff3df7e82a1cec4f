#include "burnish/pipeline/curvature.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/extract/marching_tetrahedra.h"
#include "burnish/levelset/redistance.h"
#include "burnish/levelset/smooth/smoothing.h"
#include "burnish/surface/compare.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/validate.h"
#include "burnish/surface/weld.h"
#include "curvature_summary.h"
#include "level_set_gear.h"
#include "prepare_input.h"
#include "resolve_options.h"
#include "solid_run.h"
#include "viewer_file.h"

namespace burnish {
namespace {

constexpr double kCellsPerEdge = 0.5;  // of the input: where edges are longer, unsmoothed curvature is that of single edges
constexpr double kManyUndetermined = 0.02;
constexpr double kMostUndetermined = 0.05;  // where more is missing, so is what an integral would be judged by
constexpr double kFarOff = 0.1;        // of a ball's integral of Gaussian curvature
constexpr double kLossCells = 1.5;     // and half the smoothing length: components all of whose points are farther from the surface are lost
constexpr int kMostProjections = 12;
constexpr double kProjected = 0.1;     // cells: from here front_curvature finds the foot
constexpr double kUnprojected = 1;     // cells: where no steps come nearer, there is no surface within reach
constexpr double kFlattest = 0.5;      // |grad phi|: on ridges of the distance steps are not to be trusted
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

// The points that facets use, and the facets, renumbered.
TriangleSoup compacted(const TriangleSoup& soup) {
  TriangleSoup result{{}, soup.facets, {}};
  std::vector<std::uint32_t> place(soup.points.size(), kNoFacet);
  for (Facet& facet : result.facets)
    for (std::uint32_t& p : facet) {
      if (place[p] == kNoFacet) {
        place[p] = static_cast<std::uint32_t>(result.points.size());
        result.points.push_back(soup.points[p]);
      }
      p = place[p];
    }
  return result;
}

// [T-GAUSS-1] The point (in lattice units) moved to the surface along phi; where it comes to rest off it, there is none near.
Vec3 projected(const LevelSet& set, Vec3 x) {
  const auto phi = [&](const Vec3& p) { return sample(set.octree(), set.phi, p.x, p.y, p.z); };
  for (int step = 0; step < kMostProjections; ++step) {
    const double value = phi(x);
    if (std::abs(value) < kProjected) break;
    const Vec3 g{phi(x + Vec3{0.5, 0, 0}) - phi(x - Vec3{0.5, 0, 0}), phi(x + Vec3{0, 0.5, 0}) - phi(x - Vec3{0, 0.5, 0}),
                 phi(x + Vec3{0, 0, 0.5}) - phi(x - Vec3{0, 0, 0.5})};
    x -= g * (value / std::max(squared_norm(g), kFlattest * kFlattest));
  }
  return x;
}

// One run: the stages write into the result as they go.
class CurvatureRun : SolidRun {
 public:
  CurvatureRun(const CurvatureJob& job, Progress& progress) : SolidRun(job.input, progress), job_(job) {
    if (job.method == CurvatureMethod::nodal && job.check > 0)
      throw Error(ErrorCode::usage, "nodal curvatures have no k1 and k2 to be checked", "leave one of the two out");
    if (job.method == CurvatureMethod::nodal && job.order == CurvatureOrder::sixth)
      throw Error(ErrorCode::usage, "nodal curvatures are of order 2 or 4", "give --order 4, or leave --method out");
    result_.input = job.input;
    result_.order = job.order, result_.at = job.at, result_.method = job.method;
    result_.output.file = job.output;
    if (job.output.empty()) return;
    file_.emplace(job.output, job.overwrite);
    result_.output.format = file_->format() == MarkedFormat::vtp ? ".vtp" : ".ply";
  }

  CurvatureResult run() {
    read(job_.salvage, job_.options);
    if (prepare(job_.options)) {
      build();
      if (report_.options.smooth > 0) smooth();
      find_surface();
      if (!surface_.facets.empty()) {
        tell_losses();
        measure();
        if (file_) write();
      }
    }
    return finish();
  }

 private:
  void build() {
    begin("distances and signs");
    if (report_.options.max_hole) close_sheet(prepared_, job_.options, report_);
    const double band = curvature_band(job_.order);
    resolve_cell(job_.options, prepared_.capped, report_.options, report_.warnings, band);
    const double smooth_cells = report_.options.smooth / report_.options.cell;
    LevelSetOptions set{.band = band, .room = 0, .far_field = false};
    if (smooth_cells > 0) set.band = std::max(kFlowBand, band), set.room = room_for_smoothing(FlowMode::mcf, smooth_cells);
    built_ = build_level_set(prepared_, set, report_, progress_);
    result_.band = set.band;
  }

  // The flow keeps distances as far as it needs them itself, and ends with a shift.
  void smooth() {
    begin("smoothing");
    SmoothingPlan plan;
    plan.mode = SmoothMode::mcf;
    smooth_level_set(built_.level_set, plan, report_, progress_);
    RedistanceOptions options;
    options.method = report_.options.redistance;
    options.reach = built_.level_set.band;
    // The input's vertices have to find the surface from where it was.
    if (job_.at == CurvaturePoints::vertices) options.reach += room_for_smoothing(FlowMode::mcf, report_.options.smooth / report_.options.cell);
    reach_ = options.reach;
    redistance(built_.level_set, options, progress_);
  }

  // In lattice units.
  void find_surface() {
    begin("extracting");
    extracted_ = extract_surface(built_.level_set, {}, progress_).soup;
    const std::vector<Facet> debris = leave_out_debris(extracted_, prepared_, built_.level_set.frame);
    if (!debris.empty() && job_.at == CurvaturePoints::surface)
      report_.warnings.push_back(fmt::format("{} small pieces that stand for no component of the input were left out",
                                             surface_topology({extracted_.points, debris, {}}).components.size()));
    extracted_ = compacted(extracted_);
    if (!extracted_.facets.empty()) surface_ = job_.at == CurvaturePoints::surface ? extracted_ : compacted(facets_on_surface());
    if (surface_.facets.empty())
      report_.failure = Error(ErrorCode::guarantee_unmet, report_.options.smooth > 0 ? "no solid: smoothing left nothing of the model"
                                                                                    : "no solid: nothing of the input bounds a volume that cells of this size can hold",
                              report_.options.smooth > 0 ? "choose a smaller --smooth" : "choose a smaller --cell");
  }

  // The input's own, without what closes openings and what is inside.
  TriangleSoup facets_on_surface() const {
    TriangleSoup soup{prepared_.capped.soup.points, {}, {}};
    for (const std::uint32_t f : built_.facets)
      if (f < prepared_.capped.first_cap_facet && built_.roles[f] == FacetRole::boundary) soup.facets.push_back(prepared_.capped.soup.facets[f]);
    return to_lattice(soup, built_.level_set.frame);
  }

  // What the input has and the surface has nothing of. Of a single component that surface is.
  void tell_losses() {
    if (report_.before.components < 2) return;
    const ResolvedOptions& options = report_.options;
    parallel_for(extracted_.points.size(), [&](std::size_t i) { extracted_.points[i] = built_.level_set.frame.to_model(extracted_.points[i]); });
    const MissingComponents missing = missing_components(wanted(), TriangleIndex(extracted_), kLossCells * options.cell + 0.5 * options.smooth);
    if (missing.count > 0)
      report_.warnings.push_back(fmt::format("{} of the input's components ({:.3g} of area) are not in the surface, being thinner than a cell or smaller than "
                                             "the smoothing length; the largest is at ({:.6g}, {:.6g}, {:.6g})",
                                             missing.count, missing.area, missing.largest_at.x, missing.largest_at.y, missing.largest_at.z));
  }

  // The input without what preparation dropped, and what is inside.
  TriangleSoup wanted() const {
    std::vector<char> inside(input_.facets.size(), 0);
    for (std::size_t f = 0; f < prepared_.source.size(); ++f) inside[prepared_.source[f]] = built_.roles[f] == FacetRole::interior;
    TriangleSoup soup{input_.points, {}, {}};
    for (std::size_t f = 0; f < input_.facets.size(); ++f)
      if (prepared_.fates[f] == FacetFate::sheet || (prepared_.fates[f] == FacetFate::used && !inside[f])) soup.facets.push_back(input_.facets[f]);
    return soup;
  }

  void measure() {
    begin("curvatures");
    const LevelSet& set = built_.level_set;
    const bool mean_only = job_.method == CurvatureMethod::nodal;
    starts_ = surface_.points;
    if (job_.at == CurvaturePoints::vertices && report_.options.smooth > 0)
      parallel_for(starts_.size(), [&](std::size_t i) { starts_[i] = projected(set, starts_[i]); });
    at_ = mean_only ? interpolated_nodal() : front_curvature(set, starts_, job_.order, progress_);
    const std::size_t far = leave_out_far();
    if (job_.check > 0) cross_check();
    parallel_for(surface_.points.size(), [&](std::size_t i) { surface_.points[i] = set.frame.to_model(surface_.points[i]); });
    result_.curvature = summarize_curvature(surface_, at_, set.frame.cell, job_.order, job_.at, mean_only);
    result_.curvature.mean_edge = report_.before.mean_edge;
    warn(far);
  }

  // Of the vertices that could not be projected; how many.
  std::size_t leave_out_far() {
    if (job_.at == CurvaturePoints::surface || !(report_.options.smooth > 0)) return 0;
    std::size_t far = 0;
    for (std::size_t i = 0; i < starts_.size(); ++i) {
      const Vec3& p = starts_[i];
      if (std::abs(sample(built_.level_set.octree(), built_.level_set.phi, p.x, p.y, p.z)) < kUnprojected) continue;
      at_[i].converged = false;
      ++far;
    }
    return far;
  }

  // At points as evenly spread through the list as can be.
  void cross_check() {
    const LevelSet& set = built_.level_set;
    const std::size_t all = surface_.points.size(), count = std::min(job_.check, all);
    std::vector<Vec3> points(count);
    std::vector<FrontCurvature> found(count);
    for (std::size_t i = 0; i < count; ++i) points[i] = starts_[i * all / count], found[i] = at_[i * all / count];
    const std::vector<FrontCurvature> fitted = quadric_curvature(set, points, progress_);
    for (Vec3& p : points) p = set.frame.to_model(p);
    result_.check = compare_curvatures(points, found, fitted, set.frame.cell);
  }

  // Half of k1 + k2 in both, so that their mean is right.
  std::vector<FrontCurvature> interpolated_nodal() {
    const LevelSet& set = built_.level_set;
    const Field<float> sums = nodal_curvature(set, job_.order, progress_);
    std::vector<FrontCurvature> at(surface_.points.size());
    parallel_for(at.size(), [&](std::size_t i) {
      const Vec3& p = starts_[i];
      at[i].k1 = at[i].k2 = 0.5 * sample(set.octree(), sums, p.x, p.y, p.z);
      at[i].order = static_cast<int>(job_.order);
      at[i].converged = true;
    });
    return at;
  }

  void warn(std::size_t far) {
    const CurvatureSummary& c = result_.curvature;
    const double cells_per_edge = c.mean_edge / report_.options.cell;
    if (!(report_.options.smooth > 0) && cells_per_edge > kCellsPerEdge)
      report_.warnings.push_back(fmt::format("the surface is made of flat facets, {:.3g} cells per mean edge: its curvature sits on their edges; "
                                             "--smooth L, with L of a few edges ({:.3g}), gives that of the shape they stand for",
                                             cells_per_edge, 4 * c.mean_edge));
    if (far > 0)
      report_.warnings.push_back(fmt::format("smoothing moved the surface away from {} of {} points, by {:.3g} or more, or left nothing of it there: they have no "
                                             "curvature; a smaller --smooth keeps it nearer",
                                             far, c.points, reach_ * report_.options.cell));
    const double undetermined = c.determined_area ? (c.area > 0 ? 1 - *c.determined_area / c.area : 0)
                                                  : static_cast<double>(c.points - c.determined - far) / static_cast<double>(c.points);
    if (undetermined > kManyUndetermined)
      report_.warnings.push_back(fmt::format("{:.3g} % of the {} no curvature: edges and corners, or details of the size of a cell", 100 * undetermined,
                                             c.determined_area ? "surface has" : "points have"));
    if (undetermined <= kMostUndetermined) warn_of_integral();
  }

  // [T-GAUSS-1] What is lost or found of the integral has been at edges.
  void warn_of_integral() {
    const CurvatureSummary& c = result_.curvature;
    if (!c.gaussian_integral || !c.euler_characteristic) return;
    const double due = 2 * std::numbers::pi * static_cast<double>(*c.euler_characteristic), off = *c.gaussian_integral - due;
    if (std::abs(off) > kFarOff * std::max(4 * std::numbers::pi, std::abs(due)))
      report_.warnings.push_back(fmt::format("the integral of k1 k2 is {:.4g}, and {:.4g} for any surface like this one: edges or details are not resolved; "
                                             "choose a smaller --cell, or smooth them",
                                             *c.gaussian_integral, due));
  }

  template <class Value>
  PointArray array_of(const char* name, int components, Value&& value) const {
    PointArray array{name, std::vector<double>(at_.size() * static_cast<std::size_t>(components)), components};
    parallel_for(at_.size(), [&](std::size_t i) {
      for (int c = 0; c < components; ++c)
        array.values[i * static_cast<std::size_t>(components) + static_cast<std::size_t>(c)] = at_[i].converged ? value(at_[i], c) : kNoNumber;
    });
    return array;
  }

  std::vector<PointArray> arrays() const {
    const double h = report_.options.cell;
    std::vector<PointArray> arrays;
    arrays.push_back(array_of(file_->format() == MarkedFormat::ply ? "quality" : "mean_curvature", 1, [h](const FrontCurvature& c, int) { return c.mean() / h; }));
    if (job_.method == CurvatureMethod::front) {
      arrays.push_back(array_of("gaussian_curvature", 1, [h](const FrontCurvature& c, int) { return c.gaussian() / (h * h); }));
      arrays.push_back(array_of("k1", 1, [h](const FrontCurvature& c, int) { return c.k1 / h; }));
      arrays.push_back(array_of("k2", 1, [h](const FrontCurvature& c, int) { return c.k2 / h; }));
      arrays.push_back(array_of("direction1", 3, [](const FrontCurvature& c, int i) { return c.direction1[i]; }));
      arrays.push_back(array_of("direction2", 3, [](const FrontCurvature& c, int i) { return c.direction2[i]; }));
      arrays.push_back(array_of("normal", 3, [](const FrontCurvature& c, int i) { return c.normal[i]; }));
    }
    PointArray converged{"converged", std::vector<double>(at_.size())};
    std::transform(at_.begin(), at_.end(), converged.values.begin(), [](const FrontCurvature& c) { return c.converged ? 1.0 : 0.0; });
    arrays.push_back(std::move(converged));
    return arrays;
  }

  void write() {
    begin("writing");
    const CurvatureSpread& mean = result_.curvature.mean;
    PointData data{surface_, arrays(), {"quality is the mean curvature in 1 / model unit, positive where the solid is convex; converged 0: there is none"}};
    // A few extremes at edges would leave no colour for the rest.
    data.color_range = std::max(std::abs(mean.percentiles.front()), std::abs(mean.percentiles.back()));
    result_.output.bytes = file_->write(data);
    result_.output.written = true;
  }

  CurvatureResult finish() {
    clock_.end();
    result_.input_format = report_.input_format;
    result_.unit = report_.unit;
    result_.warnings = std::move(report_.warnings);
    result_.options = report_.options;
    result_.before = report_.before;
    result_.grid = report_.grid;
    result_.smoothing = report_.smoothing;
    result_.failure = std::move(report_.failure);
    result_.stages = clock_.stages();
    return std::move(result_);
  }

  const CurvatureJob& job_;
  std::optional<ViewerFile> file_;
  CurvatureResult result_;
  BuiltLevelSet built_;
  double reach_ = 0;           // cells from the smoothed surface to where phi is still a distance
  TriangleSoup extracted_;     // the surface of the level set, as the next one
  TriangleSoup surface_;       // whose points are looked at: in lattice units, then in the model's
  std::vector<Vec3> starts_;   // these, or what they are projected to; in lattice units
  std::vector<FrontCurvature> at_;
};

}  // namespace

std::string_view name(CurvaturePoints points) { return points == CurvaturePoints::surface ? "surface" : "vertices"; }
std::string_view name(CurvatureMethod method) { return method == CurvatureMethod::front ? "front" : "nodal"; }

CurvatureResult curvature(const CurvatureJob& job, Progress& progress) { return CurvatureRun(job, progress).run(); }

}  // namespace burnish
