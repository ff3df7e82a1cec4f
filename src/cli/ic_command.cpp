#include <fmt/format.h>

#include <string>
#include <string_view>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/core/timer.h"
#include "burnish/pipeline/initial_condition.h"
#include "commands.h"
#include "console.h"
#include "ic_summary.h"
#include "outcome.h"
#include "shared_rows.h"
#include "suffixes.h"
#include "values.h"

namespace burnish {
namespace {

constexpr std::string_view kNotes =
    R"(The mesh of CASE is read, whatever its cells are; IN is repaired as 'burnish IN'
does, and clipped to them. A field that exists keeps its boundary conditions;
else they come from NAME.orig, else they are zeroGradient. Coordinates of IN are
the mesh's: --scale 0.001 for millimetres.

Examples:
  burnish ic drop.stl --case damBreak --field alpha.water --overwrite
  burnish ic drop.stl --case tank --scale 0.001 --dry-run
  burnish ic bubble.stl --case column --invert --also-phi psi
  burnish ic scan.stl --case tank --smooth 1% --patch-value inlet=1,top=0

Exit codes: 0 done, 2 usage, 3 input unreadable, 4 output unwritable, 5 the
input bounds no solid or is not in the mesh, 6 memory limit, 130 interrupted.
)";

class IcCommand : public Command {
 public:
  CommandLine command_line() override {
    return {"ic",
            "Writes the volume fractions of a triangle file's solid onto the mesh of an\n"
            "OpenFOAM case: the initial condition of a two-phase simulation.",
            {"burnish ic IN --case CASE [--field NAME] [options]"},
            {{file("IN", kSurfaceInputs), "STL, OBJ, PLY, OFF or 3MF file; '-' is standard input.", store_text(job_.input)}},
            option_table(),
            kNotes};
  }

  int run() override {
    require_consistent();
    require_plausible_input(job_.input);
    const ThreadLimit limit(threads_);
    Console console(quiet_ ? Verbosity::quiet : Verbosity::normal);
    const double start = monotonic_seconds();
    const InitialConditionResult result = initial_condition(job_, console);
    tell(result, json_, quiet_, console, !result.failure, [&] { return summary_of(result, monotonic_seconds() - start); });
    return end_with(result.failure);
  }

 private:
  std::vector<Option> option_table() {
    CleanOptions& o = job_.options;
    return {
        {"--case", 0, folder("CASE"), "Case", "The folder of the OpenFOAM case.", store_text(job_.case_folder)},
        {"--field", 0, "NAME", "Case", "Name of the field; alpha.water when not given.", [this](const GivenValue& v) { job_.field = field_name(v); }},
        {"--also-phi", 0, "NAME", "Case", "Write the signed distance from the surface, too, positive in the phase.", [this](const GivenValue& v) { job_.phi = field_name(v); }},
        {"--patch-value", 0, "NAME=V,...", "Case", "Fixed values of the field on patches.", [this](const GivenValue& v) { job_.patch_values = patch_values(v); }},
        {"--time", 0, number("T"), "Case", "The time folder; when not given, what the case starts from.", [this](const GivenValue& v) { job_.time = non_negative_number(v); }},
        {"--region", 0, "NAME", "Case", "The mesh of a region, if the case has several.", [this](const GivenValue& v) { job_.region = field_name(v); }},
        {"--overwrite", 0, "", "Case", "Replace the values of a field that exists already.", switch_on(job_.overwrite)},
        {"--dry-run", 0, "", "Case", "Compute and report, and write nothing.", switch_on(job_.dry_run)},
        {"--json", 0, "", "Case", "Print the result as JSON.", switch_on(json_)},
        {"--invert", 0, "", "Fractions", "The phase is outside the model: 1 there, and 0 inside.", switch_on(job_.invert)},
        {"--method", 0, word("M", {"auto", "exact", "linear", "curved"}), "Fractions",
         "'exact' (as 'auto', the default): facets clipped to cells; 'linear' and 'curved': of a level set, for comparison.",
         [this](const GivenValue& v) { job_.method = one_of<FractionMethod>(v); }},
        {"--scale", 0, number("S"), "Fractions", "Multiply the model's coordinates by S, such as 0.001 from millimetres to metres.",
         [this](const GivenValue& v) { job_.scale = positive_number(v); }},
        {"--smooth", 0, length("L"), "Preparation", "Remove waves shorter than L first. The volume is kept.", [&o](const GivenValue& v) { o.smooth = positive_length(v); }},
        nested_row("Preparation", o),
        gap_row("Preparation", o),
        {"--max-hole", 0, length("L"), "Preparation", "Close holes up to a diameter of L only; what is open then is refused.", [&o](const GivenValue& v) { o.max_hole = length_without_cells(v); }},
        {"--cell", 0, length("L", {"auto"}), "Preparation", "Side of a level set's cells: of --method linear and curved, or, with neither, one to rebuild the surface with.",
         [&o](const GivenValue& v) {
           if (!is_listed(v)) o.cell = length_without_cells(v);
         }},
        salvage_row("Preparation", job_.salvage),
        threads_row("Resources", threads_),
        memory_row("Resources", o),
        quiet_row("Messages", quiet_),
        help_row("Messages"),
    };
  }

  // A name that is a file's in the time folder, and a word of OpenFOAM.
  static std::string field_name(const GivenValue& v) {
    if (v.text.empty() || v.text.find_first_of("/\\\"' \t;{}()$#") != v.text.npos || v.text.front() == '.')
      throw Error(ErrorCode::usage, fmt::format("{} {}: expected a name such as alpha.water", v.name, v.text), "it is the name of a file in the time folder");
    return std::string(v.text);
  }

  static std::vector<PatchValue> patch_values(const GivenValue& v) {
    std::vector<PatchValue> values;
    for (const auto& [name, text] : named_values(v, "inlet=1,outlet=0")) values.push_back({name, non_negative_number({v.name, text})});
    return values;
  }

  // Before anything is read.
  void require_consistent() const {
    const auto refuse = [](const std::string& message, const std::string& hint) { throw Error(ErrorCode::usage, message, hint); };
    if (job_.case_folder.empty()) refuse("no case: --case names the folder of one", "add --case CASE");
    if (job_.phi == job_.field) refuse(fmt::format("--field and --also-phi name the same field {}", job_.phi), "give another name to one of them");
  }

  InitialConditionJob job_;
  int threads_ = 0;
  bool json_ = false;
  bool quiet_ = false;
};

}  // namespace

std::unique_ptr<Command> make_ic_command() { return std::make_unique<IcCommand>(); }

}  // namespace burnish
