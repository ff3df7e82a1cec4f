#include "clean_options.h"
#include "shared_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "burnish/core/error.h"
#include "suffixes.h"
#include "values.h"

namespace burnish {
namespace {

void smoothing(const GivenValue& given, CleanOptions& options) {
  options.smooth_auto = is_listed(given);
  if (!options.smooth_auto) options.smooth = positive_length(given);
}

void iso_value(const GivenValue& given, VolumeOptions& options) {
  options.iso_auto = is_listed(given);
  if (!options.iso_auto) options.iso = finite_number(given);
}

// Degrees above 0, and `most` at most.
double angle(const GivenValue& given, double most) {
  const double degrees = non_negative_number(given);
  if (degrees > 0 && degrees <= most && degrees < 180) return degrees;
  throw Error(ErrorCode::usage, fmt::format("{} {}: expected an angle between 0 and {} degrees", given.name, given.text, most), fmt::format("for example {} {}", given.name, most < 40 ? 20 : 40));
}

void signed_offset(const GivenValue& given, CleanOptions& options) {
  options.offset_inwards = given.text.starts_with('-');
  const bool is_signed = options.offset_inwards || given.text.starts_with('+');
  options.offset = length_without_cells(given.part(given.text.substr(is_signed ? 1 : 0)));
}

std::vector<Option> rows(CleanOptions& o) {
  return {
    {"--from-field", 0, "", "Volumes", "IN is a volume of values, .vti, .nrrd or .nhdr: its surface is where they are --iso.", switch_on(o.volume.asked)},
    {"--iso", 0, number("V", {"auto"}), "Volumes", "The value on the surface of a volume; above it is inside. 'auto' takes Otsu's threshold.",
     [&o](const GivenValue& v) { iso_value(v, o.volume); }},
    {"--below", 0, "", "Volumes", "Inside are the values below --iso.", switch_on(o.volume.below)},
    {"--array", 0, "NAME", "Volumes", "Which of several arrays of values. The active one, or the first, when not given.", store_text(o.volume.array)},
    units_row("Lengths", o.unit),
    {"--method", 0, word("M", {"auto", "local", "levelset"}), "Repair",
     "'local' mends what is broken and leaves the rest as it is, 'levelset' rebuilds the surface, 'auto' (default) chooses.",
     [&o](const GivenValue& v) { o.method = one_of<Method>(v); }},
    nested_row("Repair", o),
    gap_row("Repair", o),
    {"--recentre", 0, "", "Repair", "Move the model to the origin: for coordinates too large for an STL.",
     switch_on(o.recentre)},
    {"--max-hole", 0, length("L"), "Openings", "Close holes up to a diameter of L; wider openings stay.",
     [&o](const GivenValue& v) { o.max_hole = length_without_cells(v); }},
    {"--keep-openings", 0, "", "Openings", "Close no opening: terrain and one-sided scans stay open sheets.",
     switch_on(o.keep_openings)},
    {"--thicken", 0, length("T"), "Openings", "Make a shell of thickness T about the surface, open or not.",
     [&o](const GivenValue& v) { o.thicken = length_without_cells(v); }},
    {"--keep-largest", 0, "", "Components", "Keep only the component with the largest volume.", switch_on(o.keep_largest)},
    {"--min-component", 0, number("V"), "Components",
     "Drop components with less volume than V, such as 0.5 or 1% (of the largest one's).",
     [&o](const GivenValue& v) { o.min_component = volume_limit(v); }},
    {"--cell", 0, length("L", {"auto"}), "Resolution",
     "Side of the finest cells, such as 0.5 or 0.2%. Chosen from the model with 'auto', or when not given.",
     [&o](const GivenValue& v) {
       if (!is_listed(v)) o.cell = length_without_cells(v);
     }},
    {"--resolution", 0, count("N"), "Resolution",
     "Cells along the longest side (8 to 100000), instead of --cell.",
     [&o](const GivenValue& v) { o.resolution = static_cast<int>(integer_within(v, 8, 100'000)); }},
    {"--adapt", 0, length("TOL"), "Resolution",
     "Take coarser cells where the distance is off by no more than TOL, such as 0.1h or 0.01.",
     [&o](const GivenValue& v) { o.adapt = positive_length(v); }},
    {"--cell-max", 0, length("L"), "Resolution", "With --adapt: the coarsest cells, such as 16h or 1%; 8h when not given.",
     [&o](const GivenValue& v) { o.cell_max = positive_length(v); }},
    {"--smooth", 0, length("L", {"auto"}), "Smoothing", "Remove what is smaller than L; 'auto' removes the noise that it finds, and nothing else.",
     [&o](const GivenValue& v) { smoothing(v, o); }},
    {"--mode", 0, word("M", {"auto", "feature", "volume", "mcf", "filtered", "reinit"}), "Smoothing",
     "'feature' keeps sharp edges, 'volume' is for organic shapes, 'mcf' mean-curvature flow, 'filtered' keeps spheres, 'reinit' the "
     "thesis' reinitialisation; 'auto' (default) chooses 'feature' or 'volume'.",
     [&o](const GivenValue& v) { o.mode = one_of<SmoothMode>(v); }},
    {"--keep-volume", 0, "", "Smoothing", "The volume stays what it was (default).", switch_on(o.keep_volume), false, "--free-volume"},
    {"--free-volume", 0, "", "Smoothing", "The volume may change.", [&o](const GivenValue&) { o.keep_volume = false; }, false, "--keep-volume"},
    {"--crease", 0, number("ANGLE"), "Smoothing", "Edges of more than ANGLE degrees stay sharp. Chosen from the noise, or 40, when not given.",
     [&o](const GivenValue& v) { o.crease_angle = angle(v, 180); }},
    {"--region", 0, file("FILE", kRegionInputs), "Smoothing", "Smooth only inside FILE: a .txt with boxes and spheres, or a closed surface.", store_text(o.region)},
    {"--curvature-radius", 0, length("R"), "Smoothing", "Smooth only what is curved more than a sphere of radius R.",
     [&o](const GivenValue& v) { o.curvature_radius = length_without_cells(v); }},
    {"--deviation", 0, length("T"), "Smoothing", "Keep the smoothed surface within T of the repaired one; measured on the result.",
     [&o](const GivenValue& v) { o.deviation = positive_length(v); }},
    {"--redistance", 0, redistance_methods("M"), "Smoothing",
     "What keeps distances while it smooths: 'closest' points (default), 'fmm', or the thesis' 'pde-weno5' and 'pde-first'.",
     [&o](const GivenValue& v) { o.redistance = one_of<RedistanceMethod>(v); }},
    {"--offset", 0, length("D"), "Walls", "Move the surface outwards by D, inwards with --offset=-D.",
     [&o](const GivenValue& v) { signed_offset(v, o); }},
    {"--hollow", 0, length("T"), "Walls", "Keep only a wall of thickness T inside the surface.",
     [&o](const GivenValue& v) { o.hollow = length_without_cells(v); }},
    {"--surface", 0, word("X", {"auto", "delaunay", "tetrahedra"}), "Triangles",
     "What extracts the surface: 'delaunay' for well-shaped triangles, 'tetrahedra' for speed; 'auto' (default) chooses by their number.",
     [&o](const GivenValue& v) { o.surface = one_of<Extractor>(v); }},
    {"--edge", 0, length("L"), "Triangles", "Length of the triangles' edges, such as 0.5 or 2h.", [&o](const GivenValue& v) { o.edge = positive_length(v); }},
    {"--edge-tolerance", 0, length("T"), "Triangles", "Larger triangles where the surface is flat: within T of it, such as 0.1h ('delaunay').",
     [&o](const GivenValue& v) { o.edge_tolerance = positive_length(v); }},
    {"--min-angle", 0, number("A"), "Triangles", "Smallest angle of triangles away from creases, up to 30 degrees; 25 when not given ('delaunay').",
     [&o](const GivenValue& v) { o.min_angle = angle(v, 30); }},
    {"--facets", 0, count("N"), "Triangles", "Simplify the result to N triangles; creases stay.",
     [&o](const GivenValue& v) { o.facets = integer_within(v, 4, 4'000'000'000); }},
    {"--simplify", 0, length("T"), "Triangles", "Simplify the result as far as it stays within T of what it was; creases stay.",
     [&o](const GivenValue& v) { o.simplify = length_without_cells(v); }},
    memory_row("Resources", o),
  };
}

}  // namespace

std::vector<Option> with_clean_options(std::vector<Option> table, CleanOptions& options) {
  // Their groups stand behind the one that says what is written.
  const auto behind_output = std::find_if(table.begin(), table.end(), [](const Option& o) { return o.group != "Output"; });
  std::vector<Option> all = rows(options);
  table.insert(behind_output, std::make_move_iterator(all.begin()), std::make_move_iterator(all.end()));
  return table;
}

void require_consistent(const CleanOptions& o) {
  const auto refuse = [](const std::string& message, const std::string& hint) { throw Error(ErrorCode::usage, message, hint); };
  if (o.cell && o.resolution) refuse("--cell and --resolution exclude each other", "give one of the two");
  if (o.cell_max && !o.adapt) refuse("--cell-max needs --adapt", "for example --adapt 0.1h");
  if (o.keep_openings && o.max_hole) refuse("--keep-openings and --max-hole exclude each other", "give one of the two");
  if (o.thicken && o.keeps_openings()) refuse("--thicken makes a closed shell: there are no openings to keep", "leave out one of the two");
  if (o.thicken && o.moves_walls()) refuse("--thicken makes a shell of its own, and excludes --offset and --hollow", "do it in two runs");
  if (o.moves_walls() && o.keeps_openings()) refuse("--offset and --hollow need a closed surface: there are no openings to keep", "leave out one of the two");
  if (o.mode == SmoothMode::feature && o.smooths_in_cells()) refuse("--mode feature works on facets, which have no cells to measure lengths in", "give them in model units or in percent");
  if (o.mode == SmoothMode::reinit && (!o.region.empty() || o.curvature_radius))
    refuse("--mode reinit smooths everything: it excludes --region and --curvature-radius", "choose another mode");
  if (o.surface == Extractor::tetrahedra && o.asks_for_delaunay())
    refuse(fmt::format("{} is for --surface delaunay", o.min_angle ? "--min-angle" : "--edge-tolerance"), "leave out one of the two, or simplify with --simplify");
  if (o.keeps_openings() && (o.surface == Extractor::delaunay || o.asks_for_delaunay()))
    refuse("--surface delaunay makes closed surfaces: there are no openings to keep", "leave out one of the two");
  if (o.method == Method::local && o.smooths_in_cells()) refuse("--method local has no cells to measure lengths in", "give them in model units or in percent");
  if (o.method == Method::local) {
    const bool flows = o.mode != SmoothMode::automatic && o.mode != SmoothMode::feature;
    const std::string_view clash = o.smooths() && flows ? "--mode" : o.curvature_radius ? "--curvature-radius" : o.offset ? "--offset" : o.hollow ? "--hollow"
                                 : o.thicken ? "--thicken" : o.surface != Extractor::automatic ? "--surface" : o.edge ? "--edge" : o.edge_tolerance ? "--edge-tolerance"
                                 : o.min_angle ? "--min-angle" : o.cell ? "--cell" : o.resolution ? "--resolution" : o.adapt ? "--adapt" : "";
    if (!clash.empty()) refuse(fmt::format("{} is a matter of the level set, and --method local excludes it", clash), "leave out one of the two");
  }
}

std::vector<std::string> idle_options(const CleanOptions& o) {
  std::vector<std::string> idle;
  if (o.smooths()) return idle;
  const auto note = [&](bool given, const char* name) {
    if (given) idle.emplace_back(name);
  };
  note(o.deviation.has_value(), "--deviation");
  note(o.redistance != RedistanceMethod::closest, "--redistance");
  note(o.mode != SmoothMode::automatic, "--mode");
  note(!o.keep_volume, "--free-volume");
  note(!o.region.empty(), "--region");
  note(o.curvature_radius.has_value(), "--curvature-radius");
  return idle;
}

}  // namespace burnish
