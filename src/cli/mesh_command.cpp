#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/core/timer.h"
#include "burnish/pipeline/flow_mesh_job.h"
#include "clean_options.h"
#include "commands.h"
#include "console.h"
#include "made_folders.h"
#include "mesh_summary.h"
#include "outcome.h"
#include "report_file.h"
#include "shared_rows.h"
#include "suffixes.h"
#include "values.h"

namespace burnish {
namespace {

constexpr std::string_view kNotes =
    R"(IN is repaired as 'burnish IN' does; what is inside of it, or around it, is
filled with hexahedra, and with tetrahedra, pyramids and wedges at the surface.
A path without a suffix is an OpenFOAM case. Lengths are in the model's units
(0.5) or in percent of its diagonal (0.2%). Each solid of an ASCII STL, or group
of an OBJ or PLY, is a patch.

Examples:
  burnish mesh dirty.stl -o case
  burnish mesh manifold.stl -o case --cells 500k --patch-type in=patch,out=patch
  burnish mesh car.stl -o case --outside --domain -5,-3,-3,15,3,3
  burnish mesh wing.stl -o wing.msh --outside --cell 0.2% --refine 1,-1,0,3,1,1:0.1%
  burnish mesh part.stl -o case --scale 0.001 --flavour polyhedral

Exit codes: 0 done, 2 usage, 3 input unreadable, 4 output unwritable, 5 the
input bounds no solid, or the mesh does not pass checkMesh, 6 memory limit,
130 interrupted.
)";

// Options of `clean` that mean the same here.
constexpr std::string_view kRepairOptions[] = {"--method", "--nested", "--gap", "--max-hole", "--thicken", "--keep-largest", "--min-component", "--from-field", "--iso", "--below",
                                               "--array", "--smooth", "--mode", "--free-volume", "--region", "--curvature-radius", "--deviation", "--offset", "--hollow"};

class MeshCommand : public Command {
 public:
  CommandLine command_line() override {
    return {"mesh",
            "Fills the inside or the outside of a triangle file with cells for flow\n"
            "simulation: mostly hexahedra, closed however dirty the file is, and checked as\n"
            "OpenFOAM's checkMesh does before it is written.",
            {"burnish mesh IN -o CASE [options]"},
            {{file("IN", kSurfaceOrVolumeInputs), "STL, OBJ, PLY, OFF or 3MF file, or a volume (.vti, .nrrd); '-' is standard input.", store_text(job_.input)}},
            option_table(),
            kNotes,
            &job_.options.unit};
  }

  int run() override {
    require_consistent();
    require_plausible_input(job_.input);
    const ThreadLimit limit(threads_);
    const double start = monotonic_seconds();
    MadeFolders folders;
    if (is_case())  // it may not be there yet, and its reports are made before it
      for (const std::string& report : {report_path_, quality_path_}) folders.make_for(report, job_.output);
    ReportFile report_file(report_path_, job_.write.overwrite), quality_file(quality_path_, job_.write.overwrite);
    Console console(quiet_ ? Verbosity::quiet : Verbosity::normal);
    for (const std::string& option : idle_options(job_.options)) console.warn(option, {"has no effect without --smooth"});
    const FlowMeshResult result = flow_mesh(job_, console);
    if (report_file.wanted()) report_file.write(to_json(result));
    if (quality_file.wanted()) quality_file.write(quality_to_json(result));
    tell(result, json_, quiet_, console, result.meshed, [&] { return summary_of(result, monotonic_seconds() - start); });
    return end_with(result.failure);
  }

 private:
  std::vector<Option> option_table() {
    std::vector<Option> table = own_options();
    const auto behind = std::find_if(table.begin(), table.end(), [](const Option& o) { return o.group == "Broken files"; });
    std::vector<Option> rows;
    for (Option& row : with_clean_options({}, job_.options))
      if (std::find(std::begin(kRepairOptions), std::end(kRepairOptions), row.name) != std::end(kRepairOptions)) rows.push_back(std::move(row));
    table.insert(behind, std::make_move_iterator(rows.begin()), std::make_move_iterator(rows.end()));
    return table;
  }

  std::vector<Option> own_options() {
    std::vector<Option> table;
    for (std::vector<Option> rows : {output_rows(), domain_rows(), cell_rows(), layer_rows(), patch_rows(), other_rows()}) table.insert(table.end(), std::make_move_iterator(rows.begin()), std::make_move_iterator(rows.end()));
    return table;
  }

