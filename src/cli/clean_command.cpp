#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/core/timer.h"
#include "burnish/io/mesh_io.h"
#include "burnish/pipeline/clean.h"
#include "burnish/pipeline/sweep.h"
#include "clean_options.h"
#include "commands.h"
#include "console.h"
#include "outcome.h"
#include "report_file.h"
#include "shared_rows.h"
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
  burnish scan.stl -o smooth.ply --smooth auto --report scan.json
  burnish dirty.stl -o - --resolution 400 -q > clean.stl
  burnish --from-field ct.vti --iso 300 -o bone.stl --smooth 4h --mode volume

Exit codes: 0 done and verified, 2 usage, 3 input unreadable, 4 output
unwritable, 5 a guarantee could not be met, 6 memory limit, 7 time limit,
70 a bug of Burnish, 130 interrupted.
)";

class CleanCommand : public Command {
 public:
  CommandLine command_line() override {
    return {"clean",
            "Repairs a triangle file: the result is closed, oriented and free of\n"
            "self-intersections, and is verified before it gets its name.",
            {"burnish IN -o OUT [options]"},
            {{"IN", "STL, OBJ, PLY, OFF or 3MF file, or a volume (.vti, .nrrd); '-' is standard input.", store_text(job_.input)}},
            option_table(),
            kNotes};
  }

  int run() override {
    require_consistent();
    require_plausible_input(job_.input);
    const ThreadLimit limit(threads_);
    const double start = monotonic_seconds();
    ReportFile report_file(report_path_, job_.overwrite);

    Console console(quiet_ ? Verbosity::quiet : verbose_ ? Verbosity::verbose : Verbosity::normal);
    for (const std::string& name : idle_options(job_.options)) console.warn(name, {"has no effect without --smooth"});
    if (time_limit_ > 0) console.stop_after(time_limit_);
    const RepairReport report = snapshots_.empty() ? clean(job_, console) : clean_with_snapshots(console);
    console.end_stage();
    if (report_file.wanted()) report_file.write(to_json(report));
    console.warn(report.input, report.warnings);
    print(report, monotonic_seconds() - start);
    return end_with(report.failure);
  }

 private:
  std::vector<Option> option_table() {
    std::vector<Option> table = {
        {"--output", 'o', "FILE", "Output",
         "Where to write: .stl, .stla (ASCII), .ply, .obj, .off or .3mf; '-' is standard output, as binary STL.",
         store_text(job_.output)},
        {"--overwrite", 0, "", "Output", "Replace files that exist already.", switch_on(job_.overwrite)},
        {"--snapshots", 0, "DIR", "Output", "With --smooth L: also write the surface smoothed by a quarter, a half and three quarters of L, as DIR/smooth-25 and so on.",
         store_text(snapshots_)},
        {"--report", 0, "FILE", "Output", "Write a report of what was found and done, as JSON.",
         store_text(report_path_)},
        {"--json", 0, "", "Output", "Print that report on standard output instead of the table.",
         switch_on(json_)},
        salvage_row("Broken files", job_.salvage),
        {"--allow-invalid", 0, "", "Broken files",
         "Write the result even if it could not be verified. The exit code is still 5.",
         switch_on(job_.allow_invalid)},
        threads_row("Resources", threads_),
        {"--time-limit", 0, "S", "Resources", "End the run after S seconds, with exit code 7 and nothing written.",
         [this](const GivenValue& v) { time_limit_ = positive_number(v); }},
        quiet_row("Messages", quiet_),
        {"--verbose", 'v', "", "Messages", "Print details and what each stage cost.", switch_on(verbose_)},
        help_row("Messages"),
        {"--version", 0, "", "Messages", "Print the version.", [](const GivenValue&) {}},
    };
    return with_clean_options(std::move(table), job_.options);
  }

  void require_consistent() const {
    const auto refuse = [](const std::string& message, const std::string& hint) {
      throw Error(ErrorCode::usage, message, hint);
    };
    if (job_.output.empty()) {
      refuse("no output is named",
             fmt::format("add -o FILE, or look at the input with: burnish check {}", job_.input));
    }
    burnish::require_consistent(job_.options);
    if (!snapshots_.empty() && !(job_.options.smooth.value > 0)) refuse("--snapshots needs a length", "for example --smooth 0.5%");
    if (!snapshots_.empty() && job_.output == "-") refuse("--snapshots and -o - exclude each other", "name the output");
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

  // Snapshots that could not be made are warned of; what counts is the result.
  RepairReport clean_with_snapshots(Console& console) const {
    namespace fs = std::filesystem;
    std::error_code error;
    fs::create_directories(snapshots_, error);
    if (error) throw Error(ErrorCode::unwritable_output, fmt::format("{}: cannot be made: {}", snapshots_, error.message()));
    std::vector<SweepStep> steps;
    for (const int percent : {25, 50, 75}) {
      const Length part{0.01 * percent * job_.options.smooth.value, job_.options.smooth.unit};
      steps.push_back({part, (fs::path(snapshots_) / fmt::format("smooth-{}{}", percent, fs::path(job_.output).extension().string())).string()});
    }
    steps.push_back({job_.options.smooth, job_.output});
    std::vector<RepairReport> reports = sweep(job_, steps, console);
    for (const RepairReport& snapshot : reports)
      if (&snapshot != &reports.back() && snapshot.failure) console.warn(snapshot.output, {std::string("was not written: ") + snapshot.failure->what()});
    return std::move(reports.back());
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
  std::string snapshots_;
  int threads_ = 0;
  bool json_ = false;
  bool quiet_ = false;
  bool verbose_ = false;
  double time_limit_ = 0;
};

}  // namespace

std::unique_ptr<Command> make_clean_command() { return std::make_unique<CleanCommand>(); }

}  // namespace burnish
