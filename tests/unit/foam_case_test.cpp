// Meshes and fields of OpenFOAM cases: read back to what was written, in every format, and refused with the place where something is wrong.
#include "burnish/io/foam_case.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numeric>

#include "burnish/core/error.h"
#include "support/foam_files.h"
#include "support/folder.h"

namespace burnish {
namespace {

using test::Folder;
using test::hexahedra;
using test::PolyMeshWriter;

const FoamFormat kFormats[] = {{false, false, 4, 8}, {false, true, 4, 8}, {true, false, 4, 8}, {true, false, 8, 8}, {true, true, 4, 8}, {true, false, 4, 4}};

// The message and hint of the error that reading a case ends in.
std::string complaint(const Folder& folder, const std::string& time = {}) {
  try {
    read_foam_mesh(folder.path("case"), time);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::unreadable_input);
    return std::string(error.what()) + " | " + error.hint();
  }
  return "no complaint";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != text.npos; }

void write_text(const Folder& folder, const std::string& name, const std::string& text) {
  std::filesystem::create_directories(std::filesystem::path(folder.path(name)).parent_path());
  std::ofstream(folder.path(name), std::ios::binary) << text;
}

TEST(FoamMesh, IsTheSameInEveryFormat) {
  const PolyhedralMesh mesh = hexahedra(3, 4, 2, {{-1, 0.1, 2}, {1.0 / 3, 7, 2.5}});
  for (const FoamFormat& format : kFormats) {
    Folder folder;
    PolyMeshWriter(folder.path("case/constant/polyMesh"), format).write(mesh);
    const FoamMesh read = read_foam_mesh(folder.path("case"));
    EXPECT_EQ(read.mesh.cells, mesh.cells);
    EXPECT_EQ(read.mesh.face_start, mesh.face_start);
    EXPECT_EQ(read.mesh.face_points, mesh.face_points);
    EXPECT_EQ(read.mesh.owner, mesh.owner);
    EXPECT_EQ(read.mesh.neighbour, mesh.neighbour);
    ASSERT_EQ(read.mesh.patches.size(), 2u);
    EXPECT_EQ(read.mesh.patches[1].name, "ends");
    EXPECT_EQ(read.mesh.patches[0].type, "wall");
    EXPECT_EQ(read.mesh.patches[1].first_face + read.mesh.patches[1].faces, mesh.faces());
    ASSERT_EQ(read.mesh.points.size(), mesh.points.size());
    for (std::size_t p = 0; p < mesh.points.size(); ++p)
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_EQ(read.mesh.points[p][axis], format.scalar_bytes == 8 ? mesh.points[p][axis] : static_cast<double>(static_cast<float>(mesh.points[p][axis])));
    EXPECT_EQ(read.format.binary, format.binary);
    EXPECT_EQ(read.format.label_bytes, format.label_bytes);
    EXPECT_EQ(read.format.compressed, format.compressed);
    const std::vector<double> volumes = cell_geometry(read.mesh, cell_faces(read.mesh)).volume;
    EXPECT_NEAR(std::accumulate(volumes.begin(), volumes.end(), 0.0), 4.0 / 3 * 6.9 * 0.5, 1e-6);
  }
}

TEST(FoamMesh, HoldsCommentsAndUniformListsAndLists) {
  Folder folder;
  const PolyMeshWriter writer(folder.path("case/constant/polyMesh"), {});
  const PolyhedralMesh mesh = hexahedra(1, 1, 1);
  writer.write(mesh);
  writer.store("owner", writer.header("labelList", "owner") + "// all of them\n6{0}\n");
  writer.store("neighbour", writer.header("labelList", "neighbour") + "0()");
  const FoamMesh read = read_foam_mesh(folder.path("case"));
  EXPECT_EQ(read.mesh.cells, 1u);
  EXPECT_EQ(read.mesh.owner, mesh.owner);
  writer.store("neighbour", writer.header("labelList", "neighbour") + "/* of no\ncell */ 0\n");
  EXPECT_EQ(read_foam_mesh(folder.path("case")).mesh.neighbour.size(), 0u);
}

TEST(FoamMesh, IsTheOneThatCountsAtATime) {
  Folder folder;
  PolyMeshWriter(folder.path("case/constant/polyMesh"), {}).write(hexahedra(2, 1, 1));
  PolyMeshWriter(folder.path("case/0.5/polyMesh"), {}).write(hexahedra(3, 1, 1));
  EXPECT_EQ(read_foam_mesh(folder.path("case"), "0").mesh.cells, 2u);
  EXPECT_EQ(read_foam_mesh(folder.path("case"), "0.5").mesh.cells, 3u);
  EXPECT_EQ(read_foam_mesh(folder.path("case"), "2").mesh.cells, 3u);
  PolyMeshWriter(folder.path("case/constant/water/polyMesh"), {}).write(hexahedra(5, 1, 1));
  EXPECT_EQ(read_foam_mesh(folder.path("case"), "2", "water").mesh.cells, 5u);
}

TEST(FoamMesh, RefusesWhatIsNoCase) {
  Folder folder;
  EXPECT_TRUE(contains(complaint(folder), "no such folder"));
  std::filesystem::create_directories(folder.path("case"));
  EXPECT_TRUE(contains(complaint(folder), "neither system/controlDict nor constant/"));
  std::filesystem::create_directories(folder.path("case/constant"));
  EXPECT_TRUE(contains(complaint(folder), "there is no mesh"));
  PolyMeshWriter(folder.path("case/processor0/constant/polyMesh"), {}).write(hexahedra(1, 1, 1));
  EXPECT_TRUE(contains(complaint(folder), "reconstructParMesh -constant"));
}

TEST(FoamMesh, NamesThePlaceOfWhatIsBroken) {
  Folder folder;
  const PolyMeshWriter writer(folder.path("case/constant/polyMesh"), {});
  const PolyhedralMesh mesh = hexahedra(2, 1, 1);
  const auto with = [&](const std::string& file, const std::string& class_name, const std::string& body) {
    writer.write(mesh);
    writer.store(file, writer.header(class_name, file) + body);
    return complaint(folder);
  };
  writer.write(mesh);
  EXPECT_EQ(complaint(folder), "no complaint");
  // The header has 11 lines.
  EXPECT_TRUE(contains(with("points", "vectorField", "2\n(\n(0 0 0)\n(1 x 0)\n)"), "points: line 15: expected a coordinate, found 'x'"));
  EXPECT_TRUE(contains(with("points", "vectorField", "2\n(\n(0 0 0)\n(1 nan 0)\n)"), "line 15: expected a coordinate, found 'nan'"));
  EXPECT_TRUE(contains(with("points", "vectorField", "2\n(\n(0 0 0)\n"), "expected '(' before point 1 of 2, found the end of the file"));
  EXPECT_TRUE(contains(with("points", "vectorField", "4000000000\n(\n(0 0 0)\n"), "4000000000 points are promised"));
  EXPECT_TRUE(contains(with("points", "volScalarField", "0()"), "expected the class vectorField, found 'volScalarField'"));
  EXPECT_TRUE(contains(with("faces", "faceList", "1\n(\n4(0 1 2 77)\n)"), "faces: line 14: point 77 does not exist: there are 12"));
  EXPECT_TRUE(contains(with("faces", "faceList", "1\n(\n2(0 1)\n)"), "face 0 has 2 points"));
  EXPECT_TRUE(contains(with("owner", "labelList", "3(0 0 1)"), "owner: line 12: expected a list of 11, found one of 3"));
  EXPECT_TRUE(contains(with("owner", "labelList", "11(0 0 0 0 0 0 1 1 1 1 -1)"), "expected a cell, found '-1"));
  EXPECT_TRUE(contains(with("owner", "labelList", "11(0 0 0 0 0 0 1 1 1 1 999999)"), "cell 999999 does not exist"));
  EXPECT_TRUE(contains(with("owner", "labelList", "#include \"owner2\"\n"), "directives are not supported"));
  EXPECT_TRUE(contains(with("neighbour", "labelList", "1(0)"), "face 0 has the same cell 0 on both sides"));
  EXPECT_TRUE(contains(with("boundary", "polyBoundaryMesh", "1(walls { type wall; nFaces 3; startFace 1; })"), "7 faces on the boundary belong to no patch"));
  EXPECT_TRUE(contains(with("boundary", "polyBoundaryMesh", "1(walls { type wall; nFaces 99; startFace 1; })"), "patch walls: expected its faces from 1 on, among 11; found 99 from 1 on"));
  EXPECT_TRUE(contains(with("boundary", "polyBoundaryMesh", "1(walls { type wall; startFace 1; })"), "expected a whole number nFaces, found none"));
  writer.write(mesh);
  writer.store("faces", "solid\nfacet");
  EXPECT_TRUE(contains(complaint(folder), "no file of an OpenFOAM case"));
}

TEST(FoamMesh, NamesThePlaceInBinaryFiles) {
  Folder folder;
  const PolyMeshWriter writer(folder.path("case/constant/polyMesh"), {.binary = true});
  writer.write(hexahedra(2, 1, 1));
  const std::string points = folder.bytes("case/constant/polyMesh/points");
  writer.store("points", points.substr(0, points.size() - 40));
  EXPECT_TRUE(contains(complaint(folder), "12 points are promised, and the file ends")) << complaint(folder);
  std::string other = points;
  other.replace(other.find("LSB"), 3, "MSB");
  writer.store("points", other);
  EXPECT_TRUE(contains(complaint(folder), "most significant byte first"));
  other = points;
  other.replace(other.find("scalar=64"), 9, "scalar=16");
  writer.store("points", other);
  EXPECT_TRUE(contains(complaint(folder), "expected scalar=32 or scalar=64"));
  const PolyMeshWriter packed(folder.path("packed"), {.compressed = true});
  packed.write(hexahedra(2, 1, 1));
  std::filesystem::remove(folder.path("case/constant/polyMesh/points"));
  std::ofstream(folder.path("case/constant/polyMesh/points.gz")) << folder.bytes("packed/points.gz").substr(0, 60);
  EXPECT_TRUE(contains(complaint(folder), "the gzip file is broken or cut off"));
}

// --- fields

const char* const kTemplate = R"(FoamFile
{
    version     2.0;
    format      ascii;
    class       volScalarField;
    object      alpha.water.orig;
}
// internalField nonuniform; in a comment
#include "initial; }{"

dimensions      [0 0 0 0 0 0 0];

internalField   uniform 0.25; // what was there

boundaryField
{
    inlet
    {
        type            inletOutlet;   // as it was
        inletValue      uniform 0;
        value           $internalField;
    }
    "wall.*"
    {
        type            zeroGradient;
    }
    outlet { type zeroGradient; }
    #includeEtc "caseDicts/setConstraintTypes"
}
)";

