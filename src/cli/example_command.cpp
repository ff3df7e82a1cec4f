#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <limits>
#include <optional>

#include "burnish/core/error.h"
#include "burnish/io/mesh_io.h"
#include "burnish/io/output_file.h"
#include "burnish/surface/example_shapes.h"
#include "commands.h"
#include "console.h"
#include "shared_rows.h"
#include "streams.h"
#include "suffixes.h"
#include "suggest.h"
#include "values.h"

namespace burnish {
namespace {

constexpr std::string_view kNotes =
    R"(Shapes: sphere (550 facets), vase (1174), knot (76,428), nozzle (496,658, as
from x-ray tomography). The same options give the same bytes everywhere.

Example:
  burnish example knot --noise 0.3 --holes 5 -o knot.stl --truth truth.stl
)";

ExampleShape shape_named(const GivenValue& given) {
  if (is_listed(given)) return one_of<ExampleShape>(given);
  const auto near = nearest(std::string(given.text), {given.words.begin(), given.words.end()});
  throw Error(
      ErrorCode::usage, fmt::format("unknown shape '{}'", given.text),
      near ? fmt::format("did you mean '{}'?", *near) : fmt::format("the shapes are {}", fmt::join(given.words, ", ")));
}

// A mesh on its way to a file or to standard output. Nothing is seen of it before `commit`.
class MeshOutput {
 public:
  MeshOutput(const std::string& path, bool overwrite) : path_(path) {
    if (path != "-") {
      options_.format = format_for_writing(path);
      file_.emplace(path, overwrite);
    }
  }
  void write(const TriangleSoup& soup) const {
    if (file_)
      write_mesh(file_->fd(), path_, soup, options_);
    else
      write_mesh(STDOUT_FILENO, "standard output", soup, options_);
  }
  void commit() {
    if (file_) file_->commit();
  }

 private:
  std::string path_;
  MeshWriteOptions options_;
  std::optional<OutputFile> file_;
};

class ExampleCommand : public Command {
 public:
  CommandLine command_line() override {
    return {"example",
            "Makes a model with known defects, to try Burnish on.",
            {"burnish example sphere|vase|knot|nozzle -o FILE [options]"},
            {{word("SHAPE", {"sphere", "vase", "knot", "nozzle"}), "sphere, vase, knot or nozzle.",
              [this](const GivenValue& v) { shape_ = shape_named(v); }}},
            option_table(),
            kNotes};
  }

  int run() override {
    require_consistent();
    Console console(quiet_ ? Verbosity::quiet : Verbosity::normal);
    MeshOutput output(output_, overwrite_);
    std::optional<MeshOutput> truth;
    if (!truth_.empty()) truth.emplace(truth_, overwrite_);

    console.begin_stage("making the model");
    const Example example = make_example(shape_, options_);
    console.check();
    console.begin_stage("writing");
    output.write(example.dirty);
    if (truth) truth->write(example.truth);
    console.check();
    output.commit();
    if (truth) truth->commit();
    console.say(fmt::format("{}: {} facets\n", output_, example.dirty.facets.size()));
    if (truth) console.say(fmt::format("{}: {} facets\n", truth_, example.truth.facets.size()));
    return 0;
  }

 private:
  std::vector<Option> option_table() {
    ExampleOptions& o = options_;
    constexpr auto kMaxSeed = std::numeric_limits<std::uint64_t>::max();
    return {
        {"--noise", 0, number("S"), "Dirt", "Standard deviation of the noise along the normals, in mean edges.",
         [&o](const GivenValue& v) { o.noise = non_negative_number(v); }},
        {"--holes", 0, count("N"), "Dirt", "Number of round holes.",
         [&o](const GivenValue& v) { o.holes = static_cast<int>(integer_within(v, 0, 10'000)); }},
        {"--seed", 0, count("K"), "Dirt", "Another seed (default: 1) gives other noise and other holes.",
         [&o](const GivenValue& v) { o.seed = integer_within(v, 0, kMaxSeed); }},
        {"--output", 'o', file("FILE", kSurfaceOutputs), "Output",
         "Where to write: .stl, .stla (ASCII), .ply, .obj, .off or .3mf; '-' is standard output, as binary STL.",
         store_text(output_)},
        {"--truth", 0, file("FILE", kSurfaceOutputs), "Output", "Write the clean shape here.", store_text(truth_)},
        {"--overwrite", 0, "", "Output", "Replace files that exist already.", switch_on(overwrite_)},
        quiet_row("Messages", quiet_),
        help_row("Messages"),
    };
  }

  void require_consistent() const {
    if (output_.empty()) throw Error(ErrorCode::usage, "no output is named", "add -o FILE");
    if (truth_ == "-") throw Error(ErrorCode::usage, "--truth needs a file's name", "only -o can be '-'");
    namespace fs = std::filesystem;
    if (!truth_.empty() &&
        fs::absolute(truth_).lexically_normal() == fs::absolute(output_).lexically_normal()) {
      throw Error(ErrorCode::usage, fmt::format("{}: --truth and -o name the same file", truth_), "give one of them another name");
    }
    if (output_ == "-" && is_terminal(STDOUT_FILENO)) {
      throw Error(ErrorCode::usage, "-o - would print a binary file on the terminal",
                  "redirect standard output, or name a file");
    }
  }

  ExampleShape shape_ = ExampleShape::sphere;
  ExampleOptions options_;
  std::string output_;
  std::string truth_;
  bool overwrite_ = false;
  bool quiet_ = false;
};

}  // namespace

std::unique_ptr<Command> make_example_command() { return std::make_unique<ExampleCommand>(); }

}  // namespace burnish
