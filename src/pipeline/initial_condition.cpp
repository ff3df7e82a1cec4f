#include "burnish/pipeline/initial_condition.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/io/foam_case.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/winding.h"
#include "burnish/volume/volume_fraction.h"
#include "case_fields.h"
#include "cell_centres.h"
#include "model_units.h"
#include "repaired_surface.h"
#include "solid_field.h"
#include "staged_run.h"

namespace burnish {
namespace {

constexpr double kWhole = 1e-6;       // relative: a volume in the mesh this near to the solid's is all of it
constexpr double kLevelSetCell = 0.5;  // of the level set, in sides of the smallest cell of the mesh that the surface passes through
constexpr double kCoarsened = 1.25;   // by how much a cell that does not fit the memory grows at a time
constexpr int kMostCoarsened = 64;
constexpr std::string_view kFractionDimensions = "[0 0 0 0 0 0 0]", kLengthDimensions = "[0 1 0 0 0 0 0]";

// One run: the stages write into the result as they go.
class InitialConditionRun : StagedRun {
 public:
  InitialConditionRun(const InitialConditionJob& job, Progress& progress) : StagedRun(progress), job_(job) {
    result_.input = job.input;
    result_.case_folder = job.case_folder;
    result_.region = job.region;
    result_.scale = job.scale;
    result_.invert = job.invert;
    method_ = job.method == FractionMethod::automatic ? FractionMethod::exact : job.method;
  }

  ~InitialConditionRun() {
    while (!fields_.empty()) fields_.pop_back();
  }

  InitialConditionResult run() {
    read_case();
    choose_fields();
    if (repair() && meets_mesh()) {
      measure_exactly();
      if (method_ != FractionMethod::exact) measure_by_level_set();
      tell_alpha();
      write();
    }
    clock_.end();
    result_.stages.insert(result_.stages.end(), clock_.stages().begin(), clock_.stages().end());
    for (const auto& field : fields_) result_.fields.push_back(field->told());
    return std::move(result_);
  }

 private:
  void read_case() {
    begin("reading the mesh");
    result_.time = job_.time ? time_folder(job_.case_folder, *job_.time) : start_time_folder(job_.case_folder);
    case_ = read_foam_mesh(job_.case_folder, result_.time, job_.region, progress_);
    const PolyhedralMesh& mesh = case_.mesh;
    faces_ = cell_faces(mesh);
    geometry_ = cell_geometry(mesh, faces_);
    CaseMesh& told = result_.mesh;
    told.folder = case_.folder;
    told.points = mesh.points.size(), told.faces = mesh.faces(), told.internal_faces = mesh.internal_faces(), told.cells = mesh.cells;
    for (const MeshPatch& p : mesh.patches) told.patches.push_back({p.name, p.type, p.faces});
    for (const Box3& box : geometry_.box) told.box.extend(box);
    told.smallest_cell = std::numeric_limits<double>::infinity();
    for (const double v : geometry_.volume) {
      told.volume += v;
      told.smallest_cell = std::min(told.smallest_cell, v), told.largest_cell = std::max(told.largest_cell, v);
      told.inverted_cells += !(v > 0);
    }
    if (told.inverted_cells > 0)
      warn(fmt::format("{} of {} cells have no volume, or a negative one: checkMesh tells which; their fractions are of no value", told.inverted_cells, told.cells));
    std::error_code ignored;
    if (std::filesystem::is_directory(job_.case_folder + "/processor0", ignored))
      warn("the case is decomposed too: decomposePar has to be run again for its parts to see the field");
  }

  void choose_fields() {
    const auto choose = [&](const std::string& name, std::string_view dimensions) {
      fields_.push_back(std::make_unique<CaseFieldFile>(job_, result_.time, name, std::string(dimensions)));
      fields_.back()->conditions_for(case_, result_.warnings);
    };
    choose(job_.field, kFractionDimensions);
    if (!job_.phi.empty()) choose(job_.phi, kLengthDimensions);
    fields_.front()->set_values(job_.patch_values, case_.mesh.patches);
  }

  bool repair() {
    clock_.end();
    result_.stages = clock_.stages();
    clock_ = {};
    CleanJob job;
    job.input = job_.input, job.salvage = job_.salvage, job.options = job_.options;
    if (method_ != FractionMethod::exact) job.options.cell.reset();  // the level set is another one
    RepairedSurface repaired = repaired_surface(job, progress_);
    RepairReport& report = repaired.report;
    surface_ = std::move(repaired.surface);
    result_.input_format = report.input_format;
    result_.warnings.insert(result_.warnings.end(), report.warnings.begin(), report.warnings.end());
    result_.options = report.options;
    result_.before = report.before;
    result_.failure = std::move(report.failure);
    result_.stages.insert(result_.stages.end(), report.stages.begin(), report.stages.end());
    if (result_.failure) return false;
    if (job_.scale != 1) parallel_for(surface_.points.size(), [&](std::size_t i) { surface_.points[i] *= job_.scale; });
    result_.solid = {surface_.facets.size(), signed_volume(surface_), area(surface_), bounding_box(surface_), report.method, report.method_reason};
    return true;
  }

  bool meets_mesh() {
    const UnitsCheck units = check_units(result_.solid.box, result_.mesh.box, job_.scale);
    result_.failure = units.failure;
    if (!units.warning.empty()) warn(units.warning);
    return !result_.failure;
  }