const std::vector<MeshPatch> kPatches{{"inlet", "patch", 0, 1}, {"wall1", "wall", 1, 1}, {"outlet", "patch", 2, 1}, {"front", "empty", 3, 1}};

std::string written(const Folder& folder, const FoamField& field, const std::vector<double>& values, const std::string& name = "alpha") {
  OutputFile file(folder.path(name), true);
  write_foam_field(file, field, values);
  file.commit();
  return folder.bytes(name);
}

TEST(FoamFieldText, KeepsEverythingButItsValues) {
  Folder folder;
  write_text(folder, "0/alpha", kTemplate);
  const FoamField field = read_foam_field(folder.path("0/alpha"));
  EXPECT_EQ(field.patches, (std::vector<std::string>{"inlet", "\"wall.*\"", "outlet"}));
  const std::string text(kTemplate);
  std::string expected = text;
  const std::string old = "   uniform 0.25;";
  expected.replace(expected.find(old), old.size(), "   nonuniform List<scalar> \n3\n(\n0\n0.1\n1\n)\n;");
  // A list is no value of a patch.
  const std::string macro = "$internalField";
  expected.replace(expected.find(macro), macro.size(), "uniform 0.25");
  EXPECT_EQ(written(folder, field, {0, 0.1, 1}), expected);
}

