#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/pipeline/check.h"
#include "burnish/pipeline/report.h"
#include "commands.h"
#include "console.h"
#include "streams.h"
#include "summary.h"
#include "values.h"

namespace burnish {
namespace {

constexpr std::string_view kNotes =
    R"(Exit codes: 0 a valid solid, 1 not a valid solid, 2 usage, 3 input unreadable.

Example:
  burnish check part.stl && echo printable
)";

class CheckCommand : public Command {
 public:
  CommandLine command_line() override {
    return {"check",
            "Says what is wrong with a triangle file, and whether it is a valid solid:\n"
            "closed, 2-manifold, oriented outwards, free of self-intersections.",
            {"burnish check FILE [options]"},
            {{"FILE", "STL, OBJ, PLY or OFF file; '-' is standard input.", store_text(input_)}},
            option_table(),
            kNotes};
  }

  int run() override {
    require_plausible_input(input_);
    const ThreadLimit limit(threads_);
    Console console(quiet_ ? Verbosity::quiet : Verbosity::normal);
    const CheckResult result = check(input_, salvage_, console);
    console.end_stage();
    console.warn(result.input, result.warnings);
    if (json_) {
      write_stdout(to_json(result.defects, result.input, result.input_format, result.warnings));
    } else if (!quiet_) {
      write_stdout(check_summary(result));
    }
    return result.valid_solid ? 0 : exit_code(ErrorCode::answer_is_no);
  }

 private:
  std::vector<Option> option_table() {
    return {
        {"--json", 0, "", "Options", "Print the result as JSON.", switch_on(json_)},
        {"--salvage", 0, "", "Options", "Take what a truncated or malformed file holds.",
         switch_on(salvage_)},
        {"--threads", 0, "N", "Options", "Use at most N threads. The result does not depend on it.",
         [this](const GivenValue& v) { threads_ = static_cast<int>(integer_within(v, 1, 4096)); }},
        {"--quiet", 'q', "", "Options", "Print errors only: the exit code is the answer.", switch_on(quiet_)},
        {"--help", 'h', "", "Options", "Print this help.", [](const GivenValue&) {}},
    };
  }

  std::string input_;
  int threads_ = 0;
  bool json_ = false;
  bool salvage_ = false;
  bool quiet_ = false;
};

}  // namespace

std::unique_ptr<Command> make_check_command() { return std::make_unique<CheckCommand>(); }

}  // namespace burnish
