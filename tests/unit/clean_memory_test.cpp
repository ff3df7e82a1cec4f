// Cleaning without files gives what cleaning with files writes.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "burnish/io/mesh_io.h"
#include "burnish/pipeline/clean.h"
#include "burnish/pipeline/compare_files.h"
#include "burnish/surface/weld.h"
#include "support/folder.h"
#include "support/shapes.h"

namespace burnish {
namespace {

TriangleSoup open_cube() { return test::without_facets(test::scaled(test::cube(), 1.0 / 3), {4}); }

// What `clean` writes for `input` to a file of this suffix, as it stands there.
TriangleSoup written(const TriangleSoup& input, const CleanOptions& options, const std::string& suffix) {
  const test::Folder folder;
  folder.write("in.ply", input);
  CleanJob job;
  job.input = folder.path("in.ply");
  job.output = folder.path("out" + suffix);
  job.options = options;
  EXPECT_TRUE(clean(job).verified);
  return read_mesh(job.output).soup;
}

TEST(CleanInMemory, IsWhatIsWrittenToAPly) {
  for (const bool rebuilt : {false, true}) {
    CleanOptions options;
    if (rebuilt) options.resolution = 16;
    const TriangleSoup expected = written(open_cube(), options, ".ply");
    const CleanedSurface cleaned = clean(open_cube(), options);
    EXPECT_TRUE(cleaned.report.verified);
    EXPECT_FALSE(cleaned.report.written);
    EXPECT_EQ(cleaned.surface.points, expected.points);
    EXPECT_EQ(cleaned.surface.facets, expected.facets);
    EXPECT_NEAR(signed_volume(cleaned.surface), 1.0 / 27, 1e-15);
  }
}

TEST(CleanInMemory, OfSinglePrecisionIsWhatIsWrittenToAnStl) {
  CleanOptions options;
  options.resolution = 16;
  const TriangleSoup expected = weld(written(open_cube(), options, ".stl"));
  const CleanedSurface cleaned = clean(open_cube(), options, Precision::float32);
  EXPECT_EQ(cleaned.surface.points, expected.points);
  EXPECT_EQ(cleaned.surface.facets, expected.facets);
}

TEST(CleanInMemory, KeepsNamesAndColours) {
  TriangleSoup soup = open_cube();
  soup.groups = {{"front", 0, 3}, {"rest", 3, 8}};
  soup.colors.assign(soup.facets.size(), color_of(1, 2, 3));
  const CleanedSurface cleaned = clean(std::move(soup), {});
  ASSERT_EQ(cleaned.surface.groups.size(), 2u);
  EXPECT_EQ(cleaned.surface.groups[0].name, "front");
  EXPECT_EQ(cleaned.surface.colors, std::vector<Color>(cleaned.surface.facets.size(), color_of(1, 2, 3)));
}

TEST(CleanInMemory, SaysWhatItCannotDo) {
  EXPECT_THROW(clean(TriangleSoup{}, {}), Error);
  CleanOptions volume;
  volume.volume.iso = 1;
  EXPECT_THROW(clean(open_cube(), volume), Error);
  const CleanedSurface flat = clean(TriangleSoup{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {}}, {});
  ASSERT_TRUE(flat.report.failure);
  EXPECT_EQ(flat.report.failure->code(), ErrorCode::guarantee_unmet);
  EXPECT_TRUE(flat.surface.facets.empty());
  try {
    clean(test::scaled(test::cube(), 1e39), {}, Precision::float32);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::unwritable_output);
    EXPECT_NE(std::string(error.what()).find("beyond the range of float32"), std::string::npos);
  }
}

TEST(CheckInMemory, CountsWhatIsOpen) {
  const CheckResult open = check(open_cube()), closed = check(test::cube());
  EXPECT_EQ(open.defects.open_edges, 3u);
  ASSERT_EQ(open.locations.size(), 1u);
  EXPECT_EQ(open.locations[0].kind, DefectKind::open_loop);
  EXPECT_TRUE(closed.valid_solid);
}

TEST(CompareInMemory, DistancesOfACube) {
  const Box3 box = bounding_box(test::cube());
  const Vec3 center = box.center();
  const double half = 0.5 * (box.upper.x - box.lower.x);
  for (const bool exactly : {true, false}) {
    const std::vector<double> d = signed_distances(test::cube(), {center, center + Vec3{3 * half, 0, 0}, center + Vec3{2 * half, 2 * half, 0}}, exactly);
    EXPECT_NEAR(d[0], -half, 1e-15);
    EXPECT_NEAR(d[1], 2 * half, 1e-15);
    EXPECT_NEAR(d[2], std::sqrt(2.0) * half, 1e-15);
  }
  CompareJob job;
  job.samples = 1000;
  EXPECT_EQ(compare_surfaces(test::cube(), test::cube(), job).max(), 0);
}

}  // namespace
}  // namespace burnish
