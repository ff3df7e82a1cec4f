// A case that runs: laminar flow, steady, through what is open and past what is not.
#include "foam_case_files.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>

#include "burnish/core/error.h"
#include "burnish/io/output_file.h"
#include "foam_file.h"
#include "packed_writer.h"
#include "patch_names.h"
#include "system_hint.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kControlDict = R"(
application     simpleFoam;
startFrom       latestTime;
startTime       0;
stopAt          endTime;
endTime         500;
deltaT          1;
writeControl    timeStep;
writeInterval   100;
purgeWrite      2;
writeFormat     binary;
writePrecision  12;
writeCompression off;
timeFormat      general;
timePrecision   6;
runTimeModifiable true;
)";

// Upwinding of second order, bounded, and non-orthogonal parts that are limited: robust where shapes of cells mix.
constexpr std::string_view kSchemes = R"(
ddtSchemes
{
    default         steadyState;
}

gradSchemes
{
    default         Gauss linear;
    grad(U)         cellLimited Gauss linear 1;
}

divSchemes
{
    default         none;
    div(phi,U)      bounded Gauss linearUpwind grad(U);
    div((nuEff*dev2(T(grad(U))))) Gauss linear;
    div(div(phi,U)) Gauss linear;
}

laplacianSchemes
{
    default         Gauss linear limited corrected 0.5;
}

interpolationSchemes
{
    default         linear;
}

snGradSchemes
{
    default         limited corrected 0.5;
}

wallDist
{
    method          meshWave;
}
)";

// GAMG refuses meshes of a few cells.
constexpr std::uint32_t kCellsForMultigrid = 10000;
constexpr std::string_view kMultigrid = "        solver          GAMG;\n        smoother        GaussSeidel;";
constexpr std::string_view kGradients = "        solver          PCG;\n        preconditioner  DIC;";

// Behind the solver of the pressure.
constexpr std::string_view kSolution = R"(
        tolerance       1e-9;
        relTol          0.05;
    }
    Phi
    {
        $p;
        relTol          0.01;
    }
    U
    {
        solver          smoothSolver;
        smoother        symGaussSeidel;
        tolerance       1e-9;
        relTol          0.1;
    }
}

potentialFlow
{
    nNonOrthogonalCorrectors 5;
    // Count where no patch says a pressure.
    PhiRefCell      0;
    PhiRefValue     0;
    pRefCell        0;
    pRefValue       0;
}

SIMPLE
{
    nNonOrthogonalCorrectors 1;
    consistent      no;
    // Count where no patch says a pressure.
    pRefCell        0;
    pRefValue       0;
    residualControl
    {
        p               1e-6;
        U               1e-6;
    }
}

relaxationFactors
{
    fields
    {
        p               0.3;
    }
    equations
    {
        U               0.7;
    }
}
)";

constexpr std::string_view kTurbulence = "\nsimulationType  laminar;\n";

// Conditions by group and by pattern, so that they fit whatever mesh is written into this case later.
constexpr std::string_view kVelocity = R"(
dimensions      [0 1 -1 0 0 0 0];

internalField   uniform (1 0 0);

// The flow enters at xMin and leaves at xMax, which a mesh of an outside has; other sides of its domain let slip. A mesh of an inside has walls alone:
// then nothing drives the flow, and it comes to rest from the field above. To drive it, make patches of type patch in constant/polyMesh/boundary
// and give them conditions here and in p.
boundaryField
{
    // All patches of the type wall, whatever their names.
    wall
    {
        type            noSlip;
    }
    xMin
    {
        type            fixedValue;
        value           uniform (1 0 0);
    }
    xMax
    {
        type            inletOutlet;
        inletValue      uniform (0 0 0);
        value           uniform (1 0 0);
    }
)";

constexpr std::string_view kPressure = R"(
// Divided by the density.
dimensions      [0 2 -2 0 0 0 0];

internalField   uniform 0;

boundaryField
{
    wall
    {
        type            zeroGradient;
    }
    xMax
    {
        type            fixedValue;
        value           uniform 0;
    }
)";

// Patches whose type leaves no choice, then all that is left.
std::string field_text(std::string_view head, const PolyhedralMesh& mesh, std::string_view other) {
  std::string text(head);
  const std::vector<std::string> names = patch_names(mesh.patches);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (is_constraint(mesh.patches[i].type)) text += fmt::format("    {}\n    {{\n        type            {};\n    }}\n", names[i], mesh.patches[i].type);
  return text + fmt::format("    \".*\"\n    {{\n        type            {};\n    }}\n}}\n", other);
}

std::string solution_text(const PolyhedralMesh& mesh) {
  return fmt::format("\nsolvers\n{{\n    p\n    {{\n{}{}", mesh.cells < kCellsForMultigrid ? kGradients : kMultigrid, kSolution);
}

std::string transport_text(const PolyhedralMesh& mesh) {
  Box3 box;
  for (const Vec3& p : mesh.points) box.extend(p);
  return fmt::format("\ntransportModel  Newtonian;\n\n// A hundredth of the mesh' longest side: the Reynolds number of that side and of the velocity 1 is 100, and flow is laminar.\nnu              [0 2 -1 0 0 0 0] {};\n",
                     box.longest_side() / 100);
}

struct CaseFile {
  std::string folder, name;
  std::string_view class_name;
  std::string text;
};

void store(const std::string& case_folder, const CaseFile& file) {
  const std::string folder = case_folder + "/" + file.folder, path = folder + "/" + file.name;
  if (FoamFile::exists(path)) return;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(ErrorCode::unwritable_output, folder + ": cannot be made: " + error.message(), write_hint(error.value()));
  OutputFile output(path, false);
  PackedWriter out(output, false);
  out.put(foam_header_text(file.class_name, file.name, {}, fmt::format("    location    \"{}\";\n", file.folder)));
  out.put(file.text);
  out.finish();
  output.commit();
}

}  // namespace

void write_case_files(const std::string& case_folder, const PolyhedralMesh& mesh) {
  // controlDict comes last: a case that has one is believed to have the others.
  const std::array<CaseFile, 7> files{{{"constant", "transportProperties", "dictionary", transport_text(mesh)},
                                       {"constant", "turbulenceProperties", "dictionary", std::string(kTurbulence)},
                                       {"0", "U", "volVectorField", field_text(kVelocity, mesh, "slip")},
                                       {"0", "p", "volScalarField", field_text(kPressure, mesh, "zeroGradient")},
                                       {"system", "fvSchemes", "dictionary", std::string(kSchemes)},
                                       {"system", "fvSolution", "dictionary", solution_text(mesh)},
                                       {"system", "controlDict", "dictionary", std::string(kControlDict)}}};
  for (const CaseFile& file : files) store(case_folder, file);
}

}  // namespace burnish