  std::vector<Option> output_rows() {
    return {
        {"--output", 'o', file("PATH", kMeshOutputs), "Output", "Where to write: the folder of an OpenFOAM case, or a .vtu (VTK), .msh (Gmsh), .su2 or .cgns file.", store_text(job_.output)},
        {"--overwrite", 0, "", "Output", "Replace a file, or the mesh of a case, that exists already.", switch_on(job_.write.overwrite)},
        {"--dry-run", 0, "", "Output", "Mesh and report, and write nothing.", switch_on(dry_run_)},
        {"--scale", 0, number("S"), "Output", "Multiply what is written by S, such as 0.001 from millimetres to metres. All lengths given here stay the model's.",
         [this](const GivenValue& v) { job_.scale = positive_number(v); }},
        {"--ascii", 0, "", "Output", "Write the files of a case as text, not in binary.", [this](const GivenValue&) { job_.write.foam.binary = false, of_case_ = "--ascii"; }},
        {"--compressed", 0, "", "Output", "Write the files of a case gzipped.", [this](const GivenValue&) { job_.write.foam.compressed = true, of_case_ = "--compressed"; }},
        {"--msh-version", 0, word("V", {"4.1", "2.2"}), "Output", "Version of a .msh file: 4.1 (default) or 2.2.",
         [this](const GivenValue& v) { job_.write.msh_version = place_among(v) == 0 ? 41 : 22, msh_version_given_ = true; }},
        {"--report", 0, file("FILE", kReports), "Output", "Write a report of what was found and made, as JSON.", store_text(report_path_)},
        {"--quality", 0, file("FILE", kReports), "Output", "Write all checks of the mesh, and the cells that fail them, as JSON.", store_text(quality_path_)},
        {"--json", 0, "", "Output", "Print the report on standard output instead of the table.", switch_on(json_)},
    };
  }

  std::vector<Option> domain_rows() {
    return {
        {"--inside", 0, "", "Domain", "Mesh what is inside of the model (default).", switch_on(inside_)},
        {"--outside", 0, "", "Domain", "Mesh what is around it, in a box.", [this](const GivenValue&) { job_.side = MeshSide::outside; }},
        {"--domain", 0, length("D"), "Domain",
         "With --outside, that box: a margin around the model, such as 20 or 300%, or xmin,ymin,zmin,xmax,ymax,zmax. The longest side around when not given.",
         [this](const GivenValue& v) { set_domain(v); }},
    };
  }

  std::vector<Option> cell_rows() {
    return {
        units_row("Cells", job_.options.unit),
        {"--cell", 0, length("L"), "Cells", "Side of the finest cells at the surface, such as 0.5 or 0.2%. A hundredth of the longest side when not given.",
         [this](const GivenValue& v) { job_.cell = length_without_cells(v); }},
        {"--cells", 0, count("N"), "Cells", "Choose the side so that there are about N cells, such as 200000, 200k or 2M.", [this](const GivenValue& v) { job_.cells = cell_count(v); }},
        {"--refine", 0, "BOX:L", "Cells", "No larger cells than L where they meet a box xmin,ymin,zmin,xmax,ymax,zmax. May be repeated.", [this](const GivenValue& v) { add_refinement(v); }, true},
        {"--coarsest", 0, count("N"), "Cells", "Away from the surface, cells are up to 2^N times as large (0 to 10; default 4).",
         [this](const GivenValue& v) { job_.coarsest_level = static_cast<int>(integer_within(v, 0, 10)); }},
        {"--flat-levels", 0, count("N"), "Cells", "Where the surface is flat, its cells are up to 2^N times as large (0 to 4; default 1).",
         [this](const GivenValue& v) { job_.flat_levels = static_cast<int>(integer_within(v, 0, 4)); }},
        {"--flat-angle", 0, number("ANGLE"), "Cells", "Flat is where normals turn by less than ANGLE degrees within a cell's length around a cell (default 45).",
         [this](const GivenValue& v) { job_.flat_angle = flat_angle(v); }},
        {"--rows", 0, count("N"), "Cells", "Rows of cells of one size before the next larger one (1 to 20; default 2).",
         [this](const GivenValue& v) { job_.cells_between_levels = static_cast<int>(integer_within(v, 1, 20)); }},
        {"--flavour", 0, word("F", {"conforming", "polyhedral"}), "Cells", "'conforming' (default): any solver reads it; 'polyhedral': fewer cells, hexahedra with split faces, for OpenFOAM and VTK.",
         [this](const GivenValue& v) { job_.flavour = one_of<MeshFlavour>(v); }},
        {"--crease", 0, number("ANGLE"), "Cells", "Edges of more than ANGLE degrees are edges of the mesh; 40 when not given, none with 180.", [this](const GivenValue& v) { set_crease_angle(v); }},
    };
  }

