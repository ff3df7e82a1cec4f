#include "burnish/pipeline/flow_mesh_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "burnish/core/parallel.h"
#include "flow_mesh_cells.h"
#include "flow_mesh_measure.h"
#include "flow_mesh_patches.h"
#include "repaired_surface.h"

namespace burnish {
namespace {

constexpr double kSmallestGuess = 1.0 / 16;  // of the first guess at a cell, before it is given up
constexpr double kRepairCell = 0.5;       // of a level set, in cells of the mesh
constexpr double kCellsAcross = 4;        // of a wall's thickness, that a mesh shows well
constexpr double kWithinRoom = 1 - 1e-9;  // against rounding
constexpr double kBytesPerCell = 1000;    // of a mesh while it is made
constexpr double kGigabyte = 0x1p30;

constexpr double kDefaultThickness = 0.5; // of layers, in cells

// 1 + ratio + ratio^2 ..., `count` of them.
double sum_of_heights(int count, double ratio) {
  double sum = 0, height = 1;
  for (int k = 0; k < count; ++k) sum += height, height *= ratio;
  return sum;
}

std::string_view name(VolumeFormat format) {
  constexpr std::string_view kNames[] = {"OpenFOAM case", "VTU", "Gmsh", "SU2", "CGNS"};
  return kNames[static_cast<std::size_t>(format)];
}

class FlowMeshRun {
 public:
  FlowMeshRun(const FlowMeshJob& job, Progress& progress) : job_(job), progress_(progress) {
    result_.input = job.input;
    result_.output = job.output;
    if (!job.output.empty()) result_.output_format = name(volume_format(job.output));
    result_.side = job.side;
    result_.flavour = job.flavour;
    result_.cells_wanted = job.cells;
  }

  FlowMeshResult run() {
    if (!job_.output.empty()) require_writable(job_.output, job_.write);
    require_one_type_each(job_.patch_types);
    if (repair() && mesh()) {
      measure();
      write();
    }
    end_stages();
    result_.cost.peak_bytes = process_peak_bytes();
    return std::move(result_);
  }

 private:
  void begin(const std::string& stage) {
    progress_.check();
    clock_.begin(stage);
    progress_.begin_stage(stage);
  }

  void end_stages() {
    clock_.end();
    result_.stages.insert(result_.stages.end(), clock_.stages().begin(), clock_.stages().end());
    clock_ = {};
  }

  // --- the surface

  // Half of the mesh's cell, as far as that is known before the model is.
  Length repair_cell() const {
    if (job_.cell) return Length{kRepairCell * job_.cell->value, job_.cell->unit};
    // The diagonal is at most sqrt(3) longest sides.
    return Length{kRepairCell * 100 / (kMeshCellsAlongLongestSide * std::sqrt(3.0)), LengthUnit::percent_of_diagonal};
  }

  bool repair() {
    CleanJob job;
    job.input = job_.input, job.salvage = job_.salvage, job.options = job_.options;
    job.options.default_cell = repair_cell();
    if (!repair(job)) return false;
    if (!job_.cells || job.options.cell || job.options.resolution || result_.solid.cell == 0) return true;
    // The number of cells says how fine they are only now.
    const double wanted = kRepairCell * std::sqrt(result_.solid.area * kCellsPerArea / static_cast<double>(*job_.cells));
    if (result_.solid.cell <= wanted || job.input == "-") return true;
    job.options.default_cell = Length{wanted, LengthUnit::model};
    result_.warnings.clear();
    return repair(job);
  }

  bool repair(const CleanJob& job) {
    RepairedSurface repaired = repaired_surface(job, progress_, true);
    RepairReport& report = repaired.report;
    surface_ = std::move(repaired.surface);
    result_.input_format = report.input_format;
    result_.unit = report.unit;
    result_.warnings.insert(result_.warnings.end(), report.warnings.begin(), report.warnings.end());
    result_.failure = std::move(report.failure);
    result_.stages.insert(result_.stages.end(), report.stages.begin(), report.stages.end());
    if (result_.failure) return false;
    const TopologySummary& topology = report.surface.topology;
    result_.solid = {surface_.facets.size(), topology.components, topology.cavities, signed_volume(surface_), area(surface_), bounding_box(surface_), report.method, report.method_reason,
                     report.options.cell};
    return true;
  }

  // --- the mesh

  double length(const Length& l, double cell) const { return l.in_model_units(result_.solid.box.diagonal(), cell); }

  Box3 domain() const {
    const Box3& solid = result_.solid.box;
    if (job_.domain.box) return *job_.domain.box;
    const double margin = job_.domain.margin ? length(*job_.domain.margin, 0) : solid.longest_side();
    const Vec3 around{margin, margin, margin};
    return {solid.lower - around, solid.upper + around};
  }