TEST(FoamFieldText, ValuesReadBackToTheSameBits) {
  for (const FoamFormat& format : kFormats) {
    Folder folder;
    const std::vector<double> values{0, 1.0 / 3, 5e-324, 1 - 0x1p-53, 1, 0.1};
    const std::string name = format.compressed ? "f.gz" : "f";
    written(folder, new_foam_field("f", "[0 1 0 0 0 0 0]", kPatches, format), values, name);
    const FoamField first = read_foam_field(folder.path("f"));
    EXPECT_EQ(first.patches.size(), 4u);
    EXPECT_EQ(first.format.binary, format.binary);
    // Written over itself it is the same file: what is read of a list in binary ends where it should.
    const std::string bytes = folder.bytes(name);
    EXPECT_EQ(written(folder, first, values, name), bytes);
    if (format.binary || format.compressed) continue;
    EXPECT_TRUE(contains(bytes, "\n0.3333333333333333\n5e-324\n0.9999999999999999\n1\n0.1\n)"));
    EXPECT_TRUE(contains(bytes, "front\n    {\n        type            empty;"));
  }
}

TEST(FoamFieldText, SkipsBinaryListsInConditions) {
  Folder folder;
  const FoamFormat format{.binary = true};
  FoamField field = new_foam_field("f", "[0 0 0 0 0 0 0]", kPatches, format);
  const std::string junk = "};){\"#{/*;}}}}}}";  // the bytes of two scalars
  ASSERT_EQ(junk.size(), 16u);
  const std::string condition = "    value nonuniform List<scalar> \n2\n(" + junk + ");\n";
  field.after.insert(field.after.find("zeroGradient;") + 13, "\n" + condition);
  const std::string bytes = written(folder, field, {0, 1});
  const FoamField read = read_foam_field(folder.path("alpha"));
  EXPECT_EQ(read.patches.size(), 4u);
  EXPECT_EQ(written(folder, read, {0, 1}), bytes);
}

