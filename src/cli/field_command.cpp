#include <fmt/format.h>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/core/timer.h"
#include "burnish/io/field_files.h"
#include "burnish/pipeline/field.h"
#include "commands.h"
#include "console.h"
#include "report_error.h"
#include "streams.h"
#include "values.h"

namespace burnish {
namespace {

constexpr std::string_view kNotes =
    R"(Without -o it only reports. A .vtu has the cells with their nodes, a .htg the
tree; ParaView reads both, and scripts/render_octree draws a section.

Examples:
  burnish field part.stl
  burnish field part.stl -o part.vtu --resolution 200 --verify-exact 10000
  burnish field part.stl -o octree.htg --blocks

Exit codes: 0 done, 1 nodes differ from exact distances by more than allowed,
2 usage, 3 input unreadable, 4 output unwritable, 5 the input bounds no solid,
6 memory limit.
)";

constexpr double kLeastBand = 2, kWidestBand = 64;  // cells

std::string line(std::string_view label, const std::string& text) { return fmt::format("{:<20}{}\n", label, text); }

std::string check_lines(const DistanceCheck& check, double cell) {
  std::string strata;
  for (std::size_t s = 0; s < kNodeStrata; ++s)
    strata += fmt::format("{}{} {}", s == 0 ? "" : ", ", check.nodes[s], name(static_cast<NodeStratum>(s)));
  const auto errors = [&](const ErrorSummary& e) {
    const std::string verdict = e.exceeded == 0 ? fmt::format("at most {:.2g} of what is allowed", e.worst_share)
                                                : fmt::format("{} nodes beyond what is allowed", e.exceeded);
    return fmt::format("max {:.3g}, rms {:.3g}, {}", e.max * cell, e.rms * cell, verdict);
  };
  return line("nodes compared", fmt::format("{}", check.total())) + line("", strata) + line("error of kernel", errors(check.kernel)) +
         line("error of phi", errors(check.stored));
}

std::string volume_line(const FieldVolume& v) {
  const std::string shift = v.prepared != 0 ? fmt::format(" ({:+.2g} %)", 100 * (v.level_set / v.prepared - 1)) : "";
  return line("volume", fmt::format("{:.6g} of {:.6g}{}", v.level_set, v.prepared, shift));
}

std::string file_lines(const FieldFile& o) {
  std::string size = fmt::format("{} cells, ", o.cell_count);
  size += o.octant_count > 0 ? fmt::format("{} octants", o.octant_count) : fmt::format("{} points", o.point_count);
  return fmt::format("{}: {}, {:.1f} MB", o.file, size, static_cast<double>(o.bytes) / 1e6);
}

std::string field_summary(const FieldResult& r, double seconds) {
  std::string text = fmt::format("{} ({})\n\n", r.input, r.input_format);
  text += line("cell", fmt::format("{:.6g}{}, {:.4g} along the longest side", r.options.cell, r.options.cell_was_chosen ? " (chosen)" : "",
                                   r.options.cells_along_longest_side));
  text += line("band", fmt::format("{:g} cells", r.band));
  text += line("blocks", fmt::format("{} of 8 x 8 x 8 cells, {} finest, {} near", r.grid.blocks, r.grid.finest_blocks, r.grid.near_blocks));
  text += line("levels", fmt::format("{}", r.grid.levels));
  text += line("nodes", fmt::format("{}", r.grid.nodes));
  text += line("memory", fmt::format("{:.1f} MB", static_cast<double>(r.grid.bytes) / 1e6));
  text += line("regions", fmt::format("{}, {} of them ambiguous", r.regions, r.ambiguous_regions));
  text += line("facets", fmt::format("{}, {} of them inside, {} unresolved", r.facets, r.interior_facets, r.unresolved_facets));
  text += volume_line(r.volume);
  if (r.verification) text += check_lines(*r.verification, r.options.cell);
  return text + fmt::format("\n{} ({:.1f} s)\n", r.output.written ? file_lines(r.output) : "nothing was written", seconds);
}

class FieldCommand : public Command {
 public:
  CommandLine command_line() override {
    return {"field",
            "Builds the level set of a triangle file on its octree: reports it, compares it\n"
            "with exact distances, and writes it for viewers and solvers.",
            {"burnish field IN [-o OUT] [options]"},
            {{"IN", "STL, OBJ, PLY or OFF file; '-' is standard input.", store_text(job_.input)}},
            option_table(),
            kNotes};
  }

  int run() override {
    require_consistent();
    require_plausible_input(job_.input);
    const ThreadLimit limit(threads_);
    const double start = monotonic_seconds();
    Console console(quiet_ ? Verbosity::quiet : Verbosity::normal);
    if (job_.overwrite && job_.output.empty()) console.warn("--overwrite", {"has no effect without -o"});
    const FieldResult result = field(job_, console);
    console.end_stage();
    console.warn(result.input, result.warnings);
    if (json_)
      write_stdout(to_json(result));
    else if (!quiet_ && !result.failure)
      write_stdout(field_summary(result, monotonic_seconds() - start));
    if (result.failure) {
      print_error(*result.failure);
      return exit_code(result.failure->code());
    }
    return result.verification && !result.verification->passed() ? exit_code(ErrorCode::answer_is_no) : 0;
  }

