#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/core/timer.h"
#include "burnish/io/field_files.h"
#include "burnish/pipeline/cell_octree.h"
#include "burnish/pipeline/field.h"
#include "clean_options.h"
#include "commands.h"
#include "console.h"
#include "field_summary.h"
#include "outcome.h"
#include "shared_rows.h"
#include "suffixes.h"
#include "values.h"

namespace burnish {
namespace {

constexpr std::string_view kNotes =
    R"(Without -o it only reports. A .vtu has the cells with their nodes, a .htg the
tree; ParaView reads both, and scripts/render_octree draws a section. A .vti
(VTK) and a .nrrd have distances at the nodes of a uniform grid, a .vdb those of
the finest cells in a narrow band. phi is positive inside; in a .vdb negative, as
OpenVDB has it. An OpenFOAM field on a mesh that is there already is made by
'burnish ic --also-phi'.

With --cell-octree there is no level set, only an octree of cells that facets
refine: IN is taken as it is, sheets and holes included. Without any of its
limits, --max-face-limit 3 --refine-tol 2 and cells from 1/160 to 1/5 of the
longest side.

Examples:
  burnish field part.stl
  burnish field part.stl -o part.vtu --resolution 200 --verify-exact 10000
  burnish field part.stl -o octree.htg --blocks
  burnish field part.stl -o part.nrrd --samples 200 --box 0,0,0,10,10,20
  burnish field scan.stl -o scan.vdb --smooth 0.5 --mode volume
  burnish field part.stl -o cells.vtu --cell-octree --max-face-limit 5

Exit codes: 0 done, 1 nodes differ from exact distances by more than allowed,
2 usage, 3 input unreadable, 4 output unwritable, 5 the input bounds no solid,
6 memory limit, 130 interrupted.
)";

constexpr double kLeastBand = 2, kWidestBand = 64;  // cells

class FieldCommand : public Command {
 public:
  CommandLine command_line() override {
    return {"field",
            "Builds the level set of a triangle file on its octree: reports it, compares it\n"
            "with exact distances, and writes it for viewers and solvers.",
            {"burnish field IN [-o OUT] [options]"},
            {{file("IN", kSurfaceInputs), "STL, OBJ, PLY, OFF or 3MF file; '-' is standard input.", store_text(job_.input)}},
            option_table(),
            kNotes,
            &job_.options.unit};
  }

  int run() override {
    require_consistent();
    require_plausible_input(job_.input);
    const ThreadLimit limit(threads_);
    Console console(quiet_ ? Verbosity::quiet : Verbosity::normal);
    if (job_.overwrite && job_.output.empty()) console.warn("--overwrite", {"has no effect without -o"});
    for (const std::string& option : idle_options(job_.options)) console.warn(option, {"has no effect without --smooth"});
    return cell_octree_ ? grow(console) : build(console);
  }

 private:
  int build(Console& console) {
    const double start = monotonic_seconds();
    const FieldResult result = field(job_, console);
    tell(result, json_, quiet_, console, !result.failure, [&] { return summary_of(result, monotonic_seconds() - start); });
    if (const int code = end_with(result.failure)) return code;
    return result.verification && !result.verification->passed() ? exit_code(ErrorCode::answer_is_no) : 0;
  }

  int grow(Console& console) {
    const double start = monotonic_seconds();
    CellOctreeJob job;
    job.input = job_.input, job.output = job_.output;
    job.unit = job_.options.unit;
    job.salvage = job_.salvage, job.overwrite = job_.overwrite;
    job.cell = job_.options.cell, job.resolution = job_.options.resolution, job.cell_max = job_.options.cell_max;
    job.limits = job_.limits;
    job.memory_bytes = job_.options.memory_bytes;
    const CellOctreeResult result = cell_octree(job, console);
    tell(result, json_, quiet_, console, true, [&] { return summary_of(result, monotonic_seconds() - start); });
    return 0;
  }

  // An option that means nothing to an octree of cells.
  Setter of_level_set(Setter set) {
    return [this, set = std::move(set)](const GivenValue& v) {
      set(v);
      if (of_level_set_.empty()) of_level_set_ = v.name;
    };
  }

  Option of_level_set(Option row) {
    row.set = of_level_set(std::move(row.set));
    return row;
  }