  void measure_exactly() {
    begin("volume fractions");
    fractions_ = exact_volume_fractions(case_.mesh, geometry_, faces_, surface_, progress_);
    FractionSummary& told = result_.alpha;
    const double solid = result_.solid.volume;
    told.in_mesh = fractions_.volume;
    if (std::abs(fractions_.volume - solid) <= kWhole * solid) told.difference = fractions_.volume - solid;
    if (!(fractions_.volume > 0)) warn("none of the model's volume is in the mesh, though their boxes meet: all fractions are 0");
  }

  // The cell that was asked for, or what suits the smallest cell that the surface passes through.
  double level_set_cell(double& reach) {
    double smallest = std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < fractions_.alpha.size(); ++c) {
      if (!(fractions_.alpha[c] > 0 && fractions_.alpha[c] < 1 && geometry_.volume[c] > 0)) continue;
      smallest = std::min(smallest, geometry_.volume[c]);
      reach = std::max(reach, geometry_.box[c].diagonal());
    }
    if (job_.options.cell) return job_.scale * job_.options.cell->in_model_units(result_.before.box.diagonal(), 1);
    double cell = kLevelSetCell * std::cbrt(smallest);
    const double wanted = cell;
    // What facets take alone does not shrink with the cells.
    for (int step = 0; step < kMostCoarsened && solid_level_set_bytes(surface_, cell, reach) > job_.options.memory_bytes; ++step) cell *= kCoarsened;
    if (cell > wanted) warn(fmt::format("the level set has cells of {:.4g}, not of {:.4g}, to stay within the memory budget: raise --memory", cell, wanted));
    return cell;
  }

  void measure_by_level_set() {
    if (fractions_.mixed == 0) return;
    begin("distances and signs");
    double reach = 0;
    result_.alpha.cell = level_set_cell(reach);
    if (!(reach > 0)) return;  // all cells that the surface passes through are inverted: the exact fractions stay
    if (const std::uint64_t bytes = solid_level_set_bytes(surface_, result_.alpha.cell, reach); bytes > job_.options.memory_bytes)
      throw Error(ErrorCode::memory_limit, fmt::format("a level set with cells of {:.4g} takes about {:.1f} GB; the budget is {:.1f} GB", result_.alpha.cell, static_cast<double>(bytes) * 0x1p-30,
                                                       static_cast<double>(job_.options.memory_bytes) * 0x1p-30),
                  "choose a larger --cell, or raise --memory");
    const SolidLevelSet solid = solid_level_set(surface_, result_.alpha.cell, reach, progress_);
    begin("cutting cells");
    fractions_ = method_ == FractionMethod::linear ? linear_volume_fractions(case_.mesh, geometry_, faces_, solid.field, {}, progress_)
                                                   : curved_volume_fractions(case_.mesh, geometry_, faces_, solid.field, {}, progress_);
    result_.alpha.difference = fractions_.volume - result_.alpha.in_mesh;
  }

  void tell_alpha() {
    FractionSummary& told = result_.alpha;
    told.method = method_;
    told.mixed = fractions_.mixed, told.clamped = fractions_.clamped, told.worst_clamp = fractions_.worst_clamp;
    if (job_.invert) parallel_for(fractions_.alpha.size(), [&](std::size_t c) { fractions_.alpha[c] = 1 - fractions_.alpha[c]; });
    const auto [least, most] = std::minmax_element(fractions_.alpha.begin(), fractions_.alpha.end());
    told.min = *least, told.max = *most;
    told.volume = job_.invert ? result_.mesh.volume - fractions_.volume : fractions_.volume;
  }

  // [T-CONV-1] Positive in the phase.
  std::vector<double> signed_distances() const {
    const std::vector<Vec3> centres = cell_centres(case_.mesh, faces_);
    const std::vector<std::int32_t> windings = winding_numbers(surface_, centres);
    const TriangleIndex index(surface_);
    std::vector<double> phi(centres.size());
    parallel_for(phi.size(), [&](std::size_t c) {
      const double distance = std::sqrt(index.closest(centres[c]).squared_distance);
      phi[c] = (windings[c] != 0) != job_.invert ? distance : -distance;
    });
    return phi;
  }

  void write() {
    if (job_.dry_run) return;
    if (fields_.size() > 1) {
      begin("distances at the cells");
      const std::vector<double> phi = signed_distances();
      fields_.back()->write(phi);
    }
    begin("writing");
    fields_.front()->write(fractions_.alpha);
    CaseFieldFile::publish(fields_);
  }

  void warn(std::string text) { result_.warnings.push_back(std::move(text)); }

  const InitialConditionJob& job_;
  FractionMethod method_ = FractionMethod::exact;
  InitialConditionResult result_;
  FoamMesh case_;
  CellFaces faces_;
  CellGeometry geometry_;
  std::vector<std::unique_ptr<CaseFieldFile>> fields_;  // the first one has made the folder, and goes last
  TriangleSoup surface_;  // repaired, in the mesh's unit
  VolumeFractions fractions_;
};

}  // namespace

std::string_view name(FractionMethod method) {
  constexpr std::array<std::string_view, 4> kNames{"auto", "exact", "linear", "curved"};
  return kNames[static_cast<std::size_t>(method)];
}

InitialConditionResult initial_condition(const InitialConditionJob& job, Progress& progress) { return InitialConditionRun(job, progress).run(); }

}  // namespace burnish
