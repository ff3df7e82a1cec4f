// What only callers of the library can meet, as the command line checks it first; and what takes billions of items, which is asked of its count alone.
// Each refusal tells what is wrong, and a way out. (tests/cli/error_cases.py names these tests for the rows of docs/errors.md.)
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <cmath>
#include <functional>
#include <string>

#include "assemble.h"
#include "burnish/core/error.h"
#include "burnish/io/field_files.h"
#include "burnish/io/foam_case.h"
#include "burnish/io/output_file.h"
#include "burnish/io/volume_files.h"
#include "burnish/io/voxel_volume.h"
#include "burnish/levelset/adapt.h"
#include "burnish/levelset/from_voxels.h"
#include "burnish/levelset/offset.h"
#include "burnish/octree/refine.h"
#include "burnish/pipeline/clean.h"
#include "burnish/pipeline/curvature.h"
#include "burnish/pipeline/field.h"
#include "burnish/pipeline/flow_mesh_job.h"
#include "burnish/surface/example_shapes.h"
#include "burnish/surface/remesh.h"
#include "burnish/surface/simplify.h"
#include "burnish/volume/volume_fraction.h"
#include "flow_mesh_patches.h"
#include "io/counts.h"
#include "io/foam_file.h"
#include "levelset/pieces.h"
#include "numbering.h"
#include "octree/counts.h"
#include "support/folder.h"
#include "support/level_sets.h"
#include "support/shapes.h"
#include "support/volume_meshes.h"

