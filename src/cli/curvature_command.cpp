#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/core/timer.h"
#include "burnish/io/marked_cells.h"
#include "burnish/pipeline/curvature.h"
#include "commands.h"
#include "console.h"
#include "curvature_summary.h"
#include "outcome.h"
#include "shared_rows.h"
#include "suffixes.h"
#include "values.h"

namespace burnish {
namespace {

constexpr std::string_view kNotes =
    R"(Curvatures are positive where the solid is convex: a ball of radius R has k1 =
k2 = mean = 1/R. Facets are flat and meet in edges: to see the curvature of the
shape they stand for, smooth by a few edges. scripts/render --color draws OUT.

Lengths are in the model's units (0.5), in percent of the bounding box'
diagonal (0.2%), or in cells (2h).

Examples:
  burnish curvature part.stl --smooth 1%
  burnish curvature part.stl -o part.vtp --smooth 1% --resolution 300
  burnish curvature scan.stl -o scan.ply --at vertices --smooth 2%

Exit codes: 0 done, 2 usage, 3 input unreadable, 4 output unwritable, 5 the
input bounds no solid, 6 memory limit, 130 interrupted.
)";

class CurvatureCommand : public Command {
 public:
  CommandLine command_line() override {
    return {"curvature",
            "Takes mean, Gaussian and principal curvatures of the surface of a triangle\n"
            "file: reports how they are spread, and writes them for viewers.",
            {"burnish curvature IN [-o OUT] [options]"},
            {{file("IN", kSurfaceInputs), "STL, OBJ, PLY, OFF or 3MF file; '-' is standard input.", store_text(job_.input)}},
            option_table(),
            kNotes,
            &job_.options.unit};
  }

  int run() override {
    require_consistent();
    require_plausible_input(job_.input);
    const ThreadLimit limit(threads_);
    Console console(quiet_ ? Verbosity::quiet : Verbosity::normal);
    if (job_.overwrite && job_.output.empty()) console.warn("--overwrite", {"has no effect without -o"});
    const double start = monotonic_seconds();
    const CurvatureResult result = curvature(job_, console);
    tell(result, json_, quiet_, console, !result.failure, [&] { return curvature_summary(result, monotonic_seconds() - start); });
    return end_with(result.failure);
  }

 private:
  std::vector<Option> option_table() {
    CleanOptions& o = job_.options;
    return {
        {"--output", 'o', file("FILE", kMarkedOutputs), "Output", "Write the surface with its curvatures: .vtp (ParaView) or .ply (MeshLab).", store_text(job_.output)},
        {"--overwrite", 0, "", "Output", "Replace FILE if it exists already.", switch_on(job_.overwrite)},
        {"--json", 0, "", "Output", "Print the result as JSON.", switch_on(json_)},
        {"--at", 0, word("W", {"surface", "vertices"}), "Curvature", "At the vertices of the extracted 'surface' (default), or at the input's own 'vertices'.",
         [this](const GivenValue& v) { job_.at = one_of<CurvaturePoints>(v); }},
        {"--order", 0, word("N", {"2", "4", "6"}), "Curvature", "Order of accuracy on a smooth surface: 2, 4 (default) or 6. Higher ones look farther.",
         [this](const GivenValue& v) { job_.order = order(v); }},
        {"--method", 0, word("M", {"front", "nodal"}), "Curvature", "'front' (default): at points of the surface; 'nodal': of nodes, interpolated, for comparison.",
         [this](const GivenValue& v) { job_.method = one_of<CurvatureMethod>(v); }},
        {"--check", 0, count("N"), "Curvature", "Compare N points with polynomials fitted to the surface around them.",
         [this](const GivenValue& v) { job_.check = static_cast<std::size_t>(integer_within(v, 1, 100'000'000)); }},
        {"--smooth", 0, length("L"), "Curvature", "Remove waves shorter than L first, facets among them. The volume is kept.",
         [&o](const GivenValue& v) { o.smooth = positive_length(v); }},
        units_row("Resolution", o.unit),
        {"--cell", 0, length("L", {"auto"}), "Resolution", "Side of the cells, such as 0.5 or 0.2%. Chosen from the model with 'auto', or when not given.",
         [&o](const GivenValue& v) {
           if (!is_listed(v)) o.cell = length_without_cells(v);
         }},
        {"--resolution", 0, count("N"), "Resolution", "Cells along the longest side (8 to 100000), instead of --cell.",
         [&o](const GivenValue& v) { o.resolution = static_cast<int>(integer_within(v, 8, 100'000)); }},
        nested_row("Preparation", o),
        gap_row("Preparation", o),
        {"--max-hole", 0, length("L"), "Preparation", "Close holes up to a diameter of L; of a sheet with wider openings one side is inside.",
         [&o](const GivenValue& v) { o.max_hole = length_without_cells(v); }},
        salvage_row("Preparation", job_.salvage),
        threads_row("Resources", threads_),
        memory_row("Resources", o),
        quiet_row("Messages", quiet_),
        help_row("Messages"),
    };
  }

  static CurvatureOrder order(const GivenValue& v) {
    constexpr CurvatureOrder kOrders[] = {CurvatureOrder::second, CurvatureOrder::fourth, CurvatureOrder::sixth};
    if (is_listed(v)) return kOrders[place_among(v)];
    // No number is a misspelt other one: there is nothing to suggest.
    throw Error(ErrorCode::usage, fmt::format("{} {}: expected one of {}", v.name, v.text, fmt::join(v.words, ", ")), "higher orders look at more cells around: 4 is the default");
  }

  // Before anything is read; an output that looks at the model must not take its place.
  void require_consistent() const {
    const auto refuse = [](const std::string& message, const std::string& hint) { throw Error(ErrorCode::usage, message, hint); };
    if (job_.options.cell && job_.options.resolution) refuse("--cell and --resolution exclude each other", "give one of the two");
    if (job_.method == CurvatureMethod::nodal && job_.order == CurvatureOrder::sixth)
      refuse("--method nodal has orders 2 and 4 only", "give --order 4, or leave --method out");
    if (job_.method == CurvatureMethod::nodal && job_.check > 0) refuse("--method nodal has no k1 and k2 for --check", "leave one of the two out");
    if (job_.output.empty()) return;
    static_cast<void>(marked_format_for_writing(job_.output));
    if (same_file(job_.output, job_.input))
      refuse(fmt::format("{}: -o names the input", job_.output), "the coloured surface is no replacement for the model: give another name");
  }

  CurvatureJob job_;
  int threads_ = 0;
  bool json_ = false;
  bool quiet_ = false;
};

}  // namespace

std::unique_ptr<Command> make_curvature_command() { return std::make_unique<CurvatureCommand>(); }

}  // namespace burnish
