#include <fmt/format.h>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/io/marked_cells.h"
#include "burnish/pipeline/compare_files.h"
#include "commands.h"
#include "compare_summary.h"
#include "console.h"
#include "streams.h"
#include "values.h"

namespace burnish {
namespace {

constexpr std::string_view kNotes =
    R"(Lengths: a number in the model's units, or 0.2% of the diagonal of A's box.

Exit codes: 0 compared, and within --max if that is given; 1 farther apart than
--max; 2 usage, 3 input unreadable, 4 output unwritable, 130 interrupted.

Examples:
  burnish compare part.stl repaired.stl
  burnish compare part.stl repaired.stl --max 0.1% -q && echo the same
  burnish compare scan.stl design.stl --output deviation.vtp
)";

class CompareCommand : public Command {
 public:
  CommandLine command_line() override {
    return {"compare",
            "Says how far two surfaces are from each other, both ways, and where.",
            {"burnish compare A B [options]"},
            {{"A", "STL, OBJ, PLY or OFF file; the one that percentages refer to.", store_text(job_.a)},
             {"B", "The other file; '-', for one of them, is standard input.", store_text(job_.b)}},
            option_table(),
            kNotes};
  }

  int run() override {
    require_consistent();
    for (const std::string& input : {job_.a, job_.b}) require_plausible_input(input);
    const ThreadLimit limit(threads_);
    Console console(quiet_ ? Verbosity::quiet : Verbosity::normal);
    if (job_.overwrite && job_.output.empty()) console.warn("--overwrite", {"has no effect without --output"});
    const CompareResult result = compare_files(job_, console);
    console.end_stage();
    for (const ComparedFile& file : {result.a, result.b}) console.warn(file.file, file.warnings);
    if (json_) {
      write_stdout(to_json(result));
    } else if (!quiet_) {
      write_stdout(compare_summary(result));
    }
    return result.within_limit() ? 0 : exit_code(ErrorCode::answer_is_no);
  }

 private:
  std::vector<Option> option_table() {
    return {
        {"--max", 0, "L", "Options", "Exit 1 if a sample is farther than L from the other surface.",
         [this](const GivenValue& v) { job_.max = length_without_cells(v); }},
        {"--output", 'o', "OUT", "Options",
         "Write A with its signed deviation from B: .vtp (ParaView) or .ply (MeshLab).", store_text(job_.output)},
        {"--overwrite", 0, "", "Options", "Replace OUT if it exists already.", switch_on(job_.overwrite)},
        {"--samples", 0, "N", "Options",
         "Take N samples by area, and up to N vertices, of each; 200000 when not given.",
         [this](const GivenValue& v) { job_.samples = integer_within(v, 1, 20'000'000); }},
        {"--exact", 0, "", "Options", "Take every distance by exact arithmetic: about 15 times slower.",
         switch_on(job_.exact)},
        {"--json", 0, "", "Options", "Print the result as JSON.", switch_on(json_)},
        {"--salvage", 0, "", "Options", "Take what a truncated or malformed file holds.",
         switch_on(job_.salvage)},
        {"--threads", 0, "N", "Options", "Use at most N threads. The result does not depend on it.",
         [this](const GivenValue& v) { threads_ = static_cast<int>(integer_within(v, 1, 4096)); }},
        {"--quiet", 'q', "", "Options", "Print errors only: the exit code is the answer.", switch_on(quiet_)},
        {"--help", 'h', "", "Options", "Print this help.", [](const GivenValue&) {}},
    };
  }

  // Before anything is read; an output that looks at a model must not take its place.
  void require_consistent() const {
    if (job_.a == "-" && job_.b == "-") {
      throw Error(ErrorCode::usage, "A and B are both '-': standard input holds one file", "name the other file");
    }
    if (job_.output.empty()) return;
    static_cast<void>(marked_format_for_writing(job_.output));
    for (const std::string& input : {job_.a, job_.b}) {
      if (!same_file(job_.output, input)) continue;
      throw Error(ErrorCode::usage, fmt::format("{}: --output names an input", job_.output),
                  "the coloured surface is no replacement for the model: give another name");
    }
  }

  CompareJob job_;
  int threads_ = 0;
  bool json_ = false;
  bool quiet_ = false;
};

}  // namespace

std::unique_ptr<Command> make_compare_command() { return std::make_unique<CompareCommand>(); }

}  // namespace burnish