  std::vector<Option> layer_rows() {
    return {
        {"--layers", 0, count("N"), "Layers", "N layers of flat cells at the wall (1 to 20).", [this](const GivenValue& v) { job_.layers.count = static_cast<int>(integer_within(v, 1, 20)); }},
        {"--first", 0, length("H"), "Layers", "Height of the cells at the wall, such as 0.01, 0.05% or 0.1h (h: --cell). When not given, all layers together are half a cell thick.",
         [this](const GivenValue& v) { job_.layers.first = positive_length(v), of_layers_ = v.name; }},
        {"--ratio", 0, number("R"), "Layers", "Each layer is R times as high as the one before it (1 to 2; default 1.2).", [this](const GivenValue& v) { set_layer_ratio(v); }},
    };
  }

  std::vector<Option> patch_rows() {
    return {
        {"--patches", 0, word("P", {"solid", "one"}), "Patches", "'solid' (default): one for each solid or group of the file; 'one' for all.",
         [this](const GivenValue& v) { job_.one_patch = place_among(v) == 1; }},
        {"--patch-type", 0, named_word("NAME=T,...", {"wall", "patch", "symmetry"}), "Patches", "Types of patches: wall, patch or symmetry. The model's are walls, the domain's are patches.", [this](const GivenValue& v) { set_patch_types(v); }},
    };
  }

  std::vector<Option> other_rows() {
    CleanOptions& o = job_.options;
    return {
        {"--repair-cell", 0, length("L"), "Repair", "Rebuild the surface by a level set with cells of L. When one is needed and L is not given: half the mesh's cell.",
         [&o](const GivenValue& v) { o.cell = length_without_cells(v); }},
        salvage_row("Broken files", job_.salvage),
        {"--allow-invalid", 0, "", "Broken files", "Write the mesh even if it does not pass checkMesh. The exit code is still 5.", switch_on(job_.allow_invalid)},
        threads_row("Resources", threads_),
        memory_row("Resources", o),
        quiet_row("Messages", quiet_),
        help_row("Messages"),
    };
  }

  void set_domain(const GivenValue& v) {
    if (v.text.find(',') == v.text.npos)
      job_.domain.margin = length_without_cells(v);
    else
      job_.domain.box = box_of(v);
    domain_given_ = true;
  }

  // 200000, 200k, 2M: of a thousand, not of 1024.
  static std::uint64_t cell_count(const GivenValue& v) {
    const double factor = v.text.ends_with('k') ? 1e3 : v.text.ends_with('M') ? 1e6 : 1;
    const GivenValue digits = v.part(factor > 1 ? v.text.substr(0, v.text.size() - 1) : v.text);
    const double cells = std::round(positive_number(digits) * factor);
    if (cells < 100 || cells > 4e9) throw Error(ErrorCode::usage, fmt::format("{} {}: expected a number of cells from 100 to 4000M", v.name, v.text), "for example 200k, or 2M");
    return static_cast<std::uint64_t>(cells);
  }

  void add_refinement(const GivenValue& v) {
    const std::size_t colon = v.text.rfind(':');
    if (colon == v.text.npos) throw Error(ErrorCode::usage, fmt::format("{} {}: expected BOX:L", v.name, v.text), "for example --refine 0,0,0,10,10,20:0.5");
    job_.refinements.push_back({box_of(v.part(v.text.substr(0, colon))), positive_length(v.part(v.text.substr(colon + 1)))});
  }

  static double flat_angle(const GivenValue& v) {
    const double angle = positive_number(v);
    if (angle > 90) throw Error(ErrorCode::usage, fmt::format("{} {}: expected an angle up to 90 degrees", v.name, v.text), "45 is the default: smaller angles keep small cells where the surface curves");
    return angle;
  }

