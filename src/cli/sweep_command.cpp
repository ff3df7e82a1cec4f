#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/io/mesh_io.h"
#include "burnish/pipeline/sweep.h"
#include "clean_options.h"
#include "commands.h"
#include "console.h"
#include "outcome.h"
#include "report_file.h"
#include "shared_rows.h"
#include "streams.h"
#include "suffixes.h"
#include "values.h"

namespace burnish {
namespace {

constexpr std::string_view kNotes =
    R"(In the output's name, {} stands for each length as it was given.

Examples:
  burnish sweep scan.stl --smooth 0.1,0.2,0.4 -o out/{}.stl
  burnish sweep scan.stl --smooth 0.2%,0.5% --mode volume -o scan-{}.ply --json

Exit codes: 0 all done and verified, 2 usage, 3 input unreadable, 4 output
unwritable, 5 a guarantee could not be met for some of them, 6 memory limit,
7 time limit, 130 interrupted.
)";

class SweepCommand : public Command {
 public:
  CommandLine command_line() override {
    return {"sweep",
            "Repairs a triangle file once and smooths it at several strengths.",
            {"burnish sweep IN --smooth L,L,... -o OUT-{}.stl [options]"},
            {{file("IN", kSurfaceInputs), "STL, OBJ, PLY, OFF or 3MF file; '-' is standard input.", store_text(job_.input)}},
            option_table(),
            kNotes,
            &job_.options.unit};
  }

  int run() override {
    require_consistent();
    require_plausible_input(job_.input);
    const ThreadLimit limit(threads_);
    ReportFile report_file(report_path_, job_.overwrite);
    Console console(quiet_ ? Verbosity::quiet : Verbosity::normal);
    if (time_limit_ > 0) console.stop_after(time_limit_);
    const std::vector<RepairReport> reports = sweep(job_, steps_, console);
    console.end_stage();
    if (report_file.wanted()) report_file.write(json_of(reports));
    return tell(reports, console);
  }

 private:
  std::vector<Option> option_table() {
    std::vector<Option> table = {
        {"--output", 'o', file("PATTERN", kSurfaceOutputs), "Output", "Where to write: a name with {} in it, which each length takes the place of.", store_text(pattern_)},
        {"--overwrite", 0, "", "Output", "Replace files that exist already.", switch_on(job_.overwrite)},
        {"--report", 0, file("FILE", kReports), "Output", "Write the runs' reports as a JSON array.", store_text(report_path_)},
        {"--json", 0, "", "Output", "Print them on standard output instead of the table.", switch_on(json_)},
        salvage_row("Broken files", job_.salvage),
        {"--allow-invalid", 0, "", "Broken files", "Write results even if they could not be verified. The exit code is still 5.",
         switch_on(job_.allow_invalid)},
        {"--threads", 0, count("N"), "Resources", "Use at most N threads. The results do not depend on it.",
         [this](const GivenValue& v) { threads_ = static_cast<int>(integer_within(v, 1, 4096)); }},
        {"--time-limit", 0, number("S"), "Resources", "End the run after S seconds, with exit code 7; what was verified by then stays.",
         [this](const GivenValue& v) { time_limit_ = positive_number(v); }},
        quiet_row("Messages", quiet_),
        help_row("Messages"),
    };
    table = with_clean_options(std::move(table), job_.options);
    for (Option& option : table) {
      if (option.name != "--smooth") continue;
      option.value = "L,L,...";
      option.help = "The lengths: what is smaller is removed.";
      option.set = [this](const GivenValue& v) { read_lengths(v); };
    }
    return table;
  }

  void read_lengths(const GivenValue& given) {
    std::set<std::string_view> seen;
    for (std::string_view rest = given.text;;) {
      const std::size_t comma = rest.find(',');
      const std::string_view text = rest.substr(0, comma);
      if (!seen.insert(text).second) throw Error(ErrorCode::usage, fmt::format("{} {}: {} is given twice", given.name, given.text, text), "leave one of the two out");
      steps_.push_back({positive_length(given.part(text)), std::string(text)});
      if (comma == rest.npos) return;
      rest.remove_prefix(comma + 1);
    }
  }