  WallLayers layers(double cell) const {
    const LayersWanted& wanted = job_.layers;
    const double whole = sum_of_heights(wanted.count, wanted.ratio);
    return {wanted.count, wanted.first ? length(*wanted.first, cell) : kDefaultThickness * cell / std::max(1.0, whole), wanted.ratio};
  }

  // In cells.
  double thickness_of_layers(double cell) const {
    const WallLayers wanted = layers(cell);
    return wanted.first * sum_of_heights(wanted.count, wanted.ratio) / cell;
  }

  // What no mesh can make room for.
  std::optional<Error> layers_too_thick(double cell) const {
    const double thickness = thickness_of_layers(cell);
    if (thickness <= kThickestLayers) return std::nullopt;
    return Error(ErrorCode::usage, fmt::format("the layers are {:.3g} cells thick together, where cells are {:.4g}; at most {} have room", thickness, cell, kThickestLayers),
                 fmt::format("give fewer --layers or a smaller --first, or {}", job_.cells ? "a smaller number of --cells" : "a larger --cell"));
  }

  // What was asked for; warns of cells that checkMesh will not have.
  void tell_layers_wanted(double cell) {
    const WallLayers wanted = layers(cell);
    if (wanted.count == 0) return;
    result_.layers = {wanted.count, wanted.first, wanted.ratio, thickness_of_layers(cell) * cell, 0, 0, 0};
    if (wanted.first < kFlattestLayer * cell)
      result_.warnings.push_back(fmt::format("layers of {:.2g} cells height: checkMesh -allGeometry takes cells flatter than {} for badly shaped; they will be missing in places", wanted.first / cell, kFlattestLayer));
  }

  FlowMeshOptions mesh_options(double cell) const {
    FlowMeshOptions options;
    options.cell = cell;
    options.side = job_.side;
    options.flavour = job_.flavour;
    options.coarsest_level = job_.coarsest_level;
    options.flat_levels = job_.flat_levels;
    options.flat_angle = job_.flat_angle;
    options.cells_between_levels = job_.cells_between_levels;
    options.crease_angle = job_.crease_angle;
    options.layers = layers(cell);
    // On the way to a number of cells, layers that have no room are as thick as they can be.
    options.layers.first *= std::min(1.0, kThickestLayers / std::max(kThickestLayers, thickness_of_layers(cell)));
    options.memory_bytes = job_.options.memory_bytes;
    if (job_.side == MeshSide::outside) options.domain = domain();
    for (const BoxWithCell& r : job_.refinements) options.refinements.push_back({r.box, length(r.cell, cell)});
    return options;
  }

  bool mesh() {
    patches_ = surface_patches(surface_, job_.one_patch, job_.side);
    require_patches_of_types();
    if (!(job_.cells ? mesh_of_number() : mesh_of_cell())) return false;
    tell_layers_wanted(result_.cell);
    return true;
  }

  // Before the work: what the patches will be called is known.
  void require_patches_of_types() const {
    std::vector<MeshPatch> patches;
    for (const std::string& name : patches_.names) patches.push_back({name, "wall"});
    if (job_.side == MeshSide::outside)
      for (const std::string_view name : kDomainPatches) patches.push_back({std::string(name), "patch"});
    set_patch_types(job_.patch_types, patches);
  }

  bool mesh_of_cell() {
    result_.cell_was_chosen = !job_.cell;
    const double cell = job_.cell ? length(*job_.cell, 0) : result_.solid.box.longest_side() / kMeshCellsAlongLongestSide;
    if (const std::optional<Error> error = layers_too_thick(cell)) throw *error;
    return mesh(cell);
  }

  // The number of cells is met; layers are judged by the cells that it took.
  bool mesh_of_number() {
    require_memory_for_number();
    CellChooser chooser(*job_.cells, result_.solid.area);
    result_.cell_was_chosen = true;
    const bool meshed = try_cells(chooser);
    result_.trials = chooser.trials();
    if (meshed) result_.failure = layers_too_thick(result_.cell);
    return meshed && !result_.failure;
  }

  // Leaves the last mesh of the trials; false if there is none.
  bool try_cells(CellChooser& chooser) {
    double smaller = 1;
    const double largest = largest_cell_of_domain();
    while (const std::optional<double> next = chooser.next()) {
      const double cell = std::min(*next * smaller, largest);
      const bool is_first = chooser.trials().empty();
      if (!is_first && cell == chooser.trials().back().cell) {
        result_.warnings.push_back(fmt::format("the domain is near the model: cells larger than {:.4g} have no room there, and with these there are more than {}", largest, *job_.cells));
        break;
      }
      flow_ = {};
      if (is_first ? mesh(cell) : mesh_within_memory(cell)) {
        chooser.learn(cell, flow_.mesh.cells());
        smaller = 1;
        continue;
      }
      // The first guess knows the surface's area alone: a plate may be thinner than such a cell.
      if (!is_first) return mesh_again(chooser);
      if (smaller < kSmallestGuess) return false;
      result_.failure.reset();
      smaller /= 2;
    }
    return true;
  }