  void set_crease_angle(const GivenValue& v) {
    job_.crease_angle = positive_number(v);
    if (job_.crease_angle > 180) throw Error(ErrorCode::usage, fmt::format("{} {}: expected an angle up to 180 degrees", v.name, v.text), "40 is the default; 180 keeps no edge");
    crease_given_ = true;
  }

  void set_layer_ratio(const GivenValue& v) {
    job_.layers.ratio = positive_number(v);
    if (job_.layers.ratio < 1 || job_.layers.ratio > 2) throw Error(ErrorCode::usage, fmt::format("{} {}: expected a ratio from 1 to 2", v.name, v.text), "1.2 is the default");
    of_layers_ = v.name;
  }

  void set_patch_types(const GivenValue& v) {
    for (const auto& [name, type] : named_values(v, "inlet=patch,hub=wall")) {
      static_cast<void>(place_among(v.part(type)));
      job_.patch_types.emplace_back(name, type);
    }
  }

  // Before anything is read; a mesh must not take its model's place.
  void require_consistent() {
    const auto refuse = [](const std::string& message, const std::string& hint) { throw Error(ErrorCode::usage, message, hint); };
    if (job_.output.empty() && !dry_run_) refuse("no output is named", "add -o CASE, or --dry-run to see what the mesh would be");
    if (job_.cell && job_.cells) refuse("--cell and --cells exclude each other", "give one of the two");
    if (inside_ && job_.side == MeshSide::outside) refuse("--inside and --outside exclude each other", "mesh one side after the other");
    if (domain_given_ && job_.side == MeshSide::inside) refuse("--domain is the box around the model", "add --outside");
    if (!of_layers_.empty() && job_.layers.count == 0) refuse(fmt::format("{} is for layers", of_layers_), "add --layers N");
    // The angle is that of smoothing, too, which keeps what is to be an edge of the mesh.
    if (crease_given_ && job_.options.smooths() && job_.crease_angle < 180) job_.options.crease_angle = job_.crease_angle;
    burnish::require_consistent(job_.options);
    require_suitable_output();
    require_distinct_files();
    if (dry_run_) job_.output.clear();
  }

  bool is_case() const { return !job_.output.empty() && volume_format(job_.output) == VolumeFormat::foam_case; }

  void require_suitable_output() const {
    const auto refuse = [](const std::string& message, const std::string& hint) { throw Error(ErrorCode::usage, message, hint); };
    if (job_.output.empty()) return;
    if (job_.output == "-") refuse("a mesh cannot go to standard output", "name a file, or the folder of a case");
    const VolumeFormat format = volume_format(job_.output);
    if (!of_case_.empty() && format != VolumeFormat::foam_case) refuse(fmt::format("{} is for an OpenFOAM case", of_case_), "leave it out, or name a folder");
    if (msh_version_given_ && format != VolumeFormat::msh) refuse("--msh-version is for a .msh file", "leave it out, or name one");
    const bool reads_polyhedra = format == VolumeFormat::foam_case || format == VolumeFormat::vtu;
    if (job_.flavour == MeshFlavour::polyhedral && !reads_polyhedra) refuse(fmt::format("{}: the format has no polyhedra", job_.output), "leave --flavour out, or write a case or a .vtu");
  }

  void require_distinct_files() const {
    const std::vector<NamedFile> reports{{"--report", report_path_}, {"--quality", quality_path_}};
    for (const NamedFile& report : reports)
      if (report.path == "-") throw Error(ErrorCode::usage, fmt::format("{} needs a file's name", report.by), "--json prints the report");
    if (const auto two = named_twice({{"IN", job_.input}, {"-o", job_.output}, reports[0], reports[1]}))
      throw Error(ErrorCode::usage, fmt::format("{}: {} and {} name the same file", two->back().path, two->front().by, two->back().by), "give another name to one of them");
  }

  FlowMeshJob job_;
  std::string report_path_, quality_path_;
  std::string of_layers_;     // an option of layers, if one was given
  std::string_view of_case_;  // an option of that sort, if one was given
  int threads_ = 0;
  bool inside_ = false, dry_run_ = false, domain_given_ = false, crease_given_ = false, msh_version_given_ = false;
  bool json_ = false;
  bool quiet_ = false;
};

}  // namespace

std::unique_ptr<Command> make_mesh_command() { return std::make_unique<MeshCommand>(); }

}  // namespace burnish