namespace burnish {
namespace {

using namespace test;

void expect_error(const Error& error, ErrorCode code, const std::string& message) {
  EXPECT_EQ(std::string(error.what()), message);
  EXPECT_EQ(error.code(), code) << message;
  EXPECT_FALSE(error.hint().empty()) << message;
}

void expect_refusal(ErrorCode code, const std::string& message, const std::function<void()>& act) {
  try {
    act();
    ADD_FAILURE() << "no error: " << message;
  } catch (const Error& error) {
    expect_error(error, code, message);
  }
}

TEST(Refusals, OfSurfacesInMemory) {
  expect_refusal(ErrorCode::unreadable_input, "the surface has no facets", [] { clean(TriangleSoup{}, {}); });
  CleanOptions volume;
  volume.volume.iso = 1;
  expect_refusal(ErrorCode::usage, "options of volumes are for files of values", [&] { clean(cube(), volume); });
  expect_refusal(ErrorCode::unwritable_output, "point 0 of the result is beyond the range of float32", [] { clean(moved(scaled(cube(), 1e39), {1e39, 1e39, 1e39}), {}, Precision::float32); });
  CleanOptions none;
  none.cell = Length{0, LengthUnit::model};
  expect_refusal(ErrorCode::usage, "--cell must be a length greater than zero", [&] { clean(cube(), none); });
}

// A batch runs the file again, with all of the memory.
TEST(Refusals, OfACellThatHasNoRoomInItsShareOfTheMemory) {
  CleanOptions shared;
  shared.method = Method::level_set;
  shared.memory_bytes = std::uint64_t{8} << 20;
  shared.memory_shares = 1000;
  try {
    clean(cube(), shared);
    ADD_FAILURE();
  } catch (const Error& error) {
    const std::string what = error.what(), begin = "the default cell of ", end = " does not fit into a share of 1/1000 of the memory";
    EXPECT_TRUE(what.starts_with(begin) && what.ends_with(end)) << what;
    EXPECT_EQ(error.code(), ErrorCode::memory_limit);
    EXPECT_FALSE(error.hint().empty());
  }
}

TEST(Refusals, OfSurfacesThatAreNoManifolds) {
  const TriangleSoup turned = with_flipped_facet(cube(), 3), touching = weld(merged(cube(), moved(cube(), {1, 1, 1})));
  expect_refusal(ErrorCode::guarantee_unmet, "the surface to simplify is no consistently oriented 2-manifold", [&] { simplify(turned, {.facets = 4}); });
  expect_refusal(ErrorCode::guarantee_unmet, "the surface to remesh is no consistently oriented 2-manifold", [&] { remesh(turned, {.edge = 0.5}); });
  expect_refusal(ErrorCode::guarantee_unmet, "the surface to remesh is no 2-manifold: shells share a point", [&] { remesh(touching, {.edge = 0.5}); });
  expect_refusal(ErrorCode::usage, "the edge length to remesh to is not positive", [] { remesh(cube(), {.edge = 0}); });
  expect_refusal(ErrorCode::usage, "the deviation to simplify within is negative or no number", [] { simplify(cube(), {.deviation = std::nan("")}); });
}

TEST(Refusals, OfExamples) {
  expect_refusal(ErrorCode::usage, "noise of an example must be a finite number, 0 or more", [] { make_example(ExampleShape::sphere, {.noise = -1}); });
  expect_refusal(ErrorCode::usage, "number of holes of an example must be 0 or more", [] { make_example(ExampleShape::sphere, {.holes = -1}); });
  expect_refusal(ErrorCode::usage, "no such example shape", [] { make_example(static_cast<ExampleShape>(99), {}); });
}

TEST(Refusals, OfLevelSets) {
  expect_refusal(ErrorCode::usage, "the error criterion needs a tolerance of 0 or more and a band of at least 2 cells", [] { distance_error(cube(), {.band = 1.5}); });
  auto set = level_set_of<float>(Octree::build(3, all_blocks(3)), [](const LatticeNode&) { return 0.0; });
  set.band = 5;
  expect_refusal(ErrorCode::usage, "distances of 5.000000 cells are too few for an offset of 2.000000", [&] { offset(set, 2); });
  expect_refusal(ErrorCode::memory_limit, "an octree of single cells can have 1048576 cells a side; this one needs more", [] { grow_cells(cube(), GridFrame{{}, 1e-7, 18}, {}); });
}

TEST(Refusals, OfFieldsAndCurvatures) {
  const Folder folder;
  CurvatureJob curvatures;
  curvatures.input = folder.write("cube.ply", cube());
  curvatures.method = CurvatureMethod::nodal;
  curvatures.order = CurvatureOrder::sixth;
  expect_refusal(ErrorCode::usage, "nodal curvatures are of order 2 or 4", [&] { curvature(curvatures); });
  curvatures.check = 10;
  expect_refusal(ErrorCode::usage, "nodal curvatures have no k1 and k2 to be checked", [&] { curvature(curvatures); });
  FieldJob job;
  job.input = curvatures.input;
  job.redistance = RedistanceMethod::closest;
  job.band = 1;
  expect_refusal(ErrorCode::usage, "a band of 1 cells is less than the 3.5 that ACCEPTED cells need", [&] { field(job); });
  job = {};
  job.input = curvatures.input;
  job.options.smooth = Length{0.1, LengthUnit::model};
  job.verify = 10;
  expect_refusal(ErrorCode::usage, "--verify-exact compares with the facets of the input, and --smooth moves the surface away from them", [&] { field(job); });
}

TEST(Refusals, OfVolumes) {
  const std::vector<float> values{1, 2, 1, 2, 1, 2, 1, 2};
  const VoxelSamples samples{{2, 2, 2}, {}, {1, 1, 1}, values};
  expect_refusal(ErrorCode::unreadable_input, "the volume has no values", [] { value_range({}); });
  expect_refusal(ErrorCode::guarantee_unmet, "no voxel is above 3: there is no surface", [&] { level_set_from_voxels(samples, 3, true); });
  expect_refusal(ErrorCode::unreadable_input, "v.stl: not the name of a volume", [] { read_voxels(std::span<const std::byte>{}, "v.stl"); });
}

TEST(Refusals, OfOutputs) {
  expect_refusal(ErrorCode::unwritable_output, "the output: has no name", [] { OutputFile("", false); });
  // A tree whose smallest cell is a 2^21st of the domain.
  CellGrid grid{{}, 1, 21, 1, {}, {}, {}};
  grid.cubes = [](std::size_t, std::span<LatticeCube> to) { to[0] = {}; };
  const int fd = ::open("/dev/null", O_WRONLY);
  expect_refusal(ErrorCode::memory_limit, "deep.htg: the domain is 2^21 of its smallest cells wide; at most 2^20 can be written", [&] { write_field(fd, "deep.htg", grid, FieldFormat::htg); });
  ::close(fd);
}

TEST(Refusals, OfFlowMeshes) {
  const Folder folder;
  FlowMeshJob job;
  job.input = folder.write("ball.ply", icosphere(2));
  job.cell = Length{0.4, LengthUnit::model};
  job.output = folder.path("mesh.msh");
  job.write.msh_version = 40;
  const FlowMeshResult odd = flow_mesh(job);
  ASSERT_TRUE(odd.failure);
  expect_error(*odd.failure, ErrorCode::usage, job.output + ": version 40 of gmsh's format is not written");
  const std::string su2 = folder.path("mesh.su2");
  expect_refusal(ErrorCode::usage, su2 + ": the format has no cells for the 1 polyhedra of the mesh", [&] { write_volume_mesh(su2, mixed_cells(true)); });
  expect_refusal(ErrorCode::usage, "the patch inlet is to be of two types, patch and symmetry", [] { require_one_type_each({{"inlet", "patch"}, {"inlet", "symmetry"}}); });
  CellList thrice;
  for (const std::uint32_t apex : {3u, 4u, 5u}) thrice.add(CellShape::tetrahedron, {0, 1, 2, apex});
  expect_refusal(ErrorCode::bug, "a face of the volume mesh has more than two cells", [&] { assemble(std::vector<Vec3>(6), thrice); });
}

TEST(Refusals, OfCases) {
  FoamField field;
  const std::vector<MeshPatch> patches{{"walls", "wall"}};
  expect_refusal(ErrorCode::unreadable_input, "the field has no boundaryField", [&] { set_patch_value(field, "walls", patches, 1); });
  const PolyhedralMesh mesh = hexahedra(cubic_grid({-1, -1, -1}, {1, 1, 1}, 2));
  const CellFaces faces = cell_faces(mesh);
  const CellGeometry geometry = cell_geometry(mesh, faces);
  expect_refusal(ErrorCode::usage, "volume fractions need a closed surface, and this one is open", [&] { exact_volume_fractions(mesh, geometry, faces, without_facets(icosphere(1), {3})); });
}

std::string gzipped(const std::string& text) {
  z_stream z{};
  deflateInit2(&z, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&z, text.size()), '\0');
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data())), z.avail_in = static_cast<uInt>(text.size());
  z.next_out = reinterpret_cast<Bytef*>(packed.data()), z.avail_out = static_cast<uInt>(packed.size());
  deflate(&z, Z_FINISH);
  packed.resize(packed.size() - z.avail_out);
  deflateEnd(&z);
  return packed;
}

