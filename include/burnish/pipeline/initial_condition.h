// The initial condition of a two-phase simulation: a model's volume fractions on the mesh of an OpenFOAM case.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/core/vec.h"
#include "burnish/pipeline/options.h"
#include "burnish/pipeline/report.h"

namespace burnish {

// How fractions are computed (volume/volume_fraction.h).
enum class FractionMethod {
  automatic,  // exact
  exact,      // facets are clipped to cells
  linear,     // of a level set built of the facets: tetrahedra cut by the linear interpolant and corrected; third order where the distance is smooth
  curved,     // of the same: cut by tangent planes and corrected by the curvature; third order where the surface is smooth
};

std::string_view name(FractionMethod method);  // "auto", "exact", "linear", "curved"

// A fixed value on a patch.
struct PatchValue {
  std::string patch;
  double value = 0;
};

struct InitialConditionJob {
  std::string input;                  // a path, or "-" for standard input
  std::string case_folder;
  std::string field = "alpha.water";  // name of the fractions' field
  std::string phi;                    // name of a field of the signed distance; empty: none is written
  bool invert = false;                // the phase is outside the model
  std::vector<PatchValue> patch_values;
  FractionMethod method = FractionMethod::automatic;
  std::optional<double> time;         // of the folder; unset: what system/controlDict starts from
  std::string region;                 // of several meshes
  double scale = 1;                   // the model's coordinates are multiplied by this
  // Those of preparation, smoothing and resolution, lengths in the model file's units. Without smoothing the cell is that of the linear and curved
  // methods' level set; by the exact method it asks for a level set, as in `clean`.
  CleanOptions options;
  bool salvage = false;               // take what a broken input file holds
  bool overwrite = false;             // an existing field may be replaced
  bool dry_run = false;               // nothing is written
};

// All in the mesh's unit from here on.
struct CaseMesh {
  std::string folder;
  std::size_t points = 0, faces = 0, internal_faces = 0, cells = 0;
  struct Patch {
    std::string name, type;
    std::size_t faces = 0;
  };
  std::vector<Patch> patches;
  Box3 box;
  double volume = 0;
  double smallest_cell = 0;       // volumes
  double largest_cell = 0;
  std::size_t inverted_cells = 0; // of no volume, or a negative one
};

struct SolidSummary {
  std::size_t facets = 0;
  double volume = 0;
  double area = 0;
  Box3 box;
  std::string repair;          // "local" or "levelset": which gear repaired it
  std::string repair_reason;
};

struct FractionSummary {
  FractionMethod method = FractionMethod::automatic;
  double cell = 0;             // of the level set; 0: none was built
  double volume = 0;           // of the phase: the sum of alpha x the cell's volume, as written
  double in_mesh = 0;          // of the solid within the mesh, by the exact method
  // Of what alpha holds of the solid: by the exact method against the solid's volume (unset: the mesh does not hold all of the solid), by the others
  // against in_mesh.
  std::optional<double> difference;
  std::size_t mixed = 0;       // cells
  double min = 0, max = 0;
  std::size_t clamped = 0;
  double worst_clamp = 0;
};

struct CaseField {
  std::string name;
  std::string file;       // where it goes
  std::string from;       // the file that its conditions are from; empty: it is new
  bool written = false;
};

struct InitialConditionResult {
  std::string input, input_format;
  std::string case_folder, time, region;
  std::vector<std::string> warnings;
  ResolvedOptions options;
  Defects before;          // of the input
  double scale = 1;
  bool invert = false;
  CaseMesh mesh;
  SolidSummary solid;
  FractionSummary alpha;
  std::vector<CaseField> fields;  // that of the fractions first
  std::optional<Error> failure;   // the input bounds no solid, or none of it is in the mesh
  std::vector<StageCost> stages;
};

// Reads the mesh, and the input; repairs it as `clean` does, in memory; computes fractions and writes the field.
//
// A field CASE/<time>/NAME that exists keeps all its entries but the values, and is replaced only with `overwrite`. Else conditions come from
// CASE/<time>/NAME.orig, or CASE/0.orig/NAME for time 0; else they are zeroGradient, and constraints. Both fields appear once they are complete.
//
// The signed distance is that to the repaired surface at the cells' centres (OpenFOAM's), exact, positive in the phase.
//
// Level sets of the linear and curved methods have cells of half the side of the smallest cell that the surface passes through, as far as memory allows; distances
// are interpolated by cubic polynomials.
//
// An input that bounds no solid, and one that does not meet the mesh, comes back as `failure`, and nothing is written. Throws Error as `clean` and
// read_foam_mesh do; Error{usage} for a patch that does not exist.
InitialConditionResult initial_condition(const InitialConditionJob& job, Progress& progress = no_progress());

// The result as JSON text, as docs/ic.schema.json says: what `burnish ic --json` prints.
std::string to_json(const InitialConditionResult& result);

}  // namespace burnish