  // False, and told, where there is no room for it: there is a smaller mesh.
  bool mesh_within_memory(double cell) {
    try {
      return mesh(cell);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::memory_limit) throw;
      result_.warnings.push_back(fmt::format("no more cells fit into memory on the way to {}: {}; raise --memory", *job_.cells, error.what()));
      return false;
    }
  }

  // Four of them fit between the model and the domain's nearest side. A domain that cuts the model is told of by the mesher.
  double largest_cell_of_domain() const {
    if (job_.side == MeshSide::inside) return std::numeric_limits<double>::infinity();
    const Box3 box = domain();
    const Vec3 below = result_.solid.box.lower - box.lower, above = box.upper - result_.solid.box.upper;
    const double room = std::min({below.x, below.y, below.z, above.x, above.y, above.z});
    return room > 0 ? kWithinRoom * room / kLeastRoom : std::numeric_limits<double>::infinity();
  }

  // So few cells hold nothing, or so many do not fit: the last mesh that there was counts.
  bool mesh_again(const CellChooser& chooser) {
    result_.failure.reset();
    return mesh(chooser.trials().back().cell);
  }

  void require_memory_for_number() const {
    const double needed = kBytesPerCell * static_cast<double>(*job_.cells), budget = static_cast<double>(job_.options.memory_bytes);
    if (needed > budget)
      throw Error(ErrorCode::memory_limit, fmt::format("{} cells need about {:.1f} GB; the budget is {:.1f} GB", *job_.cells, needed / kGigabyte, budget / kGigabyte),
                  fmt::format("ask for at most {:.2g} cells, or raise --memory", budget / kBytesPerCell));
  }

  // False if there is nothing: the failure says why.
  bool mesh(double cell) {
    result_.cell = cell;
    result_.cells_along_longest_side = result_.solid.box.longest_side() / cell;
    begin("meshing");
    const double start = process_cpu_seconds();
    try {
      flow_ = flow_mesh(surface_, patches_.of_facet, patches_.names, mesh_options(cell), progress_);
    } catch (const Error& error) {
      if (error.code() == ErrorCode::memory_limit && job_.cells && error.hint().find("--cell ") != std::string::npos)
        throw Error(error.code(), error.what(), "ask for fewer --cells, or larger cells in boxes, or raise --memory");
      if (error.code() != ErrorCode::guarantee_unmet) throw;
      result_.failure = Error(error.code(), error.what(), way_out_of_large_cell());
      return false;
    }
    result_.cost.seconds = process_cpu_seconds() - start;
    return true;
  }

  // Twice the volume over the area is the thickness of a plate.
  std::string way_out_of_large_cell() const {
    return fmt::format("choose a smaller --cell, such as {:.4g}: the model's mean thickness is {:.4g}", 2 * result_.solid.volume / result_.solid.area / kCellsAcross,
                       2 * result_.solid.volume / result_.solid.area);
  }

  void measure() {
    MeshCost& cost = result_.cost;
    cost.cells_per_second = cost.seconds > 0 ? static_cast<double>(flow_.mesh.cells()) / cost.seconds : 0;
    set_patch_types(job_.patch_types, flow_.mesh.mesh.patches);
    begin("measuring distances");
    tell_mesh(flow_, patches_, domain(), result_);
    compare_patches(flow_.mesh, patches_, surface_, result_);
    begin("measuring the quality");
    // What is judged is what is written.
    std::vector<Vec3>& points = flow_.mesh.mesh.points;
    if (job_.scale != 1) parallel_for(points.size(), [&](std::size_t p) { points[p] *= job_.scale; });
    judge_quality(flow_.mesh, job_.scale, result_, progress_);
    if (!result_.good) result_.failure = reason_of_failure(result_);
  }

  // What keeps the mesh from being written is told with the mesh: measuring it was not for nothing.
  void write() {
    if (job_.output.empty() || (result_.failure && !job_.allow_invalid)) return;
    begin("writing");
    try {
      write_volume_mesh(job_.output, flow_.mesh, job_.write, progress_);
      result_.written = true;
    } catch (const Error& error) {
      if (error.code() == ErrorCode::interrupted || error.code() == ErrorCode::bug) throw;
      result_.failure = error;
    }
  }

  const FlowMeshJob& job_;
  Progress& progress_;
  StageClock clock_;
  FlowMeshResult result_;
  TriangleSoup surface_;  // repaired, with the input's groups
  SurfacePatches patches_;
  FlowMesh flow_;
};

}  // namespace

std::string_view name(MeshSide side) { return side == MeshSide::inside ? "inside" : "outside"; }
std::string_view name(MeshFlavour flavour) { return flavour == MeshFlavour::conforming ? "conforming" : "polyhedral"; }

FlowMeshResult flow_mesh(const FlowMeshJob& job, Progress& progress) { return FlowMeshRun(job, progress).run(); }

}  // namespace burnish
