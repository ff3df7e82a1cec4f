#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/io/field_files.h"
#include "burnish/io/vdb.h"
#include "support/folder.h"
#include "support/mesh_bytes.h"

namespace burnish {
namespace {

using namespace test;

// All octants of one level in Morton order, or of the next finer one where `is_split` says so.
template <class Split>
void append_cubes(LatticeCube cube, int level, Split&& is_split, std::vector<LatticeCube>& cubes) {
  if (cube.level == level && !is_split(cube)) return cubes.push_back(cube);
  if (cube.level < level || cube.level == 0) return cubes.push_back(cube);
  for (int c = 0; c < 8; ++c) {
    LatticeCube child{cube.corner, cube.level - 1};
    for (std::size_t a = 0; a < 3; ++a) child.corner[a] += (c >> a & 1) << child.level;
    append_cubes(child, level, is_split, cubes);
  }
}

double center_sum(const LatticeCube& cube) {
  return static_cast<double>(cube.corner[0] + cube.corner[1] + cube.corner[2]) + 1.5 * static_cast<double>(1 << cube.level);
}

CellGrid grid_of(const std::vector<LatticeCube>& cubes, int depth) {
  CellGrid grid{{10, 20, 30}, 0.5, depth, cubes.size(), {}, {}, {}};
  grid.cubes = [&cubes](std::size_t first, std::span<LatticeCube> to) {
    std::copy_n(cubes.begin() + static_cast<std::ptrdiff_t>(first), to.size(), to.begin());
  };
  grid.cell_arrays.push_back({"sum", NumberType::float32, [](std::span<const LatticeCube> items, double* to) {
                                for (const LatticeCube& c : items) *to++ = center_sum(c);
                              }});
  grid.cell_arrays.push_back({"level", NumberType::uint8, [](std::span<const LatticeCube> items, double* to) {
                                for (const LatticeCube& c : items) *to++ = c.level;
                              }});
  grid.point_arrays.push_back({"x", NumberType::int64, [](std::span<const LatticePoint> items, double* to) {
                                 for (const LatticePoint& p : items) *to++ = p[0];
                               }});
  return grid;
}

std::string written(const CellGrid& grid, FieldFormat format, WrittenField* sizes = nullptr) {
  const Folder folder;
  const int fd = ::open(folder.path("out").c_str(), O_RDWR | O_CREAT, 0644);
  const WrittenField result = write_field(fd, "out", grid, format);
  ::close(fd);
  if (sizes) *sizes = result;
  return folder.bytes("out");
}

// The arrays of a file by name, decompressed; checks that they follow each other and end where the file says.
std::map<std::string, std::string> arrays_of(const std::string& bytes) {
  std::map<std::string, std::string> arrays;
  const std::size_t data = bytes.find("   _") + 4;
  std::size_t end = 0;
  for (std::size_t at = bytes.find("<DataArray"); at < data; at = bytes.find("<DataArray", at + 1)) {
    const auto value = [&](const std::string& key) {
      const std::size_t from = bytes.find(key + "=\"", at) + key.size() + 2;
      return bytes.substr(from, bytes.find('"', from) - from);
    };
    EXPECT_EQ(std::stoul(value("offset")), end) << value("Name");
    std::array<std::uint64_t, 3> head;
    std::memcpy(head.data(), bytes.data() + data + end, sizeof head);
    std::size_t block = data + end + 8 * (3 + head[0]);
    std::string& array = arrays[value("Name")];
    for (std::uint64_t b = 0; b < head[0]; ++b) {
      std::uint64_t size;
      std::memcpy(&size, bytes.data() + data + end + 8 * (3 + b), 8);
      std::string part(b + 1 == head[0] && head[2] > 0 ? head[2] : head[1], '\0');
      uLongf length = part.size();
      EXPECT_EQ(::uncompress(reinterpret_cast<Bytef*>(part.data()), &length, reinterpret_cast<const Bytef*>(bytes.data() + block), size), Z_OK);
      EXPECT_EQ(length, part.size());
      array += part;
      block += size;
    }
    end = block - data;
  }
  EXPECT_EQ(bytes.substr(data + end), "\n  </AppendedData>\n</VTKFile>\n");
  return arrays;
}

template <class T>
std::vector<T> numbers(const std::string& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

void expect_cubes_in_vtu(const std::vector<LatticeCube>& cubes, const CellGrid& grid, const std::string& bytes, std::size_t points) {
  auto arrays = arrays_of(bytes);
  const auto at = numbers<double>(arrays["Points"]);
  const auto ids = numbers<std::int64_t>(arrays["connectivity"]);
  const auto x = numbers<std::int64_t>(arrays["x"]);
  ASSERT_EQ(at.size(), 3 * points);
  ASSERT_EQ(ids.size(), 8 * cubes.size());
  std::set<std::array<double, 3>> places;
  for (std::size_t p = 0; p < points; ++p) {
    places.insert({at[3 * p], at[3 * p + 1], at[3 * p + 2]});
    EXPECT_EQ(at[3 * p], grid.origin.x + grid.cell * static_cast<double>(x[p]));
  }
  EXPECT_EQ(places.size(), points) << "points stand there twice";
  std::size_t wrong = 0;
  for (std::size_t c = 0; c < cubes.size(); ++c)
    for (int corner = 0; corner < 8; ++corner)
      for (int a = 0; a < 3; ++a) {
        const std::int32_t lattice = cubes[c].corner[static_cast<std::size_t>(a)] + ((corner >> a & 1) << cubes[c].level);
        const std::size_t id = static_cast<std::size_t>(ids[8 * c + static_cast<std::size_t>(corner)]);
        wrong += at[3 * id + static_cast<std::size_t>(a)] != grid.origin[a] + grid.cell * lattice;
      }
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(arrays["types"], std::string(cubes.size(), 11));
  const auto offsets = numbers<std::int64_t>(arrays["offsets"]);
  for (std::size_t c = 0; c < cubes.size(); ++c) ASSERT_EQ(offsets[c], static_cast<std::int64_t>(8 * (c + 1)));
  const auto sums = numbers<float>(arrays["sum"]);
  for (std::size_t c = 0; c < cubes.size(); ++c) ASSERT_EQ(sums[c], static_cast<float>(center_sum(cubes[c])));
}

std::vector<LatticeCube> eight_cubes_one_split() {
  std::vector<LatticeCube> cubes;
  append_cubes({{}, 2}, 1, [](const LatticeCube& c) { return c.corner == LatticePoint{2, 0, 0}; }, cubes);
  return cubes;
}

TEST(FieldFiles, FormatsBySuffix) {
  EXPECT_EQ(field_format_for_writing("a/b.vtu"), FieldFormat::vtu);
  EXPECT_EQ(field_format_for_writing("B.HTG"), FieldFormat::htg);
  EXPECT_EQ(field_format_for_writing("a.vti"), FieldFormat::vti);
  EXPECT_EQ(field_format_for_writing("a.NRRD"), FieldFormat::nrrd);
  if (has_openvdb()) {
    EXPECT_EQ(field_format_for_writing("a.vdb"), FieldFormat::vdb);
  } else {
    EXPECT_THROW(field_format_for_writing("a.vdb"), Error);
  }
  for (const char* path : {"a.stl", "a", "-", "a.vtu/b"}) {
    try {
      field_format_for_writing(path);
      ADD_FAILURE() << path;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
      EXPECT_TRUE(contains(error.hint(), {".vtu", ".htg"}));
    }
  }
}

TEST(FieldFiles, VtuSharesPointsAndHasHangingNodes) {
  const std::vector<LatticeCube> cubes = eight_cubes_one_split();
  ASSERT_EQ(cubes.size(), 15u);
  const CellGrid grid = grid_of(cubes, 2);
  WrittenField sizes;
  const std::string bytes = written(grid, FieldFormat::vtu, &sizes);
  EXPECT_EQ(sizes.cells, 15u);
  EXPECT_EQ(sizes.points, 27u + 19u);  // the split cube adds its middle, and those of its faces and edges
  expect_cubes_in_vtu(cubes, grid, bytes, 46);
}

TEST(FieldFiles, HtgListsOctantsLevelByLevel) {
  const std::vector<LatticeCube> cubes = eight_cubes_one_split();
  WrittenField sizes;
  const std::string bytes = written(grid_of(cubes, 2), FieldFormat::htg, &sizes);
  EXPECT_EQ(sizes.cells, 15u);
  EXPECT_EQ(sizes.octants, 17u);
  auto arrays = arrays_of(bytes);
  EXPECT_EQ(numbers<std::uint8_t>(arrays["Descriptors"]), (std::vector<std::uint8_t>{0b10100000, 0}));  // the root, and its second child
  EXPECT_EQ(numbers<std::int64_t>(arrays["NumberOfVerticesPerDepth"]), (std::vector<std::int64_t>{1, 8, 8}));
  EXPECT_EQ(numbers<std::uint32_t>(arrays["DepthPerTree"]), (std::vector<std::uint32_t>{3}));
  EXPECT_EQ(numbers<double>(arrays["YCoordinates"]), (std::vector<double>{20, 22}));
  EXPECT_EQ(numbers<std::uint8_t>(arrays["level"]), (std::vector<std::uint8_t>{2, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0}));
  const auto sums = numbers<float>(arrays["sum"]);
  EXPECT_EQ(sums[0], 6);
  EXPECT_EQ(sums[2], 5);
  EXPECT_EQ(sums[9], 3.5f);
  EXPECT_EQ(arrays.count("x"), 0u);
}

// More cells than are held at once.
TEST(FieldFiles, ManyCellsInPortionsAreTheSameForAnyNumberOfThreads) {
  std::vector<LatticeCube> cubes;
  append_cubes({{}, 7}, 1, [](const LatticeCube& c) { return c.corner[0] + c.corner[2] < 30; }, cubes);
  const CellGrid grid = grid_of(cubes, 7);
  ASSERT_GT(cubes.size(), 300'000u);
  std::string bytes, tree;
  WrittenField sizes;
  {
    const ThreadLimit one(1);
    bytes = written(grid, FieldFormat::vtu, &sizes);
    tree = written(grid, FieldFormat::htg);
  }
  const ThreadLimit many(4);
  EXPECT_TRUE(written(grid, FieldFormat::vtu) == bytes);
  EXPECT_TRUE(written(grid, FieldFormat::htg) == tree);
  expect_cubes_in_vtu(cubes, grid, bytes, sizes.points);
  auto arrays = arrays_of(tree);
  std::size_t leaves = numbers<std::uint8_t>(arrays["level"]).size();
  for (const std::uint8_t byte : numbers<std::uint8_t>(arrays["Descriptors"])) leaves -= static_cast<std::size_t>(__builtin_popcount(byte));
  EXPECT_EQ(leaves, cubes.size());
}

TEST(FieldFiles, OneCellThatIsTheDomain) {
  const std::vector<LatticeCube> cubes{{{}, 3}};
  const CellGrid grid = grid_of(cubes, 3);
  expect_cubes_in_vtu(cubes, grid, written(grid, FieldFormat::vtu), 8);
  auto arrays = arrays_of(written(grid, FieldFormat::htg));
  EXPECT_EQ(numbers<std::int64_t>(arrays["NumberOfVerticesPerDepth"]), (std::vector<std::int64_t>{1}));
}

// Coordinates of 2^23 cells take blocks: keys have 21 bits.
TEST(FieldFiles, WideDomainsNeedLargeCells) {
  std::vector<LatticeCube> cubes;
  append_cubes({{}, 23}, 22, [](const LatticeCube&) { return false; }, cubes);
  const CellGrid wide = grid_of(cubes, 23);
  expect_cubes_in_vtu(cubes, wide, written(wide, FieldFormat::vtu), 27);
  cubes.assign(1, {{}, 0});
  const CellGrid fine = grid_of(cubes, 23);
  for (const FieldFormat format : {FieldFormat::vtu, FieldFormat::htg}) {
    try {
      written(fine, format);
      ADD_FAILURE() << name(format);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::memory_limit);
      EXPECT_TRUE(contains(error.hint(), {"larger cell"}));
    }
  }
}

TEST(FieldFiles, FullDiskIsAnError) {
  const std::vector<LatticeCube> cubes = eight_cubes_one_split();
  const int fd = ::open("/dev/full", O_WRONLY);
  ASSERT_GE(fd, 0);
  try {
    write_field(fd, "full.vtu", grid_of(cubes, 2), FieldFormat::vtu);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::unwritable_output);
    EXPECT_TRUE(contains(error.what(), {"full.vtu"}));
  }
  ::close(fd);
}

}  // namespace
}  // namespace burnish