TEST(FoamFieldText, SetsValuesOfPatches) {
  Folder folder;
  write_text(folder, "alpha.orig", kTemplate);
  FoamField field = read_foam_field(folder.path("alpha.orig"));
  set_patch_value(field, "inlet", kPatches, 1);
  set_patch_value(field, "wall1", kPatches, 0.5);
  set_patch_value(field, "outlet", kPatches, 0);
  EXPECT_TRUE(contains(field.after, "type            inletOutlet;   // as it was\n        inletValue      uniform 1;\n        value           uniform 1;"));
  EXPECT_TRUE(contains(field.after, "outlet { type fixedValue;\n        value           uniform 0;\n    }"));
  EXPECT_TRUE(contains(field.after, "    wall1\n    {\n        type            fixedValue;\n        value           uniform 0.5;\n    }\n}"));
  EXPECT_TRUE(contains(field.after, "\"wall.*\"\n    {\n        type            zeroGradient;"));
  // What has been set is found, and set again.
  set_patch_value(field, "wall1", kPatches, 1);
  EXPECT_TRUE(contains(field.after, "    wall1\n    {\n        type            fixedValue;\n        value           uniform 1;\n    }\n}"));
  try {
    set_patch_value(field, "inlett", kPatches, 1);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_EQ(error.hint(), "its patches are inlet, wall1, outlet, front");
  }
  EXPECT_THROW(set_patch_value(field, "front", kPatches, 1), Error);
}