  // The same, of what is said about the file; the first that was given is remembered with the formats that it is for.
  Setter of_content(Setter set, bool (*suits)(FieldFormat), std::string_view formats) {
    return of_level_set([this, set = std::move(set), suits, formats](const GivenValue& v) {
      set(v);
      of_content_.push_back({std::string(v.name), suits, formats});
    });
  }
  Setter of_cells(Setter set) { return of_content(std::move(set), holds_cells, "a .vtu or .htg"); }
  Setter of_samples(Setter set) { return of_content(std::move(set), holds_samples, "a .vti or .nrrd"); }

  std::vector<Option> option_table() {
    std::vector<Option> table = own_options();
    const auto behind = std::find_if(table.begin(), table.end(), [](const Option& o) { return o.group == "Preparation"; });
    constexpr std::array<std::string_view, 4> kWanted{"--smooth", "--mode", "--free-volume", "--deviation"};
    std::vector<Option> rows;
    for (Option& row : with_clean_options({}, job_.options)) {
      if (std::find(kWanted.begin(), kWanted.end(), row.name) == kWanted.end()) continue;
      row.set = of_level_set(std::move(row.set));
      rows.push_back(std::move(row));
    }
    table.insert(behind, rows.begin(), rows.end());
    return table;
  }

  std::vector<Option> own_options() {
    CleanOptions& o = job_.options;
    FieldContent& c = job_.content;
    return {
        {"--output", 'o', file("FILE", kFieldOutputs), "Output", "Where to write: .vtu (cells and nodes), .htg (the tree), .vti or .nrrd (a uniform grid), .vdb (OpenVDB).", store_text(job_.output)},
        {"--overwrite", 0, "", "Output", "Replace FILE if it exists already.", switch_on(job_.overwrite)},
        {"--octree", 0, word("W", {"near", "blocks", "cells"}), "Output",
         "What is a cell of FILE: 'near' (default) a cell of the octree near the surface and a block elsewhere, 'blocks', or 'cells' everywhere.",
         of_level_set([this](const GivenValue& v) { cells_ = one_of<FieldCells>(v), octree_given_ = true; })},
        {"--blocks", 0, "", "Output", "The same as --octree blocks.", of_level_set(switch_on(blocks_))},
        {"--data", 0, word_list("LIST", array_names()), "Output",
         "Arrays of a .vtu or .htg, such as phi,facet: of phi, level, inside, block, facet, mean_curvature, sign_confidence, accepted; all when not given.",
         of_cells([&c](const GivenValue& v) { c.arrays = arrays(v); })},
        {"--plain", 0, "", "Output", "The same as --data phi,level.", of_cells(switch_on(plain_))},
        {"--cell-centred", 0, "", "Output", "Values of a .vtu in cells only, not at nodes.", of_cells(switch_on(c.cell_centred))},
        {"--narrow-band", 0, length("W"), "Output",
         "Only distances up to W, such as 3h or 0.1: cells within it (.vtu), values that end there (.htg, .vti, .nrrd), half the band of a .vdb (3h when not given).",
         of_content([&c](const GivenValue& v) { c.narrow_band = positive_length(v); }, [](FieldFormat) { return true; }, "a file")},
        {"--box", 0, "BOX", "Output", "What a .vti or .nrrd covers, xmin,ymin,zmin,xmax,ymax,zmax; the model and 5 % around it when not given.",
         of_samples([&c](const GivenValue& v) { c.box = box_of(v); })},
        {"--samples", 0, count("N"), "Output", "Nodes of a .vti or .nrrd along its longest side (2 to 100000).",
         of_samples([&c](const GivenValue& v) { c.samples = static_cast<int>(integer_within(v, 2, 100'000)); })},
        {"--spacing", 0, length("L"), "Output", "Distance between nodes of a .vti or .nrrd; that of the finest cells when not given.",
         of_samples([&c](const GivenValue& v) { c.spacing = positive_length(v); })},
        {"--json", 0, "", "Output", "Print the result as JSON.", switch_on(json_)},
        units_row("Resolution", o.unit),
        {"--cell", 0, length("L", {"auto"}), "Resolution", "Side of the finest cells, such as 0.5 or 0.2%. Chosen from the model with 'auto', or when not given.",
         [&o](const GivenValue& v) {
           if (!is_listed(v)) o.cell = length_without_cells(v);
         }},
        {"--resolution", 0, count("N"), "Resolution", "Cells along the longest side (8 to 100000), instead of --cell.",
         [&o](const GivenValue& v) { o.resolution = static_cast<int>(integer_within(v, 8, 100'000)); }},
        {"--band", 0, number("CELLS"), "Resolution", "Exact distances up to this many cells on both sides (2 to 64; default 3, with --redistance 3.5 or more).",
         of_level_set([this](const GivenValue& v) { job_.band = band(v), band_given_ = true; })},
        {"--redistance", 0, redistance_methods("M"), "Distances",
         "Distances beyond the exact ones by 'closest' points, 'fmm', 'pde-weno5' or 'pde-first' (the thesis' way), instead of by the facets.",
         of_level_set([this](const GivenValue& v) { job_.redistance = one_of<RedistanceMethod>(v); })},
        {"--accepted", 0, word("W", {"cells", "band"}), "Distances",
         "With --redistance, what stays exact: 'cells' (default) that facets cut, and their neighbours, or the whole 'band'.",
         of_level_set([this](const GivenValue& v) { job_.exact = one_of<ExactNodes>(v), accepted_given_ = true; })},
        {"--verify-exact", 0, count("N"), "Checking", "Compare N nodes with exact distances; exit code 1 if one is off by more than is allowed.",
         of_level_set([this](const GivenValue& v) { job_.verify = static_cast<std::size_t>(integer_within(v, 1, 100'000'000)); })},
        {"--cell-octree", 0, "", "Refinement", "Grow an octree whose leaves are cells, not blocks of cells, and no level set.", switch_on(cell_octree_)},
        {"--adapt", 0, length("TOL"), "Refinement", "Take coarser cells where the distance is off by no more than TOL, such as 0.1h or 0.01.",
         of_level_set([&o](const GivenValue& v) { o.adapt = positive_length(v); })},
        {"--cell-max", 0, length("L"), "Refinement",
         "The coarsest cells at the surface, such as 16h or 1%; 8h when not given, with --cell-octree a fifth of the longest side.",
         [&o](const GivenValue& v) { o.cell_max = positive_length(v); }},
        {"--max-face-limit", 0, count("N"), "Refinement", "Divide while a cell holds the centroids of more than N facets.",
         [this](const GivenValue& v) { job_.limits.max_face_limit = facets(v); }},
        {"--max-face-cut", 0, count("N"), "Refinement", "Divide while more than N facets cut a cell.",
         [this](const GivenValue& v) { job_.limits.max_face_cut = facets(v); }},
        {"--refine-tol", 0, number("X"), "Refinement", "Divide while a cell is wider than X times the shortest edge of the facets that cut them.",
         [this](const GivenValue& v) { job_.limits.refine_tol = refine_tol(v); }},
        of_level_set(nested_row("Preparation", o)),
        of_level_set(gap_row("Preparation", o)),
        {"--max-hole", 0, length("L"), "Preparation", "Close holes up to a diameter of L; of a sheet with wider openings one side is inside.",
         of_level_set([&o](const GivenValue& v) { o.max_hole = length_without_cells(v); })},
        salvage_row("Preparation", job_.salvage),
        threads_row("Resources", threads_),
        memory_row("Resources", o),
        quiet_row("Messages", quiet_, true),
        help_row("Messages"),
    };
  }

  static std::vector<std::string_view> array_names() {
    std::vector<std::string_view> words;
    for (std::size_t a = 0; a < kFieldArrays; ++a) words.push_back(name(static_cast<FieldArray>(a)));
    return words;
  }

  static std::vector<FieldArray> arrays(const GivenValue& v) {
    std::vector<FieldArray> chosen;
    for (const std::string_view word : parts_of(v.text)) chosen.push_back(one_of<FieldArray>(v.part(word)));
    return chosen;
  }

  static double band(const GivenValue& v) {
    const double cells = non_negative_number(v);
    if (cells < kLeastBand || cells > kWidestBand)
      throw Error(ErrorCode::usage, fmt::format("{} {}: expected a number of cells from {:g} to {:g}", v.name, v.text, kLeastBand, kWidestBand), "leave it out for the usual one");
    return cells;
  }

  static std::uint32_t facets(const GivenValue& v) {
    return static_cast<std::uint32_t>(integer_within(v, 0, 4'000'000'000));
  }

  static double refine_tol(const GivenValue& v) {
    const double tolerance = non_negative_number(v);
    if (!(tolerance > 0)) throw Error(ErrorCode::usage, fmt::format("{} {}: expected a number greater than zero", v.name, v.text), fmt::format("for example {} 2", v.name));
    return tolerance;
  }

  // Before anything is read; an output that looks at the model must not take its place.
  void require_consistent() {
    const auto refuse = [](const std::string& message, const std::string& hint) { throw Error(ErrorCode::usage, message, hint); };
    if (accepted_given_ && !job_.redistance) refuse("--accepted says what redistancing starts from, and there is none", "add --redistance M");
    if (!band_given_) job_.band = std::max(job_.band, least_band(job_));
    if (job_.band < least_band(job_))
      refuse(fmt::format("--band {:g}: ACCEPTED cells need {:g} cells for exact distances", job_.band, least_band(job_)), "leave --band out, or add --accepted band");
    require_plausible_smoothing();
    if (job_.options.cell && job_.options.resolution) refuse("--cell and --resolution exclude each other", "give one of the two");
    if (cell_octree_ && !of_level_set_.empty())
      refuse(fmt::format("{} is a matter of the level set, and --cell-octree builds none", of_level_set_), "leave one of the two out");
    const bool is_adaptive = job_.options.adapt || job_.limits.max_face_limit || job_.limits.max_face_cut || job_.limits.refine_tol;
    if (job_.options.cell_max && !cell_octree_ && !is_adaptive)
      refuse("--cell-max needs something that decides where cells are as coarse", "for example --adapt 0.1h, or --cell-octree");
    if (blocks_ && octree_given_ && cells_ != FieldCells::blocks) refuse("--blocks and --octree say different things", "give one of the two");
    job_.cells = blocks_ ? FieldCells::blocks : cells_;
    require_suitable_content();
    if (job_.output.empty()) return;
    if (same_file(job_.output, job_.input))
      refuse(fmt::format("{}: -o names the input", job_.output), "the field is no replacement for the model: give another name");
  }

  void require_plausible_smoothing() const {
    const auto refuse = [](const std::string& message, const std::string& hint) { throw Error(ErrorCode::usage, message, hint); };
    const CleanOptions& o = job_.options;
    if (o.mode == SmoothMode::feature && o.smooths_in_cells()) refuse("--mode feature works on facets, which have no cells to measure lengths in", "give them in model units or in percent");
    if (o.smooths() && accepted_given_) refuse("--accepted keeps distances to facets, and --smooth moves the surface away from them", "leave one of the two out");
    if (o.smooths() && job_.verify > 0) refuse("--verify-exact compares with the facets, and --smooth moves the surface away from them", "leave one of the two out");
  }

  // What was said about the file, and the file.
  void require_suitable_content() {
    const auto refuse = [](const std::string& message, const std::string& hint) { throw Error(ErrorCode::usage, message, hint); };
    if (plain_ && !job_.content.arrays.empty()) refuse("--plain and --data say different things", "give one of the two");
    if (plain_) job_.content.arrays = {FieldArray::phi, FieldArray::level};
    if (job_.content.samples && job_.content.spacing) refuse("--samples and --spacing exclude each other", "give one of the two");
    if (std::count(job_.content.arrays.begin(), job_.content.arrays.end(), FieldArray::accepted) > 0 && !job_.redistance)
      refuse("--data accepted: cells are accepted where redistancing starts", "add --redistance M");
    if (job_.output.empty()) {
      if (blocks_ || octree_given_) refuse("--blocks and --octree say what is written, and no output is named", "add -o FILE.vtu or -o FILE.htg");
      if (!of_content_.empty()) refuse(of_content_.front().option + " says what is written, and no output is named", "add -o FILE");
      return;
    }
    const FieldFormat format = field_format_for_writing(job_.output);
    if (cell_octree_ && !holds_cells(format)) refuse(fmt::format("{}: an octree of cells has no distances to be sampled", job_.output), "write a .vtu or a .htg");
    if ((blocks_ || octree_given_) && !holds_cells(format)) refuse("--blocks and --octree are for a .vtu or .htg", "leave them out, or write one of these");
    for (const ContentOption& given : of_content_)
      if (!given.suits(format)) refuse(fmt::format("{} is for {}", given.option, given.formats), "leave it out, or write one of these");
  }

  struct ContentOption {
    std::string option;
    bool (*suits)(FieldFormat);
    std::string_view formats;
  };

  FieldJob job_;
  std::vector<ContentOption> of_content_;
  bool plain_ = false;
  FieldCells cells_ = FieldCells::near;
  std::string of_level_set_;  // an option of that sort, if one was given
  int threads_ = 0;
  bool cell_octree_ = false;
  bool octree_given_ = false;
  bool band_given_ = false;
  bool accepted_given_ = false;
  bool blocks_ = false;
  bool json_ = false;
  bool quiet_ = false;
};

}  // namespace

std::unique_ptr<Command> make_field_command() { return std::make_unique<FieldCommand>(); }

}  // namespace burnish