 private:
  std::vector<Option> option_table() {
    CleanOptions& o = job_.options;
    return {
        {"--output", 'o', "FILE", "Output", "Where to write: .vtu (cells and nodes) or .htg (the tree).", store_text(job_.output)},
        {"--overwrite", 0, "", "Output", "Replace FILE if it exists already.", switch_on(job_.overwrite)},
        {"--octree", 0, "W", "Output",
         "What is a cell of FILE: 'near' (default) a cell of the octree near the surface and a block elsewhere, 'blocks', or 'cells' everywhere.",
         [this](const GivenValue& v) { cells_ = one_of<FieldCells>(v, {"near", "blocks", "cells"}), octree_given_ = true; }},
        {"--blocks", 0, "", "Output", "The same as --octree blocks.", switch_on(blocks_)},
        {"--json", 0, "", "Output", "Print the result as JSON.", switch_on(json_)},
        {"--cell", 0, "L", "Resolution", "Side of the finest cells, such as 0.5 or 0.2%. Chosen from the model with 'auto', or when not given.",
         [&o](const GivenValue& v) {
           if (v.text != "auto") o.cell = length_without_cells(v);
         }},
        {"--resolution", 0, "N", "Resolution", "Cells along the longest side (8 to 100000), instead of --cell.",
         [&o](const GivenValue& v) { o.resolution = static_cast<int>(integer_within(v, 8, 100'000)); }},
        {"--band", 0, "CELLS", "Resolution", "Exact distances up to this many cells on both sides (2 to 64; default 3).",
         [this](const GivenValue& v) { job_.band = band(v); }},
        {"--verify-exact", 0, "N", "Checking", "Compare N nodes with exact distances; exit code 1 if one is off by more than is allowed.",
         [this](const GivenValue& v) { job_.verify = static_cast<std::size_t>(integer_within(v, 1, 100'000'000)); }},
        {"--nested", 0, "N", "Preparation", "What a body inside a body is: 'solid', 'cavity', or 'auto' (default): a cavity if it is oriented so.",
         [&o](const GivenValue& v) { o.nesting = one_of<Nesting>(v, {"auto", "solid", "cavity"}); }},
        {"--gap", 0, "L", "Preparation", "Close cracks up to a width of L by joining the points on both sides.",
         [&o](const GivenValue& v) { o.gap = length_without_cells(v); }},
        {"--max-hole", 0, "L", "Preparation", "Close holes up to a diameter of L; of a sheet with wider openings one side is inside.",
         [&o](const GivenValue& v) { o.max_hole = length_without_cells(v); }},
        {"--salvage", 0, "", "Preparation", "Take what a truncated or malformed file holds.", switch_on(job_.salvage)},
        {"--threads", 0, "N", "Resources", "Use at most N threads. The result does not depend on it.",
         [this](const GivenValue& v) { threads_ = static_cast<int>(integer_within(v, 1, 4096)); }},
        {"--memory", 0, "SIZE", "Resources", "Plan to stay below SIZE bytes, such as 800M or 16G. Default: 4G.",
         [&o](const GivenValue& v) { o.memory_bytes = byte_count(v); }},
        {"--quiet", 'q', "", "Messages", "Print errors only: the exit code is the answer.", switch_on(quiet_)},
        {"--help", 'h', "", "Messages", "Print this help.", [](const GivenValue&) {}},
    };
  }

  static double band(const GivenValue& v) {
    const double cells = non_negative_number(v);
    if (cells < kLeastBand || cells > kWidestBand)
      throw Error(ErrorCode::usage, fmt::format("{} {}: expected a number of cells from {:g} to {:g}", v.name, v.text, kLeastBand, kWidestBand));
    return cells;
  }

  // Before anything is read; an output that looks at the model must not take its place.
  void require_consistent() {
    const auto refuse = [](const std::string& message, const std::string& hint) { throw Error(ErrorCode::usage, message, hint); };
    if (job_.options.cell && job_.options.resolution) refuse("--cell and --resolution exclude each other", "give one of the two");
    if (blocks_ && octree_given_ && cells_ != FieldCells::blocks) refuse("--blocks and --octree say different things", "give one of the two");
    job_.cells = blocks_ ? FieldCells::blocks : cells_;
    if (job_.output.empty()) {
      if (blocks_ || octree_given_) refuse("--blocks and --octree say what is written, and no output is named", "add -o FILE.vtu or -o FILE.htg");
      return;
    }
    static_cast<void>(field_format_for_writing(job_.output));
    if (same_file(job_.output, job_.input))
      refuse(fmt::format("{}: -o names the input", job_.output), "the field is no replacement for the model: give another name");
  }

  FieldJob job_;
  FieldCells cells_ = FieldCells::near;
  int threads_ = 0;
  bool octree_given_ = false;
  bool blocks_ = false;
  bool json_ = false;
  bool quiet_ = false;
};

}  // namespace

std::unique_ptr<Command> make_field_command() { return std::make_unique<FieldCommand>(); }

}  // namespace burnish
