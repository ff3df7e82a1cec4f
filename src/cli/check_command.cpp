#include <fmt/format.h>

#include <functional>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/io/marked_cells.h"
#include "burnish/pipeline/check.h"
#include "burnish/pipeline/report.h"
#include "batch_files.h"
#include "batch_run.h"
#include "commands.h"
#include "console.h"
#include "shared_rows.h"
#include "streams.h"
#include "suffixes.h"
#include "summary.h"
#include "values.h"

namespace burnish {
namespace {

constexpr std::string_view kNotes =
    R"(Exit codes: 0 a valid solid, 1 not a valid solid, or thinner somewhere than
--min-thickness; 2 usage, 3 input unreadable, 4 output unwritable; of several
files, the highest of theirs.

Examples:
  burnish check part.stl && echo printable
  burnish check parts/*.stl --jobs auto
  burnish check part.stl --output-defects defects.vtp
  burnish check part.stl --min-thickness 0.8 --output-thickness thickness.vtp
)";

constexpr std::size_t kPlaces = 3, kPlacesVerbose = 50;

class CheckCommand : public Command {
 public:
  CommandLine command_line() override {
    return {"check",
            "Says what is wrong with a triangle file and where, and whether it is a valid\n"
            "solid: closed, 2-manifold, oriented outwards, free of self-intersections.",
            {"burnish check FILE... [options]"},
            {{file("FILE", kSurfaceInputs), "STL, OBJ, PLY, OFF or 3MF file, or several; '-' is standard input.", add_input(inputs_), true}},
            option_table(),
            kNotes,
            &job_.unit};
  }

  int run() override {
    if (quiet_ && verbose_) throw Error(ErrorCode::usage, "-q and -v exclude each other", "leave one of the two out");
    job_.thickness |= job_.min_thickness || !job_.thickness_output.empty();
    if (job_.overwrite && job_.defects_output.empty() && job_.thickness_output.empty())
      Console(verbosity()).warn("--overwrite", {"has no effect without --output-defects or --output-thickness"});
    PlacedFiles files(inputs_, {{"--output-defects", &job_.defects_output, ".vtp"}, {"--output-thickness", &job_.thickness_output, ".vtp"}});
    const auto take = [&](std::size_t run) { job_.input = inputs_[run], files.take(run); };
    for (std::size_t run = 0; run < inputs_.size(); ++run) take(run), require_consistent();
    files.make_folders();
    return inputs_.size() == 1 ? run_one() : run_several(take);
  }

 private:
  int run_one() {
    return check_one(verbosity(), {threads_, 1}, [this](const CheckResult& result) {
      if (json_)
        write_stdout(to_json(result));
      else if (!quiet_)
        write_stdout(check_summary(result, verbose_ ? kPlacesVerbose : kPlaces));
    });
  }

  int run_several(const std::function<void(std::size_t run)>& take) {
    return run_batch({.command = "check",
                      .inputs = inputs_,
                      .outputs = {},
                      .summary = {},
                      .overwrite = job_.overwrite,
                      .jobs = jobs_,
                      .threads = threads_,
                      .verbosity = verbosity(),
                      .json = json_,
                      .unit = job_.unit,
                      .work = [&](std::size_t run, const Share& share, std::string& told) {
                        take(run);
                        return check_one(verbosity() == Verbosity::normal ? Verbosity::brief : verbosity(), share, [&](const CheckResult& result) {
                          told = to_json(result);
                          if (verbose_ && !json_) write_stdout(check_summary(result, kPlacesVerbose) + "\n");
                        });
                      }});
  }

  Verbosity verbosity() const { return quiet_ ? Verbosity::quiet : verbose_ ? Verbosity::verbose : Verbosity::normal; }

  int check_one(Verbosity verbosity, const Share& share, const std::function<void(const CheckResult&)>& tell) {
    require_plausible_input(job_.input);
    const ThreadLimit limit(share.threads);
    Console console(verbosity);
    const CheckResult result = check(job_, console);
    console.end_stage();
    console.warn(result.input, result.warnings);
    tell(result);
    return result.valid_solid && !result.too_thin() ? 0 : exit_code(ErrorCode::answer_is_no);
  }

  std::vector<Option> option_table() {
    return {
        {"--output-defects", 0, file("OUT", kMarkedOutputs), "Options",
         "Write the defects to look at: .vtp (ParaView) or .ply (MeshLab). A folder (out/) or a pattern (out/{}.ply) takes one for each file.", store_text(job_.defects_output)},
        {"--thickness", 0, "", "Options", "Measure how thick a valid solid is.", switch_on(job_.thickness)},
        {"--min-thickness", 0, length("L"), "Options", "List where it is thinner than L, and exit 1 if it is; implies --thickness.",
         [this](const GivenValue& v) { job_.min_thickness = length_without_cells(v); }},
        {"--output-thickness", 0, file("OUT", kMarkedOutputs), "Options", "Write the thickness at points: .vtp or .ply; implies --thickness. Of several files, a folder or a pattern.",
         store_text(job_.thickness_output)},
        {"--overwrite", 0, "", "Options", "Replace OUT if it exists already.", switch_on(job_.overwrite)},
        {"--json", 0, "", "Options", "Print the result as JSON.", switch_on(json_)},
        salvage_row("Options", job_.salvage),
        units_row("Options", job_.unit),
        threads_row("Options", threads_),
        jobs_row("Options", jobs_),
        quiet_row("Options", quiet_, true),
        {"--verbose", 'v', "", "Options", "Print up to 50 places of each kind of defect, not 3.",
         switch_on(verbose_)},
        help_row("Options"),
    };
  }

  // Before anything is read; an output that looks at the model must not take its place.
  void require_consistent() const {
    require_no_input("--output-defects", job_.defects_output, "the defects are no replacement for the model: give another name");
    require_no_input("--output-thickness", job_.thickness_output, "the thickness is no replacement for the model: give another name");
    if (named_twice({{"--output-defects", job_.defects_output}, {"--output-thickness", job_.thickness_output}}))
      throw Error(ErrorCode::usage, fmt::format("{}: both --output-defects and --output-thickness", job_.defects_output), "give one of them another name");
  }

  void require_no_input(std::string_view option, const std::string& output, const char* hint) const {
    if (output.empty()) return;
    static_cast<void>(marked_format_for_writing(output));
    if (same_file(output, job_.input)) throw Error(ErrorCode::usage, fmt::format("{}: {} names the input", output, option), hint);
  }

  CheckJob job_;
  std::vector<std::string> inputs_;
  Jobs jobs_;
  int threads_ = 0;
  bool json_ = false;
  bool quiet_ = false;
  bool verbose_ = false;
};

}  // namespace

std::unique_ptr<Command> make_check_command() { return std::make_unique<CheckCommand>(); }

}  // namespace burnish
