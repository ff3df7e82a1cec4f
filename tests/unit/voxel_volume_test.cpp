#include "burnish/io/voxel_volume.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <bit>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "support/folder.h"
#include "support/mesh_bytes.h"

namespace burnish {
namespace {

using namespace test;

// A value that says where it stands, and fits into a signed byte.
int value_at(std::uint32_t i, std::uint32_t j, std::uint32_t k) { return static_cast<int>(i + 10 * j) - static_cast<int>(20 * k); }

void expect_values(const VoxelVolume& volume, std::array<std::uint32_t, 3> nodes) {
  ASSERT_EQ(volume.nodes, nodes);
  ASSERT_EQ(volume.values.size(), volume.size());
  std::size_t n = 0, wrong = 0;
  for (std::uint32_t k = 0; k < nodes[2]; ++k)
    for (std::uint32_t j = 0; j < nodes[1]; ++j)
      for (std::uint32_t i = 0; i < nodes[0]; ++i) wrong += volume.values[n++] != static_cast<float>(value_at(i, j, k));
  EXPECT_EQ(wrong, 0u);
}

void expect_vector(const Vec3& found, const Vec3& expected) {
  for (int a = 0; a < 3; ++a) EXPECT_DOUBLE_EQ(found[a], expected[a]) << "axis " << a;
}

// The values as they stand in a file.
template <class T>
std::string bytes_of(std::array<std::uint32_t, 3> nodes, bool big_endian = false) {
  std::string bytes;
  for (std::uint32_t k = 0; k < nodes[2]; ++k)
    for (std::uint32_t j = 0; j < nodes[1]; ++j)
      for (std::uint32_t i = 0; i < nodes[0]; ++i) {
        auto b = std::bit_cast<std::array<char, sizeof(T)>>(static_cast<T>(value_at(i, j, k)));
        if (big_endian) std::reverse(b.begin(), b.end());
        bytes.append(b.data(), b.size());
      }
  return bytes;
}

std::string gzipped(const std::string& bytes) {
  z_stream z{};
  ::deflateInit2(&z, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  std::string out(::deflateBound(&z, bytes.size()) + 32, '\0');
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  z.avail_in = static_cast<uInt>(bytes.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  ::deflate(&z, Z_FINISH);
  out.resize(out.size() - z.avail_out);
  ::deflateEnd(&z);
  return out;
}

VoxelVolume read(const std::string& bytes, const std::string& label, const std::string& array = {}, std::uint64_t memory = UINT64_MAX) {
  return read_voxels(std::as_bytes(std::span(bytes)), label, array, memory);
}

void expect_error(const std::string& bytes, const std::string& label, ErrorCode code, std::initializer_list<std::string> parts, std::uint64_t memory = UINT64_MAX) {
  try {
    read(bytes, label, {}, memory);
    ADD_FAILURE() << "no error for " << bytes.substr(0, 400);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    EXPECT_TRUE(contains(error.what(), parts));
  }
}

const std::string kNrrd = "NRRD0004\n# a comment\ntype: short\ndimension: 3\nsizes: 4 3 2\nspacings: 0.5 1 2\nendian: little\nencoding: raw\nkey:=value\n\n";

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(Nrrd, RawGzipAsciiInBothByteOrders) {
  const std::array<std::uint32_t, 3> nodes{4, 3, 2};
  const VoxelVolume volume = read(kNrrd + bytes_of<std::int16_t>(nodes), "a.nrrd");
  expect_values(volume, nodes);
  EXPECT_EQ(volume.type, VoxelType::int16);
  expect_vector(volume.spacing, {0.5, 1, 2});
  expect_values(read(with(kNrrd, "little", "big") + bytes_of<std::int16_t>(nodes, true), "a.nrrd"), nodes);
  const std::string gzip = with(kNrrd, "raw", "gzip");
  expect_values(read(gzip + gzipped(bytes_of<std::int16_t>(nodes)), "a.NRRD"), nodes);
  // Two members, one behind the other, the first of which ends within a number.
  const std::string all = bytes_of<std::int16_t>(nodes);
  expect_values(read(gzip + gzipped(all.substr(0, 7)) + gzipped(all.substr(7)), "a.nrrd"), nodes);
  std::string words;
  for (const float v : volume.values) words += std::to_string(static_cast<int>(v)) + (words.size() % 3 ? "\n" : " , ");
  expect_values(read(with(with(kNrrd, "raw", "ascii"), "endian: little\n", "") + words, "a.nrrd"), nodes);
  for (const auto& [type, bytes] : {std::pair("float", bytes_of<float>(nodes)), std::pair("double", bytes_of<double>(nodes)), std::pair("signed char", bytes_of<std::int8_t>(nodes)),
                                    std::pair("long long int", bytes_of<std::int64_t>(nodes)), std::pair("int32_t", bytes_of<std::int32_t>(nodes))})
    expect_values(read(with(kNrrd, "short", type) + bytes, "a.nrrd"), nodes);
}

TEST(Nrrd, SkipsAndDetachedData) {
  const std::array<std::uint32_t, 3> nodes{4, 3, 2};
  const std::string data = bytes_of<std::int16_t>(nodes);
  expect_values(read(with(kNrrd, "encoding", "line skip: 2\nbyte skip: 3\nencoding") + "one\ntwo\nabc" + data, "a.nrrd"), nodes);
  expect_values(read(with(kNrrd, "encoding", "byteskip: -1\nencoding") + "anything" + data, "a.nrrd"), nodes);
  expect_values(read(with(with(kNrrd, "encoding", "byte skip: 3\nencoding"), "raw", "gz") + gzipped("abc" + data), "a.nrrd"), nodes);
  const Folder folder;
  std::ofstream(folder.path("a.raw"), std::ios::binary) << data;
  const std::string header = with(kNrrd, "encoding", "data file: a.raw\nencoding");
  std::ofstream(folder.path("a.nhdr"), std::ios::binary) << header;
  expect_values(read_voxels(folder.path("a.nhdr")), nodes);
  expect_error(header, "a.nhdr", ErrorCode::unreadable_input, {"another file"});
  std::ofstream(folder.path("b.nhdr"), std::ios::binary) << with(header, "a.raw", "c.raw");
  EXPECT_THROW(read_voxels(folder.path("b.nhdr")), Error);
  // What is wrong with the data is said of their file.
  std::ofstream(folder.path("a.raw"), std::ios::binary) << data.substr(2);
  try {
    read_voxels(folder.path("a.nhdr"));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_TRUE(contains(error.what(), {folder.path("a.raw") + ": 4 x 3 x 2 values cannot be in the 46 bytes"}));
  }
}

TEST(Nrrd, AxesThatRunBackwardsAreTurnedRound) {
  const std::string header = with(kNrrd, "spacings: 0.5 1 2", "space: left-posterior-superior\nspace directions: (-0.5,0,0) (0,1,0) (0,0,-2)\nspace origin: (10,20,30)");
  const VoxelVolume volume = read(header + bytes_of<std::int16_t>({4, 3, 2}), "a.nrrd");
  expect_vector(volume.spacing, {0.5, 1, 2});
  expect_vector(volume.origin, {8.5, 20, 28});
  EXPECT_EQ(volume.values[0], static_cast<float>(value_at(3, 0, 1)));
  EXPECT_EQ(volume.values[4 * 3 * 2 - 1], static_cast<float>(value_at(0, 2, 0)));
  expect_error(with(header, "(0,1,0)", "(0,1,0.1)") + bytes_of<std::int16_t>({4, 3, 2}), "a.nrrd", ErrorCode::unreadable_input, {"line 7", "parallel"});
}

TEST(Nrrd, FourAxesWithOneOfLengthOne) {
  const std::array<std::uint32_t, 3> nodes{4, 3, 2};
  const std::string data = bytes_of<std::int16_t>(nodes);
  for (const auto& [sizes, spacings] : {std::pair("1 4 3 2", "nan 0.5 1 2"), std::pair("4 3 2 1", "0.5 1 2 NaN")}) {
    const VoxelVolume volume = read(with(with(with(kNrrd, "4 3 2", sizes), "dimension: 3", "dimension: 4"), "0.5 1 2", spacings) + data, "a.nrrd");
    expect_values(volume, nodes);
    expect_vector(volume.spacing, {0.5, 1, 2});
  }
  // "none" says which of two it is.
  const std::string header = with(with(kNrrd, "4 3 2", "1 12 1 2"), "dimension: 3", "dimension: 4");
  EXPECT_EQ(read(with(header, "spacings: 0.5 1 2", "space directions: none (1,0,0) (0,1,0) (0,0,1)") + data, "a.nrrd").nodes, (std::array<std::uint32_t, 3>{12, 1, 2}));
  expect_error(with(header, "1 12 1 2", "2 2 3 2") + data, "a.nrrd", ErrorCode::unreadable_input, {"length 1"});
}

TEST(Nrrd, AxisMinsFollowTheCentring) {
  const std::string header = with(kNrrd, "encoding", "axis mins: 1 2 3\nencoding"), data = bytes_of<std::int16_t>({4, 3, 2});
  expect_vector(read(header + data, "a.nrrd").origin, {1, 2, 3});
  expect_vector(read(with(header, "encoding", "centers: cell cell cell\nencoding") + data, "a.nrrd").origin, {1.25, 2.5, 4});
}

TEST(Nrrd, AxisMinsAndMaxsSayWhatTheSpacingIs) {
  const std::string ends = with(kNrrd, "spacings: 0.5 1 2", "axis mins: 1 2 7\naxismaxs: 4 8 3"), data = bytes_of<std::int16_t>({4, 3, 2});
  const VoxelVolume nodes = read(ends + data, "a.nrrd");
  expect_vector(nodes.spacing, {1, 3, 4});
  expect_vector(nodes.origin, {1, 2, 3});
  EXPECT_EQ(nodes.values[0], static_cast<float>(value_at(0, 0, 1)));  // z runs backwards
  const VoxelVolume cells = read(with(ends, "encoding", "centers: cell cell cell\nencoding") + data, "a.nrrd");
  expect_vector(cells.spacing, {0.75, 2, 2});
  expect_vector(cells.origin, {1.375, 3, 4});
  // What the file says of spacings itself counts.
  expect_vector(read(with(kNrrd, "encoding", "axis mins: 1 2 7\naxis maxs: 4 8 3\nencoding") + data, "a.nrrd").spacing, {0.5, 1, 2});
  expect_error(with(ends, "4 8 3", "4 2 3") + data, "a.nrrd", ErrorCode::unreadable_input, {"ends of axes"});
}

TEST(VoxelFiles, NodesThatCoordinatesCannotTellApartAreAnError) {
  const std::string data = bytes_of<std::int16_t>({4, 3, 2}), far = with(kNrrd, "encoding", "axis mins: 0 1e12 0\nencoding");
  EXPECT_EQ(read(far + data, "a.nrrd").origin.y, 1e12);
  expect_error(with(far, "1e12", "2e12") + data, "a.nrrd", ErrorCode::unreadable_input, {"told apart", "spacing of 1 at coordinates of 2e+12"});
  expect_error(with(kNrrd, "0.5 1 2", "5e-324 1 2") + data, "a.nrrd", ErrorCode::unreadable_input, {"spacing between 1e-60"});
}

TEST(Nrrd, ErrorsNameThePlace) {
  const std::string data = bytes_of<std::int16_t>({4, 3, 2});
  const auto bad = [&](const std::string& from, const std::string& to, std::initializer_list<std::string> parts) {
    expect_error(with(kNrrd, from, to) + data, "a.nrrd", ErrorCode::unreadable_input, parts);
  };
  bad("NRRD", "NRRX", {"a.nrrd", "NRRD0004", "NRRX0004"});
  bad("short", "block", {"line 3", "'block'"});
  bad("dimension: 3", "dimension: 2", {"line 4", "found 2"});
  bad("4 3 2", "4 3", {"line 5", "3 sizes"});
  bad("4 3 2", "4 -3 2", {"line 5"});
  bad("4 3 2", "4 3 2 1", {"line 5", "3 sizes"});
  bad("0.5 1 2", "0.5 0 2", {"spacings other than 0"});
  bad("raw", "bzip2", {"line 8", "bzip2"});
  bad("endian: little\n", "", {"endian"});
  bad("4 3 2", "4 3 3", {"4 x 3 x 3", "48 bytes"});
  bad("4 3 2", "4000000 3000000 2000000", {"cut off"});
  expect_error(with(kNrrd, "raw", "gzip") + gzipped(data).substr(0, 20), "a.nrrd", ErrorCode::unreadable_input, {"expected 24 values, found"});
  expect_error(with(kNrrd, "raw", "gzip") + data, "a.nrrd", ErrorCode::unreadable_input, {"damaged"});
  expect_error(with(kNrrd, "raw", "ascii") + "1 2 three 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24", "a.nrrd", ErrorCode::unreadable_input, {"'three'"});
  expect_error(kNrrd + data, "a.nrrd", ErrorCode::memory_limit, {"4 x 3 x 2"}, 90);
}

const std::string kVti = R"(<?xml version="1.0"?>
<!-- <DataArray> of a comment -->
<VTKFile type="ImageData" version="0.1" byte_order="LittleEndian">
  <ImageData WholeExtent="5 8 0 2 0 1" Origin="1 2 3" Spacing="0.5 1 2">
    <FieldData><DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">7</DataArray></FieldData>
    <Piece Extent="5 8 0 2 0 1">
      <PointData Scalars="b&gt;">
        <DataArray type="Int32" Name="v" NumberOfComponents="3" format="ascii">1 2 3</DataArray>
        <DataArray type='Int16' Name='b>' format='ascii'>
          <InformationKey name="L2_NORM_RANGE" location="vtkDataArray" length="2"></InformationKey>
          NUMBERS
        </DataArray>
        <DataArray type="UInt8" Name="constant" format="ascii">1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1</DataArray>
      </PointData>
      <CellData><DataArray type="UInt8" Name="cells" format="ascii">0 1 2 10 11 12</DataArray></CellData>
    </Piece>
  </ImageData>
</VTKFile>
)";

std::string vti_of_words() {
  std::string words;
  for (std::uint32_t k = 0; k < 2; ++k)
    for (std::uint32_t j = 0; j < 3; ++j)
      for (std::uint32_t i = 0; i < 4; ++i) words += std::to_string(value_at(i, j, k)) + " ";
  return with(kVti, "NUMBERS", words);
}

TEST(Vti, AsciiActiveNamedAndCellArrays) {
  const std::string text = vti_of_words();
  const VoxelVolume volume = read(text, "a.vti");
  expect_values(volume, {4, 3, 2});
  EXPECT_EQ(volume.name, "b>");
  EXPECT_EQ(volume.type, VoxelType::int16);
  expect_vector(volume.origin, {3.5, 2, 3});
  expect_vector(volume.spacing, {0.5, 1, 2});
  EXPECT_EQ(read(text, "a.vti", "constant").values[23], 1);
  const VoxelVolume cells = read(text, "a.vti", "cells");
  expect_values(cells, {3, 2, 1});
  expect_vector(cells.origin, {3.75, 2.5, 4});
  const VoxelVolume turned = read(with(text, "Spacing", "Direction='1 0 0 0 -1 0 0 0 1' Spacing"), "a.vti");
  expect_vector(turned.origin, {3.5, 0, 3});
  EXPECT_EQ(turned.values[0], static_cast<float>(value_at(0, 2, 0)));
}

TEST(Vti, ErrorsNameThePlace) {
  const std::string text = vti_of_words();
  const auto bad = [&](const std::string& from, const std::string& to, std::initializer_list<std::string> parts) {
    expect_error(with(text, from, to), "a.vti", ErrorCode::unreadable_input, parts);
  };
  bad("\"ImageData\"", "\"PolyData\"", {"line 3", "ImageData", "'PolyData'"});
  bad("byte_order", "compressor=\"vtkLZ4DataCompressor\" byte_order", {"line 3", "LZ4"});
  bad("5 8 0 2 0 1", "5 8 0 2 0", {"line 4", "extent"});
  bad("5 8 0 2 0 1", "5 9 0 2 0 1", {"line 6", "one piece"});
  bad("0.5 1 2", "0.5 one 2", {"line 4", "Spacing"});
  bad("0.5 1 2", "0.5 0 2", {"spacing other than 0"});
  bad("Origin=\"1 2 3\"", "Origin=\"1 1e300 3\"", {"told apart"});
  bad("Spacing", "Direction='0 1 0 1 0 0 0 0 1' Spacing", {"parallel"});
  bad("'Int16'", "'String'", {"line 9", "'String'"});
  bad("format='ascii'", "format='appended' offset='12'", {"line 9", "offset"});
  bad("</VTKFile>", "<AppendedData encoding=\"raw\">", {"'_'"});
  bad(" 13 ", " ", {"expected 24 values, found 23"});
  expect_error("<VTKFile", "a.vti", ErrorCode::unreadable_input, {"line 1", "end of a tag"});
  expect_error("", "a.vti", ErrorCode::unreadable_input, {"VTK's XML"});
  try {
    read(text, "a.vti", "other");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_TRUE(contains(error.what(), {"'other'", "'v', 'b>', 'constant', 'cells'"}));
  }
}

VoxelSource source_of(std::array<std::uint32_t, 3> nodes) {
  VoxelSource source{nodes, {1, -2, 0.1}, {0.5, 1, 2}, "p<hi>", {}};
  source.fill = [nodes](std::uint32_t first, std::uint32_t last, std::span<float> values) {
    std::size_t n = 0;
    for (std::uint32_t k = first; k < last; ++k)
      for (std::uint32_t j = 0; j < nodes[1]; ++j)
        for (std::uint32_t i = 0; i < nodes[0]; ++i) values[n++] = static_cast<float>(value_at(i, j, k));
  };
  return source;
}

std::string written(const Folder& folder, const std::string& name, const VoxelSource& source) {
  const int fd = ::open(folder.path(name).c_str(), O_RDWR | O_CREAT | O_TRUNC, 0644);
  write_voxels(fd, name, source, name.ends_with(".vti") ? VoxelFormat::vti : VoxelFormat::nrrd);
  ::close(fd);
  return folder.bytes(name);
}

TEST(VoxelFiles, WhatIsWrittenIsReadBackAndDoesNotDependOnThreads) {
  const Folder folder;
  for (const std::string name : {"a.vti", "a.nrrd"}) {
    // Of several slabs and of several compressed blocks, the last of them not full.
    const VoxelSource source = source_of({301, 203, 97});
    const std::string bytes = written(folder, name, source);
    const VoxelVolume volume = read(bytes, name);
    expect_values(volume, source.nodes);
    expect_vector(volume.origin, source.origin);
    expect_vector(volume.spacing, source.spacing);
    EXPECT_EQ(volume.name, source.name);
    EXPECT_EQ(volume.type, VoxelType::float32);
    const ThreadLimit one(1);
    EXPECT_EQ(written(folder, name, source), bytes);
  }
}

TEST(VoxelFiles, NamesOfVolumes) {
  for (const char* path : {"a.vti", "b/A.NRRD", "c.nhdr"}) EXPECT_TRUE(is_voxel_file(path)) << path;
  for (const char* path : {"a.stl", "vti", "a.vti/b", "-"}) EXPECT_FALSE(is_voxel_file(path)) << path;
}

TEST(VoxelFiles, TruncatedFilesAreErrors) {
  const Folder folder;
  for (const std::string name : {"a.vti", "a.nrrd"}) {
    const std::string bytes = written(folder, name, source_of({5, 4, 3}));
    for (std::size_t size = 0; size + 40 < bytes.size(); size += 7) EXPECT_THROW(read(bytes.substr(0, size), name), Error) << size;
  }
}

// --- VTK as a judge

int run_python(const std::string& script, const std::string& arguments) {
  return std::system(("/usr/bin/python3 -c '" + script + "' " + arguments).c_str());
}

#define NEEDS_VTK() \
  if (std::system("/usr/bin/python3 -c 'import vtkmodules.vtkIOXML, vtkmodules.vtkIOImage' 2>/dev/null") != 0) GTEST_SKIP() << "no VTK (scripts/bootstrap picture)"

// Reads a file with VTK and checks geometry and each value.
const char* const kReadByVtk = R"PY(
import sys
from vtkmodules.vtkIOXML import vtkXMLImageDataReader
from vtkmodules.vtkIOImage import vtkNrrdReader
reader = vtkXMLImageDataReader() if sys.argv[1].endswith(".vti") else vtkNrrdReader()
reader.SetFileName(sys.argv[1])
reader.Update()
image = reader.GetOutput()
nx, ny, nz = image.GetDimensions()
near = lambda a, b: all(abs(x - y) < 1e-12 for x, y in zip(a, b))
assert (nx, ny, nz) == (17, 5, 3), (nx, ny, nz)
assert near(image.GetSpacing(), (0.5, 1, 2)), image.GetSpacing()
assert near(image.GetOrigin(), (1, -2, 0.1)), image.GetOrigin()
values = image.GetPointData().GetScalars()
assert values.GetDataTypeAsString() == "float"
if sys.argv[1].endswith(".vti"): assert values.GetName() == "p<hi>", values.GetName()
n = 0
for k in range(nz):
    for j in range(ny):
        for i in range(nx):
            assert values.GetTuple1(n) == i + 10 * j - 20 * k, (i, j, k)
            n += 1
)PY";

TEST(VoxelFiles, VtkReadsTheSame) {
  NEEDS_VTK();
  const Folder folder;
  // Of a .nrrd, VTK takes a first axis of up to nine for components.
  for (const std::string name : {"a.vti", "a.nrrd"}) {
    written(folder, name, source_of({17, 5, 3}));
    EXPECT_EQ(run_python(kReadByVtk, folder.path(name)), 0) << name;
  }
}

// Writes 4 x 3 x 2 points with VTK, in every encoding; one line of output for each file.
const char* const kWriteByVtk = R"PY(
import sys
from vtkmodules.vtkCommonCore import vtkCharArray, vtkSignedCharArray, vtkShortArray, vtkIntArray, vtkFloatArray, vtkDoubleArray, vtkTypeInt64Array, vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter
value = lambda i, j, k: i + 10 * j - 20 * k
def filled(kind, name, nx, ny, nz):
    array = kind()
    array.SetName(name)
    for k in range(nz):
        for j in range(ny):
            for i in range(nx): array.InsertNextTuple1(value(i, j, k))
    return array
count = 0
for kind in (vtkSignedCharArray, vtkShortArray, vtkIntArray, vtkTypeInt64Array, vtkFloatArray, vtkDoubleArray):
    for mode in ("Ascii", "Binary", "Appended", "AppendedRaw"):
        for compressed in (False, True):
            for header in ("UInt32", "UInt64"):
                for order in ("LittleEndian", "BigEndian"):
                    image = vtkImageData()
                    image.SetDimensions(4, 3, 2)
                    image.SetOrigin(1, 2, 3)
                    image.SetSpacing(0.5, 1, 2)
                    other = vtkUnsignedCharArray()
                    other.SetName("other")
                    for n in range(24): other.InsertNextTuple1(n % 2)
                    image.GetPointData().AddArray(other)
                    image.GetPointData().SetScalars(filled(kind, "point", 4, 3, 2))
                    image.GetCellData().AddArray(filled(kind, "cell", 3, 2, 1))
                    writer = vtkXMLImageDataWriter()
                    writer.SetFileName("%s/%d.vti" % (sys.argv[1], count))
                    writer.SetInputData(image)
                    if mode.startswith("Appended"):
                        writer.SetDataModeToAppended()
                        writer.SetEncodeAppendedData(mode == "Appended")
                    else: getattr(writer, "SetDataModeTo" + mode)()
                    if compressed:
                        writer.SetCompressorTypeToZLib()
                        writer.SetBlockSize(32)
                    else: writer.SetCompressorTypeToNone()
                    getattr(writer, "SetHeaderTypeTo" + header)()
                    getattr(writer, "SetByteOrderTo" + order)()
                    assert writer.Write() == 1
                    count += 1
)PY";

TEST(VoxelFiles, WhatVtkWritesInEveryEncodingIsRead) {
  NEEDS_VTK();
  const Folder folder;
  ASSERT_EQ(run_python(kWriteByVtk, folder.path(".")), 0);
  constexpr int kFiles = 6 * 4 * 2 * 2 * 2;
  ASSERT_EQ(folder.file_count(), kFiles);
  for (int f = 0; f < kFiles; ++f) {
    SCOPED_TRACE(f);
    const std::string path = folder.path(std::to_string(f) + ".vti");
    const VoxelVolume points = read_voxels(path);
    EXPECT_EQ(points.name, "point");
    expect_values(points, {4, 3, 2});
    expect_vector(points.origin, {1, 2, 3});
    expect_vector(points.spacing, {0.5, 1, 2});
    expect_values(read_voxels(path, "cell"), {3, 2, 1});
    EXPECT_EQ(read_voxels(path, "other").values[3], 1);
  }
}

}  // namespace
}  // namespace burnish
