// OpenFOAM cases: reading a polyMesh, and writing fields for it.
//
// What is read is what OpenFOAM 1912 and later (openfoam.com) and 7 and later (openfoam.org) write: ascii or binary, label 32 or 64, scalar 32 or 64 (the
// `arch` entry says), plain or gzipped files. Directives (`#include`) and macros are kept in fields, and are an error in the files of a mesh.
// Counts are not believed before the bytes are seen.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/io/output_file.h"
#include "burnish/volume/polyhedral_mesh.h"

namespace burnish {

struct FoamFormat {
  bool binary = false;
  bool compressed = false;
  int label_bytes = 4, scalar_bytes = 8;
};

struct FoamMesh {
  PolyhedralMesh mesh;
  FoamFormat format;      // of its points file
  std::string folder;     // where it was found
};

// CASE/constant/polyMesh; `region`: CASE/constant/<region>/polyMesh. Where time folders up to `time` hold a mesh, or points, of their own, the latest ones
// count, as in OpenFOAM (snappyHexMesh without -overwrite leaves such). Throws Error{unreadable_input} naming file, line or byte, expected and found:
// no such folder, no case (neither system/controlDict nor constant), a decomposed case (faces at processor0 alone), a file cut off, labels out of range,
// an owner or neighbour list of the wrong length. Cost: 0.4 us a cell in binary, 1.3 us in text, of hexahedra.
FoamMesh read_foam_mesh(const std::string& case_folder, const std::string& time = {}, const std::string& region = {}, Progress& progress = no_progress());

// A scalar field file of a case, taken apart as far as is needed to write it again with other values: all entries but internalField keep their text, byte for
// byte. The one exception: conditions that say `$internalField` get what it stood for, if that was uniform, for a list of cells is no value of a patch.
struct FoamField {
  std::string before;          // text up to and including "internalField"
  std::string after;           // from the ';' after its value on: boundaryField with all conditions
  FoamFormat format;
  std::vector<std::string> patches;  // names (or regular expressions in quotes) in its boundaryField
};
// `path`, or else `path`.gz. Throws Error{unreadable_input} also if it is no volScalarField.
FoamField read_foam_field(const std::string& path);

// A new field with zeroGradient on all patches, and the constraint type where a patch has one (empty, wedge, cyclic, symmetry, processor, ...).
// `dimensions`: "[0 1 0 0 0 0 0]".
FoamField new_foam_field(const std::string& object, const std::string& dimensions, const std::vector<MeshPatch>& patches, const FoamFormat& format);

// A fixed value on a patch of a field: zeroGradient and calculated, which have none, become fixedValue; other conditions keep their type, and their
// value, inletValue and outletValue are set. A patch without an entry of its own (a pattern stands for it) gets one. Throws Error{usage} for a patch
// that the mesh does not have, naming those it has, and for one whose type is a constraint.
void set_patch_value(FoamField& field, const std::string& patch, const std::vector<MeshPatch>& patches, double value);

// internalField nonuniform List<scalar>, in the field's format (uniform where all values are equal): text with as many digits as it takes to read the same
// double back. The file's name has to end in .gz if the format is compressed.
void write_foam_field(OutputFile& file, const FoamField& field, const std::vector<double>& values);

// The folders of a case that are named by a time, ascending.
std::vector<std::string> time_folders(const std::string& case_folder);

// The time folder that a run of this case starts from, by system/controlDict's startFrom and startTime: "0" where it cannot be said. It need not exist.
std::string start_time_folder(const std::string& case_folder);

// The folder of that time, whatever its digits ("0.10" and "1e-1" are one time), or the name that a new one gets.
std::string time_folder(const std::string& case_folder, double time);

}  // namespace burnish
