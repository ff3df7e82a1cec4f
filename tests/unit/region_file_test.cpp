// Text files of regions: what they may hold, and how what they may not is told.
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "burnish/core/error.h"
#include "burnish/io/region_file.h"
#include "support/folder.h"
#include "support/mesh_bytes.h"

namespace burnish {
namespace {

using namespace test;

class RegionFile : public ::testing::Test {
 protected:
  RegionShapes read(const std::string& text) {
    std::ofstream(folder_.path("region.txt"), std::ios::binary) << text;
    return read_region_shapes(folder_.path("region.txt"));
  }

  // The message and, after a bar, the hint; empty if there was none.
  std::string error(const std::string& text) {
    try {
      read(text);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::unreadable_input);
      return std::string(e.what()) + " | " + e.hint();
    }
    return {};
  }

  Folder folder_;
};

TEST_F(RegionFile, BoxesHaveTwoOppositeCornersInAnyOrder) {
  const RegionShapes shapes = read("box 0 1 2 3 4 5\nbox 3 4 5 0 1 2\nbox 3 1 5 0 4 2\nbox 0 4 2 3 1 5\n");
  ASSERT_EQ(shapes.boxes.size(), 4u);
  EXPECT_TRUE(shapes.balls.empty());
  for (const Box3& box : shapes.boxes) {
    EXPECT_EQ(box.lower, (Vec3{0, 1, 2}));
    EXPECT_EQ(box.upper, (Vec3{3, 4, 5}));
  }
}

TEST_F(RegionFile, SpheresHaveACentreAndARadius) {
  const RegionShapes shapes = read("sphere -1.5 2e3 +0.25 1e-3\nsphere 0 0 0 7\n");
  ASSERT_EQ(shapes.balls.size(), 2u);
  EXPECT_TRUE(shapes.boxes.empty());
  EXPECT_EQ(shapes.balls[0].center, (Vec3{-1.5, 2000, 0.25}));
  EXPECT_EQ(shapes.balls[0].radius, 1e-3);
  EXPECT_EQ(shapes.balls[1].radius, 7);
}

TEST_F(RegionFile, CommentsEmptyLinesAndAllLineEndsAreTaken) {
  const std::string lines[] = {"# a region", "", "  \t ", "box 0 0 0 1 1 1   # the base", "\tsphere\t1 1  1 0.5", "#box 0 0 0 9 9 9"};
  for (const std::string end : {"\n", "\r\n"}) {
    for (const bool ends : {true, false}) {
      std::string text;
      for (const std::string& line : lines) text += line + end;
      if (!ends) text += "sphere 5 5 5 1";  // the last line without an end
      const RegionShapes shapes = read(text);
      ASSERT_EQ(shapes.boxes.size(), 1u);
      ASSERT_EQ(shapes.balls.size(), ends ? 1u : 2u);
      EXPECT_EQ(shapes.boxes[0].upper, (Vec3{1, 1, 1}));
      EXPECT_EQ(shapes.balls[0].center, (Vec3{1, 1, 1}));
    }
  }
}

// A plate without thickness is a box, which no point lies inside of.
TEST_F(RegionFile, BoxesMayBeFlat) {
  const RegionShapes shapes = read("box 0 0 1 2 2 1");
  ASSERT_EQ(shapes.boxes.size(), 1u);
  EXPECT_EQ(shapes.boxes[0].lower.z, shapes.boxes[0].upper.z);
}

TEST_F(RegionFile, ErrorsNameTheLineAndTheWayOut) {
  const std::string hint = "box X0 Y0 Z0 X1 Y1 Z1";
  EXPECT_TRUE(contains(error("cube 0 0 0 1"), {"region.txt: line 1", "expected 'box' or 'sphere', found 'cube'", hint}));
  EXPECT_TRUE(contains(error("# one\r\n\r\nbox 0 0 0 1 1 1\r\nBox 0 0 0 1 1 1\r\n"), {"line 4", "found 'Box'"}));
  EXPECT_TRUE(contains(error("box 0 0 0 1 1 1\n\nbox 0 0 0 1 1\n"), {"line 3", "expected 6 numbers behind 'box'", hint}));
  EXPECT_TRUE(contains(error("box 0 0 0 1 1 # 1\n"), {"line 1", "expected 6 numbers behind 'box'"}));
  EXPECT_TRUE(contains(error("box 0 0 0 1 1 one\n"), {"line 1", "expected 6 numbers behind 'box', found 'one'"}));
  EXPECT_TRUE(contains(error("box 0 0 0 1 1 1 1\n"), {"line 1", "expected the end of the line, found '1'"}));
  EXPECT_TRUE(contains(error("sphere 0 0 0\n"), {"line 1", "expected 4 numbers behind 'sphere'", "sphere X Y Z R"}));
  EXPECT_TRUE(contains(error("sphere 0,5 0 0 1\n"), {"line 1", "expected 4 numbers behind 'sphere', found '0,5'"}));
  for (const std::string radius : {"0", "-1", "-0"})
    EXPECT_TRUE(contains(error("\nsphere 0 0 0 " + radius), {"line 2", "expected a radius greater than zero"}));
  for (const std::string number : {"nan", "inf", "1e999"})
    EXPECT_TRUE(contains(error("sphere 0 0 0 " + number), {"line 1", "expected 4 numbers behind 'sphere', found '" + number + "'"}));
}

TEST_F(RegionFile, WithoutAShapeThereIsNoRegion) {
  for (const std::string text : {"", "\n\n", "# box 0 0 0 1 1 1\n"}) {
    SCOPED_TRACE(text);
    EXPECT_TRUE(contains(error(text), {"region.txt"}));
  }
  EXPECT_TRUE(contains(error("# none\n"), {"expected boxes or spheres, found none", "sphere X Y Z R"}));
  EXPECT_THROW(read_region_shapes(folder_.path("missing.txt")), Error);
}

}  // namespace
}  // namespace burnish