// A condition that computes its value itself, or whose type a macro brings in, would pass over a value: it becomes fixedValue.
TEST(FoamFieldText, ValuesCountWhateverTheConditionWas) {
  Folder folder;
  std::string text(kTemplate);
  const std::string outlet = "outlet { type zeroGradient; }";
  for (const auto& [before, after] : {std::pair{"outlet { type uniformFixedValue; uniformValue table 1(0 1); }", "type fixedValue; uniformValue table 1(0 1);\n        value           uniform 1;"},
                                      std::pair{"outlet { $outflow; }", "$outflow;\n        type            fixedValue;\n        value           uniform 1;"}}) {
    std::string with = text;
    with.replace(with.find(outlet), outlet.size(), before);
    write_text(folder, "alpha", with);
    FoamField field = read_foam_field(folder.path("alpha"));
    set_patch_value(field, "outlet", kPatches, 1);
    EXPECT_TRUE(contains(field.after, after)) << field.after;
  }
}

TEST(FoamFieldText, OtherMacrosStay) {
  Folder folder;
  std::string text(kTemplate);
  const std::string macro = "$internalField;";
  text.replace(text.find(macro), macro.size(), "${internalField}; a $internalFieldOld; b $!internalField;");
  write_text(folder, "alpha", text);
  EXPECT_TRUE(contains(read_foam_field(folder.path("alpha")).after, "uniform 0.25; a $internalFieldOld; b uniform 0.25;"));
}

TEST(FoamFieldText, UniformValuesAreOneNumber) {
  Folder folder;
  EXPECT_TRUE(contains(written(folder, new_foam_field("f", "[0 0 0 0 0 0 0]", kPatches, {}), {1, 1, 1}), "internalField   uniform 1;"));
}

TEST(FoamFieldText, RefusesOtherFiles) {
  Folder folder;
  const auto complaint_of = [&](std::string text) {
    write_text(folder, "f", text);
    try {
      read_foam_field(folder.path("f"));
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("no complaint");
  };
  std::string text(kTemplate);
  std::string vector = text;
  vector.replace(vector.find("volScalarField"), 14, "volVectorField");
  EXPECT_TRUE(contains(complaint_of(vector), "expected the class volScalarField, found 'volVectorField'"));
  std::string cut = text.substr(0, text.size() - 3);
  EXPECT_TRUE(contains(complaint_of(cut), "line 16: '{' is not closed"));
  EXPECT_TRUE(contains(complaint_of(text.substr(0, text.find("boundaryField"))), "it has no boundaryField"));
  EXPECT_TRUE(contains(complaint_of("hello"), "no file of an OpenFOAM case"));
}

TEST(FoamCase, StartsFromWhereControlDictSays) {
  Folder folder;
  const auto start = [&](const std::string& entries) {
    write_text(folder, "case/system/controlDict", "FoamFile { version 2.0; format ascii; class dictionary; object controlDict; }\n" + entries);
    return start_time_folder(folder.path("case"));
  };
  EXPECT_EQ(start_time_folder(folder.path("nowhere")), "0");
  EXPECT_EQ(start("startFrom startTime; startTime 0;"), "0");
  for (const char* time : {"case/0", "case/0.50", "case/10", "case/constant", "case/0.orig"}) std::filesystem::create_directories(folder.path(time));
  EXPECT_EQ(start("startFrom startTime; startTime 0.5;"), "0.50");
  EXPECT_EQ(start("// startFrom firstTime;\nstartFrom latestTime; startTime 0;"), "10");
  EXPECT_EQ(start("startFrom firstTime; functions { f { startFrom latestTime; } }"), "0");
  EXPECT_EQ(start("startFrom startTime; startTime 3;"), "3");
  EXPECT_EQ(start("startFrom startTime; startTime $t;"), "0");
  EXPECT_EQ(start("application interFoam;"), "10") << "OpenFOAM takes the latest time where nothing is said";
  EXPECT_EQ(time_folder(folder.path("case"), 5e-1), "0.50");
  EXPECT_EQ(time_folder(folder.path("case"), 0.25), "0.25");
  EXPECT_EQ(time_folders(folder.path("case")), (std::vector<std::string>{"0", "0.50", "10"}));
}

}  // namespace
}  // namespace burnish
