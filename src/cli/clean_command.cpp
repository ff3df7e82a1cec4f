#include <fmt/format.h>
#include <unistd.h>

#include <optional>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/core/timer.h"
#include "burnish/io/mesh_io.h"
#include "burnish/io/output_file.h"
#include "burnish/pipeline/clean.h"
#include "commands.h"
#include "console.h"
#include "report_error.h"
#include "streams.h"
#include "summary.h"
#include "values.h"

namespace burnish {
namespace {

constexpr std::string_view kNotes =
    R"(Lengths are in the model's units (0.5), in percent of the bounding box'
diagonal (0.2%), or in cells (2h).

Examples:
  burnish dirty.stl -o clean.stl
  burnish scan.stl -o smooth.ply --smooth 0.5% --report scan.json
  burnish dirty.stl -o - --resolution 400 -q > clean.stl

Exit codes: 0 done and verified, 2 usage, 3 input unreadable, 4 output
unwritable, 5 a guarantee could not be met, 6 memory limit, 70 a bug of
Burnish, 130 interrupted.
)";

class CleanCommand : public Command {
 public:
  CommandLine command_line() override {
    return {"clean",
            "Repairs a triangle file: the result is closed, oriented and free of\n"
            "self-intersections, and is verified before it gets its name.",
            {"burnish IN -o OUT [options]"},
            {{"IN", "STL, OBJ, PLY or OFF file; '-' is standard input.", store_text(job_.input)}},
            option_table(),
            kNotes};
  }

  int run() override {
    require_consistent();
    require_plausible_input(job_.input);
    const ThreadLimit limit(threads_);
    const double start = monotonic_seconds();
    // Created first: a report that cannot be written is to be known before the work, not after it.
    std::optional<OutputFile> report_file;
    if (!report_path_.empty()) report_file.emplace(report_path_, job_.overwrite);

    Console console(quiet_ ? Verbosity::quiet : verbose_ ? Verbosity::verbose : Verbosity::normal);
    if (job_.options.deviation && !(job_.options.smooth.value > 0)) {
      console.warn("--deviation", {"has no effect without --smooth"});
    }
    if (redistance_given_ && !(job_.options.smooth.value > 0)) console.warn("--redistance", {"has no effect without --smooth"});
    const RepairReport report = clean(job_, console);
    console.end_stage();
    if (report_file) {
      write_text(report_file->fd(), report_path_, to_json(report));
      report_file->commit();
    }
    console.warn(report.input, report.warnings);
    print(report, monotonic_seconds() - start);
    if (!report.failure) return 0;
    print_error(*report.failure);
    return exit_code(report.failure->code());
  }