  // Gives each step its file.
  void require_consistent() {
    if (steps_.empty()) throw Error(ErrorCode::usage, "no length is given", "for example --smooth 0.1,0.2,0.4");
    const std::size_t hole = pattern_.find("{}");
    if (hole == pattern_.npos)
      throw Error(ErrorCode::usage, pattern_.empty() ? "no output is named" : fmt::format("{}: expected {{}} in the output's name, found none", pattern_),
                  "name it such as -o out/{}.stl");
    for (SweepStep& step : steps_) {
      step.output = std::string(pattern_).replace(hole, 2, step.output);
      static_cast<void>(format_for_writing(step.output));
    }
    if (report_path_ == "-") throw Error(ErrorCode::usage, "--report needs a file's name", "--json prints the reports");
    require_distinct_report();
    for (const SweepStep& step : steps_) {
      if ((step.smooth.unit == LengthUnit::cells) != (steps_.front().smooth.unit == LengthUnit::cells))
        throw Error(ErrorCode::usage, "--smooth: either all lengths of a sweep are in cells, or none is", "write all of them as 2h, or none");
      job_.options.smooth = step.smooth;
      burnish::require_consistent(job_.options);
    }
  }

  void require_distinct_report() const {
    if (report_path_.empty()) return;
    const auto clash_with = [&](std::string_view other) {
      throw Error(ErrorCode::usage, fmt::format("{}: {} and {} name the same file", report_path_, "--report", other), "give one of them another name");
    };
    if (std::any_of(steps_.begin(), steps_.end(), [&](const SweepStep& s) { return same_file(s.output, report_path_); })) clash_with("-o");
    if (same_file(report_path_, job_.input)) clash_with("the input");
  }

  static std::string json_of(const std::vector<RepairReport>& reports) {
    std::string text = "[\n";
    for (std::size_t i = 0; i < reports.size(); ++i) {
      std::string one = to_json(reports[i]);
      one.pop_back();  // the newline
      text += one + (i + 1 < reports.size() ? ",\n" : "\n");
    }
    return text + "]\n";
  }

  static std::string line_of(const RepairReport& r) {
    const std::string verdict = !r.failure ? "valid" : r.written ? "invalid" : "not written";
    return fmt::format("{:<28}{:>10}{:>12}{:>14.6g}{:>14.3g}{:>14.3g}\n", r.output, verdict, r.after.facets, r.after.volume, r.deviation.input_to_output.rms,
                       std::max(r.deviation.input_to_output.max, r.deviation.output_to_input.max));
  }

  int tell(const std::vector<RepairReport>& reports, Console& console) const {
    for (const RepairReport& r : reports) console.warn(r.output, r.warnings);
    if (json_) {
      write_stdout(json_of(reports));
    } else if (!quiet_) {
      write_stdout(fmt::format("{:<28}{:>10}{:>12}{:>14}{:>14}{:>14}\n", "", "", "facets", "volume", "rms", "max deviation"));
      for (const RepairReport& r : reports) write_stdout(line_of(r));
    }
    const auto failed = std::find_if(reports.begin(), reports.end(), [](const RepairReport& r) { return r.failure.has_value(); });
    return failed == reports.end() ? 0 : end_with(failed->failure);
  }

  CleanJob job_;
  std::vector<SweepStep> steps_;  // `output`: the length as given, until the pattern is known
  std::string pattern_;
  std::string report_path_;
  int threads_ = 0;
  double time_limit_ = 0;
  bool json_ = false;
  bool quiet_ = false;
};

}  // namespace

std::unique_ptr<Command> make_sweep_command() { return std::make_unique<SweepCommand>(); }

}  // namespace burnish
