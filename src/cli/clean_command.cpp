#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <functional>
#include <iterator>
#include <utility>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/core/timer.h"
#include "burnish/io/mesh_io.h"
#include "burnish/pipeline/clean.h"
#include "burnish/pipeline/html_report.h"
#include "burnish/pipeline/sweep.h"
#include "batch_files.h"
#include "batch_run.h"
#include "clean_options.h"
#include "commands.h"
#include "console.h"
#include "outcome.h"
#include "report_file.h"
#include "shared_rows.h"
#include "streams.h"
#include "suffixes.h"
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
  burnish parts/*.stl -o clean/ --jobs auto --report reports/
  burnish --from-field ct.vti --iso 300 -o bone.stl --smooth 4h --mode volume

Exit codes: 0 done and verified, 2 usage, 3 input unreadable, 4 output
unwritable, 5 a guarantee could not be met, 6 memory limit, 7 time limit,
70 a bug of Burnish, 130 interrupted; of several inputs, the highest of theirs.
)";

constexpr std::array kSnapshotPercents{25, 50, 75};

class CleanCommand : public Command {
 public:
  CommandLine command_line() override {
    return {"clean",
            "Repairs a triangle file: the result is closed, oriented and free of\n"
            "self-intersections, and is verified before it gets its name.",
            {"burnish IN -o OUT [options]", "burnish IN IN... -o FOLDER/ [options]"},
            {{file("IN", kSurfaceOrVolumeInputs), "STL, OBJ, PLY, OFF or 3MF file, or a volume (.vti, .nrrd), or several of them; '-' is standard input.", add_input(inputs_), true}},
            option_table(),
            kNotes,
            &job_.options.unit};
  }

  int run() override {
    const bool several = inputs_.size() > 1;
    if (several) require_place();
    const std::string snapshots = snapshots_, summary = several ? file_for_all(report_path_, "summary.json") : "";
    PlacedFiles files(inputs_, {{"-o", &job_.output, ""}, {"--report", &report_path_, ".json"}, {"--html", &html_path_, ".html"}}, several ? other_files(summary) : std::vector<OtherFile>{});
    const auto take = [&](std::size_t run) {
      job_.input = inputs_[run];
      files.take(run);
      if (several && !snapshots.empty()) snapshots_ = snapshot_folder(snapshots, job_.input);
    };
    for (std::size_t run = 0; run < inputs_.size(); ++run) take(run), require_consistent();
    files.make_folders();
    warn_of_idle_options();
    if (several) return run_several(take, files.of_option(0), summary);
    return clean_one(verbosity(), {threads_, 1}, [this](const RepairReport& r, double seconds) { print(r, seconds); });
  }

 private:
  void require_place() const {
    if (job_.output.empty())
      throw Error(ErrorCode::usage, fmt::format("unexpected argument '{}'", inputs_[1]), fmt::format("the output is named with -o: -o {}; several inputs need a folder for theirs: -o out/", inputs_[1]));
  }

  int run_several(const std::function<void(std::size_t run)>& take, const std::vector<std::string>& outputs, const std::string& summary) {
    return run_batch({.command = "clean",
                      .inputs = inputs_,
                      .outputs = outputs,
                      .summary = summary,
                      .overwrite = job_.overwrite,
                      .jobs = jobs_,
                      .threads = threads_,
                      .verbosity = verbosity(),
                      .json = json_,
                      .unit = job_.options.unit,
                      .work = [&](std::size_t run, const Share& share, std::string& told) {
                        take(run);
                        return clean_one(verbosity() == Verbosity::normal ? Verbosity::brief : verbosity(), share, [&](const RepairReport& r, double seconds) {
                          told = to_json(r);
                          if (verbose_ && !json_) write_stdout(clean_summary(r, seconds, true) + "\n");
                        });
                      }});
  }

  Verbosity verbosity() const { return quiet_ ? Verbosity::quiet : verbose_ ? Verbosity::verbose : Verbosity::normal; }

  // What several inputs are written to besides those.
  std::vector<OtherFile> other_files(const std::string& summary) const {
    std::vector<OtherFile> files;
    if (!summary.empty()) files.push_back({"--report", summary, "the summary"});
    if (snapshots_.empty()) return files;
    for (const std::string& input : inputs_)
      for (const int percent : kSnapshotPercents)
        files.push_back({"--snapshots", snapshot_file(snapshot_folder(snapshots_, input), file_for(job_.output, input, ""), percent), input});
    return files;
  }

  static std::string snapshot_folder(const std::string& given, const std::string& input) {
    return (std::filesystem::path(given) / std::filesystem::path(input).filename()).string();
  }

  void warn_of_idle_options() const {
    Console console(verbosity());
    for (const std::string& name : idle_options(job_.options)) console.warn(name, {"has no effect without --smooth"});
  }

  // `tell` is called between the warnings and the error.
  int clean_one(Verbosity verbosity, const Share& share, const std::function<void(const RepairReport&, double seconds)>& tell) {
    require_plausible_input(job_.input);
    const ThreadLimit limit(share.threads);
    job_.options.memory_shares = share.of_memory;
    const double start = monotonic_seconds();
    ReportFile report_file(report_path_, job_.overwrite), page(html_path_, job_.overwrite);
    Console console(verbosity);
    if (time_limit_ > 0) console.stop_after(time_limit_);
    CleanSurfaces surfaces;
    const RepairReport report = !snapshots_.empty() ? clean_with_snapshots(console) : page.wanted() ? clean(job_, surfaces, console) : clean(job_, console);
    if (page.wanted()) {
      console.begin_stage("making the page");
      page.write(html_report(report, surfaces));  // no interrupt ends it: the result has its name already
    }
    console.end_stage();
    if (report_file.wanted()) report_file.write(to_json(report));
    console.warn(report.input, report.warnings);
    tell(report, monotonic_seconds() - start);
    return end_with(report.failure);
  }

  std::vector<Option> option_table() {
    std::vector<Option> table = {
        {"--output", 'o', file("FILE", kSurfaceOutputs), "Output",
         "Where to write: .stl, .stla (ASCII), .ply, .obj, .off or .3mf; '-' is standard output, as binary STL. A folder (out/) or a pattern (out/{}.ply), where {} is the input's name, takes one for each input.",
         store_text(job_.output)},
        {"--overwrite", 0, "", "Output", "Replace files that exist already.", switch_on(job_.overwrite)},
        {"--snapshots", 0, folder("DIR"), "Output", "With --smooth L: also write the surface smoothed by a quarter, a half and three quarters of L, as DIR/smooth-25 and so on.",
         store_text(snapshots_)},
        {"--report", 0, file("FILE", kReports), "Output", "Write a report of what was found and done, as JSON; in a folder or by a pattern, one for each input and a summary.json.",
         store_text(report_path_)},
        {"--html", 0, file("FILE", kPages), "Output", "Write a page to look at: both surfaces in 3D, what was wrong and where, and all figures. In a folder or by a pattern, one for each input.",
         store_text(html_path_)},
        {"--json", 0, "", "Output", "Print that report on standard output instead of the table.",
         switch_on(json_)},
        salvage_row("Broken files", job_.salvage),
        {"--allow-invalid", 0, "", "Broken files",
         "Write the result even if it could not be verified. The exit code is still 5.",
         switch_on(job_.allow_invalid)},
        threads_row("Resources", threads_),
        jobs_row("Resources", jobs_),
        {"--time-limit", 0, number("S"), "Resources", "End the run, of each input, after S seconds, with exit code 7 and nothing written.",
         [this](const GivenValue& v) { time_limit_ = positive_number(v); }},
        quiet_row("Messages", quiet_),
        {"--verbose", 'v', "", "Messages", "Print details and what each stage cost.", switch_on(verbose_)},
        help_row("Messages"),
        {"--version", 0, "", "Messages", "Print the version, and what it was built from and with; as JSON with --json.", [](const GivenValue&) {}},
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
    require_page();
    require_distinct_files();
    if (job_.output == "-" && is_terminal(STDOUT_FILENO)) {
      refuse("-o - would print a binary file on the terminal", "redirect standard output, or name a file");
    }
    if (quiet_ && verbose_) refuse("-q and -v exclude each other", "leave one of the two out");
    if (job_.output != "-") static_cast<void>(format_for_writing(job_.output));
  }

  void require_page() const {
    if (html_path_.empty()) return;
    const auto refuse = [](const std::string& message, const std::string& hint) { throw Error(ErrorCode::usage, message, hint); };
    if (html_path_ == "-") refuse("--html needs a file's name", "for example --html report.html");
    if (!snapshots_.empty()) refuse("--html and --snapshots exclude each other", "a page shows one result: leave one of them out");
  }

  // Only the result may replace the input.
  void require_distinct_files() const {
    std::vector<NamedFile> files;
    if (!snapshots_.empty())
      for (const int percent : kSnapshotPercents) files.push_back({"--snapshots", snapshot_file(snapshots_, job_.output, percent)});
    files.insert(files.end(), {{"--html", html_path_}, {"--report", report_path_}, {"-o", job_.output}, {"the input", job_.input}});
    if (const auto two = named_twice(files); two && two->front().by != "-o")
      throw Error(ErrorCode::usage, fmt::format("{}: {} and {} name the same file", two->front().path, two->front().by, two->back().by), "give one of them another name");
  }

  static std::string snapshot_file(const std::string& folder, const std::string& output, int percent) {
    namespace fs = std::filesystem;
    return (fs::path(folder) / fmt::format("smooth-{}{}", percent, fs::path(output).extension().string())).string();
  }

  // Snapshots that could not be made are warned of; what counts is the result.
  RepairReport clean_with_snapshots(Console& console) const {
    namespace fs = std::filesystem;
    std::error_code error;
    fs::create_directories(snapshots_, error);
    if (error) throw Error(ErrorCode::unwritable_output, fmt::format("{}: cannot be made: {}", snapshots_, error.message()), "name another folder for --snapshots");
    std::vector<SweepStep> steps;
    steps.reserve(std::size(kSnapshotPercents) + 1);
    for (const int percent : kSnapshotPercents) steps.push_back({Length{0.01 * percent * job_.options.smooth.value, job_.options.smooth.unit}, snapshot_file(snapshots_, job_.output, percent)});
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
  std::vector<std::string> inputs_;
  Jobs jobs_;
  std::string report_path_;
  std::string html_path_;
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
