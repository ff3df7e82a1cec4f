#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/io/marked_cells.h"
#include "burnish/io/mesh_io.h"
#include "burnish/pipeline/compare_files.h"
#include "commands.h"
#include "compare_summary.h"
#include "console.h"
#include "shared_rows.h"
#include "streams.h"
#include "suffixes.h"
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
  burnish compare scan.stl design.stl --align --aligned moved.stl
  burnish compare denoised.stl truth.stl --normals --input noisy.stl
)";

class CompareCommand : public Command {
 public:
  CommandLine command_line() override {
    return {"compare",
            "Says how far two surfaces are from each other, both ways, and where.",
            {"burnish compare A B [options]"},
            {{file("A", kSurfaceInputs), "STL, OBJ, PLY, OFF or 3MF file; the one that percentages refer to.", store_text(job_.a)},
             {file("B", kSurfaceInputs), "The other file; '-', for one of them, is standard input.", store_text(job_.b)}},
            option_table(),
            kNotes,
            &job_.unit};
  }

  int run() override {
    require_consistent();
    job_.align |= !job_.aligned.empty();
    for (const std::string& input : inputs()) require_plausible_input(input);
    if (truth_asked_) job_.truth = truth_;
    if (crease_angle_) job_.truth->crease_angle = *crease_angle_;
    job_.samples = samples_.value_or(truth_asked_ ? kTruthSamples : job_.samples);
    const ThreadLimit limit(threads_);
    Console console(quiet_ ? Verbosity::quiet : Verbosity::normal);
    if (job_.overwrite && job_.output.empty() && truth_.map.empty() && job_.aligned.empty()) console.warn("--overwrite", {"has no effect without --output, --map or --aligned"});
    const CompareResult result = compare_files(job_, console);
    console.end_stage();
    for (const ComparedFile& file : {result.a, result.b}) console.warn(file.file, file.warnings);
    if (result.truth && result.truth->input) console.warn(result.truth->input->file.file, result.truth->input->file.warnings);
    if (result.truth && result.truth->floor) console.warn(result.truth->floor->file.file, result.truth->floor->file.warnings);
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
        {"--max", 0, length("L"), "Options", "Exit 1 if a sample is farther than L from the other surface.",
         [this](const GivenValue& v) { job_.max = length_without_cells(v); }},
        {"--output", 'o', file("OUT", kMarkedOutputs), "Options",
         "Write A with its signed deviation from B: .vtp (ParaView) or .ply (MeshLab).", store_text(job_.output)},
        {"--align", 0, "", "Options", "First move A onto B: rotate and shift it, so that they fit best.", switch_on(job_.align)},
        {"--aligned", 0, file("FILE", kSurfaceOutputs), "Options", "Write A as it was moved: .stl, .ply, .obj, .off or .3mf; implies --align.", store_text(job_.aligned)},
        {"--overwrite", 0, "", "Options", "Replace OUT if it exists already.", switch_on(job_.overwrite)},
        units_row("Options", job_.unit),
        {"--samples", 0, count("N"), "Options",
         "Take N samples by area, and up to N vertices, of each; 200000 when not given, 60000 with --normals.",
         [this](const GivenValue& v) { samples_ = integer_within(v, 1, 20'000'000); }},
        {"--exact", 0, "", "Options", "Take every distance by exact arithmetic: about 15 times slower.",
         switch_on(job_.exact)},
        {"--json", 0, "", "Options", "Print the result as JSON.", switch_on(json_)},
        salvage_row("Options", job_.salvage),
        threads_row("Options", threads_),
        quiet_row("Options", quiet_, true),
        help_row("Options"),
        {"--normals", 0, "", "A against a truth", "Take B for what A should be: errors of normals and distance, near creases and elsewhere.",
         switch_on(truth_asked_)},
        {"--input", 0, file("FILE", kSurfaceInputs), "A against a truth", "What A was made from: its volume is compared as well.", store_text(truth_.input)},
        {"--floor", 0, file("FILE", kSurfaceInputs), "A against a truth",
         "What the same program makes of B itself: the error that is not the noise's, beside A's.", store_text(truth_.floor)},
        {"--crease-angle", 0, number("DEG"), "A against a truth", "Edges of B under more than this are creases; 30 when not given.",
         [this](const GivenValue& v) { crease_angle_ = degrees(v); }},
        {"--crease-width", 0, length("L"), "A against a truth", "How near to a crease is near; B's mean edge when not given.",
         [this](const GivenValue& v) { truth_.crease_width = length_without_cells(v); }},
        {"--map", 0, file("OUT", {".vtp"}), "A against a truth", "Write A with the errors of its facets (.vtp).", store_text(truth_.map)},
    };
  }

  static double degrees(const GivenValue& v) {
    const double angle = non_negative_number(v);
    if (angle <= 180) return angle;
    throw Error(ErrorCode::usage, fmt::format("{} {}: expected an angle of 0 to 180 degrees", v.name, v.text), "creases of parts: 30");
  }

  std::vector<std::string> inputs() const {
    std::vector<std::string> files{job_.a, job_.b};
    for (const std::string& more : {truth_.input, truth_.floor})
      if (!more.empty()) files.push_back(more);
    return files;
  }

  // Before anything is read.
  void require_consistent() const {
    require_one_standard_input();
    require_truth();
    for (const auto& [option, output] : {std::pair{"--output", job_.output}, std::pair{"--map", truth_.map}})
      if (!output.empty()) static_cast<void>(marked_format_for_writing(output)), require_no_input(option, output);
    if (!job_.aligned.empty()) static_cast<void>(format_for_writing(job_.aligned)), require_no_input("--aligned", job_.aligned);
    if (const auto two = named_twice({{"--output", job_.output}, {"--aligned", job_.aligned}, {"--map", truth_.map}}))
      throw Error(ErrorCode::usage, fmt::format("{}: both {} and {}", two->front().path, two->front().by, two->back().by), "give one of them another name");
  }

  void require_one_standard_input() const {
    if (job_.a == "-" && job_.b == "-")
      throw Error(ErrorCode::usage, "A and B are both '-': standard input holds one file", "name the other file");
    const std::vector<std::string> files = inputs();
    if (std::count(files.begin(), files.end(), "-") > 1)
      throw Error(ErrorCode::usage, "several files are '-': standard input holds one", "name the others");
  }

  void require_truth() const {
    if (truth_asked_) return;
    for (const auto& [option, given] : {std::pair{"--input", !truth_.input.empty()}, std::pair{"--floor", !truth_.floor.empty()},
                                        std::pair{"--map", !truth_.map.empty()}, std::pair{"--crease-angle", crease_angle_.has_value()},
                                        std::pair{"--crease-width", truth_.crease_width.has_value()}})
      if (given) throw Error(ErrorCode::usage, fmt::format("{} needs --normals", option), "add --normals: B is then the truth");
  }

  // An output that looks at a model must not take its place.
  void require_no_input(std::string_view option, const std::string& output) const {
    for (const std::string& input : inputs()) {
      if (!same_file(output, input)) continue;
      throw Error(ErrorCode::usage, fmt::format("{}: {} names an input", output, option),
                  "what is written is no replacement for the model: give another name");
    }
  }

  static constexpr std::size_t kTruthSamples = 60'000;

  CompareJob job_;
  TruthJob truth_;
  std::optional<double> crease_angle_;
  std::optional<std::size_t> samples_;
  bool truth_asked_ = false;
  int threads_ = 0;
  bool json_ = false;
  bool quiet_ = false;
};

}  // namespace

std::unique_ptr<Command> make_compare_command() { return std::make_unique<CompareCommand>(); }

}  // namespace burnish