 private:
  std::vector<Option> option_table() {
    CleanOptions& o = job_.options;
    return {
        {"--output", 'o', "FILE", "Output",
         "Where to write: .stl, .stla (ASCII), .ply, .obj or .off; '-' is standard output, as binary STL.",
         store_text(job_.output)},
        {"--overwrite", 0, "", "Output", "Replace files that exist already.", switch_on(job_.overwrite)},
        {"--report", 0, "FILE", "Output", "Write a report of what was found and done, as JSON.",
         store_text(report_path_)},
        {"--json", 0, "", "Output", "Print that report on standard output instead of the table.",
         switch_on(json_)},
        {"--method", 0, "M", "Repair",
         "'local' mends what is broken and leaves the rest as it is, 'levelset' rebuilds the surface, 'auto' (default) chooses.",
         [&o](const GivenValue& v) { o.method = one_of<Method>(v, {"auto", "local", "levelset"}); }},
        {"--nested", 0, "N", "Repair",
         "What a body inside a body is: 'solid', 'cavity', or 'auto' (default): a cavity if it is oriented so.",
         [&o](const GivenValue& v) { o.nesting = one_of<Nesting>(v, {"auto", "solid", "cavity"}); }},
        {"--gap", 0, "L", "Repair", "Close cracks up to a width of L by joining the points on both sides.",
         [&o](const GivenValue& v) { o.gap = length_without_cells(v); }},
        {"--max-hole", 0, "L", "Openings", "Close holes up to a diameter of L; wider openings stay.",
         [&o](const GivenValue& v) { o.max_hole = length_without_cells(v); }},
        {"--keep-openings", 0, "", "Openings", "Close no opening: terrain and one-sided scans stay open sheets.",
         switch_on(o.keep_openings)},
        {"--thicken", 0, "T", "Openings", "Make a shell of thickness T about the surface, open or not.",
         [&o](const GivenValue& v) { o.thicken = length_without_cells(v); }},
        {"--keep-largest", 0, "", "Components", "Keep only the component with the largest volume.", switch_on(o.keep_largest)},
        {"--min-component", 0, "V", "Components",
         "Drop components with less volume than V, such as 0.5 or 1% (of the largest one's).",
         [&o](const GivenValue& v) { o.min_component = volume_limit(v); }},
        {"--recentre", 0, "", "Output", "Move the model to the origin: for coordinates too large for an STL.",
         switch_on(o.recentre)},
        {"--cell", 0, "L", "Resolution",
         "Side of the finest cells, such as 0.5 or 0.2%. Chosen from the model with 'auto', or when not given.",
         [&o](const GivenValue& v) {
           if (v.text != "auto") o.cell = length_without_cells(v);
         }},
        {"--resolution", 0, "N", "Resolution",
         "Cells along the longest side (8 to 100000), instead of --cell.",
         [&o](const GivenValue& v) { o.resolution = static_cast<int>(integer_within(v, 8, 100'000)); }},
        {"--adapt", 0, "TOL", "Resolution",
         "Take coarser cells where the distance is off by no more than TOL, such as 0.1h or 0.01.",
         [&o](const GivenValue& v) { o.adapt = positive_length(v); }},
        {"--cell-max", 0, "L", "Resolution", "With --adapt: the coarsest cells, such as 16h or 1%; 8h when not given.",
         [&o](const GivenValue& v) { o.cell_max = positive_length(v); }},
        {"--smooth", 0, "L", "Smoothing", "Remove waves shorter than L. The volume is kept.",
         [&o](const GivenValue& v) { o.smooth = positive_length(v); }},
        {"--deviation", 0, "T", "Smoothing", "Keep the smoothed surface within T of the repaired one.",
         [&o](const GivenValue& v) { o.deviation = positive_length(v); }},
        {"--redistance", 0, "M", "Smoothing",
         "What keeps distances while it smooths: 'closest' points (default), 'fmm', or the thesis' 'pde-weno5' and 'pde-first'.",
         [&o, this](const GivenValue& v) { o.redistance = redistance_method(v), redistance_given_ = true; }},
        {"--salvage", 0, "", "Broken files", "Take what a truncated or malformed file holds.",
         switch_on(job_.salvage)},
        {"--allow-invalid", 0, "", "Broken files",
         "Write the result even if it could not be verified. The exit code is still 5.",
         switch_on(job_.allow_invalid)},
        {"--threads", 0, "N", "Resources", "Use at most N threads. The result does not depend on it.",
         [this](const GivenValue& v) { threads_ = static_cast<int>(integer_within(v, 1, 4096)); }},
        {"--memory", 0, "SIZE", "Resources",
         "Plan to stay below SIZE bytes, such as 800M or 16G. Default: 4G.",
         [&o](const GivenValue& v) { o.memory_bytes = byte_count(v); }},
        {"--quiet", 'q', "", "Messages", "Print errors only.", switch_on(quiet_)},
        {"--verbose", 'v', "", "Messages", "Print details and what each stage cost.", switch_on(verbose_)},
        {"--help", 'h', "", "Messages", "Print this help.", [](const GivenValue&) {}},
        {"--version", 0, "", "Messages", "Print the version.", [](const GivenValue&) {}},
    };
  }

  void require_consistent() const {
    const auto refuse = [](const std::string& message, const std::string& hint) {
      throw Error(ErrorCode::usage, message, hint);
    };
    if (job_.output.empty()) {
      refuse("no output is named",
             fmt::format("add -o FILE, or look at the input with: burnish check {}", job_.input));
    }
    if (job_.options.cell && job_.options.resolution) {
      refuse("--cell and --resolution exclude each other", "give one of the two");
    }
    if (job_.options.cell_max && !job_.options.adapt) refuse("--cell-max needs --adapt", "for example --adapt 0.1h");
    if (job_.options.keep_openings && job_.options.max_hole) {
      refuse("--keep-openings and --max-hole exclude each other", "give one of the two");
    }
    if (job_.options.thicken && job_.options.keeps_openings()) {
      refuse("--thicken makes a closed shell: there are no openings to keep", "leave out one of the two");
    }
    if (job_.options.method == Method::local) require_local();
    if (job_.output == "-" && json_) {
      refuse("-o - and --json would both use standard output",
             "write the report to a file with --report FILE");
    }
    if (report_path_ == "-") refuse("--report needs a file's name", "--json prints the report");
    if (!report_path_.empty() && same_file(report_path_, job_.output)) {
      refuse(fmt::format("{}: --report and -o name the same file", report_path_), "");
    }
    if (job_.output == "-" && is_terminal(STDOUT_FILENO)) {
      refuse("-o - would print a binary file on the terminal", "redirect standard output, or name a file");
    }
    if (quiet_ && verbose_) refuse("-q and -v exclude each other", "");
    if (job_.output != "-") static_cast<void>(format_for_writing(job_.output));
  }

  // What only the level set can do, beside --method local.
  void require_local() const {
    const CleanOptions& o = job_.options;
    const std::string_view clash = o.smooth.value > 0 ? "--smooth" : o.thicken ? "--thicken" : o.cell ? "--cell" : o.resolution ? "--resolution" : o.adapt ? "--adapt" : "";
    if (clash.empty()) return;
    throw Error(ErrorCode::usage, fmt::format("{} is a matter of the level set, and --method local excludes it", clash), "leave out one of the two");
  }

  void print(const RepairReport& report, double seconds) const {
    if (json_) return write_stdout(to_json(report));
    if (quiet_) return;
    const std::string summary = clean_summary(report, seconds, verbose_);
    if (job_.output == "-")
      write_stderr(summary);
    else
      write_stdout(summary);
  }

  CleanJob job_;
  std::string report_path_;
  int threads_ = 0;
  bool json_ = false;
  bool quiet_ = false;
  bool verbose_ = false;
  bool redistance_given_ = false;
};

}  // namespace

std::unique_ptr<Command> make_clean_command() { return std::make_unique<CleanCommand>(); }

}  // namespace burnish