TEST(Refusals, OfFilesThatUnpackToTooMuch) {
  const std::string packed = gzipped(std::string(std::size_t{1} << 22, ' '));
  EXPECT_EQ(unpack_gzip(packed, "points.gz", std::size_t{1} << 22).size(), std::size_t{1} << 22);
  expect_refusal(ErrorCode::unreadable_input, "points.gz: unpacks to more than 0.00195 GB", [&] { unpack_gzip(packed, "points.gz", std::size_t{1} << 21); });
}

TEST(Refusals, OfMoreThanCanBeRead) {
  const std::string text = "v 0 0 0\nf 1 2 3\n";
  const Source source{text, "m.obj"};
  const char* const second = text.data() + 8;
  constexpr std::uint64_t kMost = 1431655765;
  EXPECT_NO_THROW(require_room_for_point(source, second, kMost - 1));
  expect_refusal(ErrorCode::unreadable_input, "m.obj: line 2: more than the 1431655765 points that can be read", [&] { require_room_for_point(source, second, kMost); });
  EXPECT_NO_THROW(require_room_for_facets(source, second, 3 * kMost - 3, 3));
  expect_refusal(ErrorCode::unreadable_input, "m.obj: line 2: more facets than can be read", [&] { require_room_for_facets(source, second, 3 * kMost - 3, 4); });
  EXPECT_NO_THROW(require_room_for_facet(source, kMost - 1));
  expect_refusal(ErrorCode::unreadable_input, "m.obj: more than the 1431655765 facets that can be read", [&] { require_room_for_facet(source, kMost); });
  EXPECT_NO_THROW(require_room_for_object(source, 0xffffffffu, 0xffffffffu));
  expect_refusal(ErrorCode::unreadable_input, "m.obj: holds more points than 32 bits count", [&] { require_room_for_object(source, 0x100000000u, 1); });
}

TEST(Refusals, OfMoreThanCanBeWritten) {
  EXPECT_NO_THROW(require_zip_without_64("x.3mf", 0xfffffffeu, 0xfffffffeu));
  expect_refusal(ErrorCode::unwritable_output, "x.3mf: the model takes 4 GiB of a ZIP archive or more", [] { require_zip_without_64("x.3mf", 0xffffffffu, 0); });
  EXPECT_NO_THROW(require_signed("x.cgns", 0x7fffffffu, 32));
  EXPECT_NO_THROW(require_signed("x.cgns", 0x80000000u, 64));
  expect_refusal(ErrorCode::usage, "x.cgns: 2147483648 items are more than numbers of 32 bits count", [] { require_signed("x.cgns", 0x80000000u, 32); });
  EXPECT_NO_THROW(require_32_bit_labels("case", 0x7fffffffu));
  expect_refusal(ErrorCode::usage, "case: 2147483648 corners of faces are more than labels of 32 bits count", [] { require_32_bit_labels("case", 0x80000000u); });
}

TEST(Refusals, OfMoreThanCanBeNumbered) {
  EXPECT_NO_THROW(require_blocks(0xfffffffeu));
  expect_refusal(ErrorCode::memory_limit, "the octree would have more than 2^32 - 2 blocks", [] { require_blocks(0xffffffffu); });
  EXPECT_NO_THROW(detail::require_pieces(0xffffffffu));
  expect_refusal(ErrorCode::memory_limit, "the surface cuts the lattice into more than 2^32 pieces", [] { detail::require_pieces(0x100000000u); });
  EXPECT_NO_THROW(require_nodes(0xfffffffeu));
  expect_refusal(ErrorCode::memory_limit, "the mesh would have more than 2^32 nodes", [] { require_nodes(0xffffffffu); });
  expect_refusal(ErrorCode::memory_limit, "the mesh would have 4294967296 faces, and 32 bits number 4294967295", [] { require_numbers(0x100000000u, "faces"); });
}

}  // namespace
}  // namespace burnish
