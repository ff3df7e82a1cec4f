#include "burnish/io/point_data.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "support/folder.h"
#include "support/mesh_bytes.h"

namespace burnish {
namespace {

using namespace test;

const TriangleSoup kSurface{{{0, 0, 0}, {1, 0, 0}, {0, 0.1, 0}, {0, 0, 7}}, {{0, 1, 2}, {0, 2, 3}}, {}};

PointData example() {
  return {kSurface, {{"deviation", {-0.5, 0, 0.25, 0.1}}, {"distance", {0.5, 0, 0.25, 0.1}}}, {"a line", "another"}};
}

std::string written(const PointData& data, MarkedFormat format) {
  const Folder folder;
  const int fd = ::open(folder.path("out").c_str(), O_WRONLY | O_CREAT, 0644);
  write_point_data(fd, "out", data, format);
  ::close(fd);
  return folder.bytes("out");
}

template <class T>
T raw_at(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

TEST(PointData, VtpAnnouncesItsArraysWhereTheyAre) {
  const std::string bytes = written(example(), MarkedFormat::vtp);
  EXPECT_TRUE(contains(bytes, {"NumberOfPoints=\"4\" NumberOfVerts=\"0\" NumberOfLines=\"0\"", "NumberOfPolys=\"2\"",
                               "<PointData Scalars=\"deviation\">", "Name=\"distance\"", "</PointData>\n"}));
  const std::size_t data = bytes.find("   _") + 4;
  std::size_t announced = 0, end = 0;
  for (std::size_t at = bytes.find("offset=\""); at != bytes.npos; at = bytes.find("offset=\"", at + 1)) {
    const std::size_t offset = std::stoul(bytes.substr(at + 8));
    EXPECT_EQ(offset, end);
    end = offset + 8 + raw_at<std::uint64_t>(bytes, data + offset);
    ++announced;
  }
  EXPECT_EQ(announced, 9u);  // two arrays, points, and two arrays for each of three sorts of cells
  EXPECT_EQ(bytes.substr(data + end), "\n  </AppendedData>\n</VTKFile>\n");
  EXPECT_EQ(raw_at<double>(bytes, data + 8), -0.5);
  EXPECT_EQ(raw_at<double>(bytes, data + 8 + 32 + 8), 0.5);
}

TEST(PointData, VtpHoldsNumbersOfFacets) {
  const std::string bytes = written({.surface = kSurface, .facet_arrays = {{"angle_error", {0.25, 7}}}}, MarkedFormat::vtp);
  EXPECT_TRUE(contains(bytes, {"<CellData Scalars=\"angle_error\">", "Name=\"angle_error\"", "</CellData>\n"}));
  EXPECT_EQ(bytes.find("PointData"), bytes.npos);
  const std::size_t data = bytes.find("   _") + 4;
  EXPECT_EQ(raw_at<std::uint64_t>(bytes, data), 16u);
  EXPECT_EQ(raw_at<double>(bytes, data + 8), 0.25);
  EXPECT_EQ(raw_at<double>(bytes, data + 16), 7);
}

// Three numbers a point, in either format; what is no number is 0 in a PLY.
TEST(PointData, ArraysMayBeVectors) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  PointData data{kSurface, {{"quality", {1, 2, nan, 4}}, {"normal", {0, 0, 1, 0, 1, 0, 1, 0, 0, nan, nan, nan}, 3}}, {}};
  data.color_range = 3;
  const std::string vtp = written(data, MarkedFormat::vtp);
  EXPECT_TRUE(contains(vtp, {"Name=\"normal\" NumberOfComponents=\"3\""}));
  const std::size_t first = vtp.find("   _") + 4;
  EXPECT_TRUE(std::isnan(raw_at<double>(vtp, first + 8 + 16)));
  EXPECT_EQ(raw_at<std::uint64_t>(vtp, first + 8 + 32), 96u);
  EXPECT_EQ(raw_at<double>(vtp, first + 8 + 32 + 8 + 16), 1);
  const std::string ply = written(data, MarkedFormat::ply);
  EXPECT_TRUE(contains(ply, {"property double quality\nproperty double nx\nproperty double ny\nproperty double nz\nproperty uchar red\n",
                             "from -3 (blue) by 0 (grey) to 3 (red)"}));
  const std::size_t body = ply.find("end_header\n") + 11, vertex = 24 + 32 + 3;
  EXPECT_EQ(raw_at<double>(ply, body + 24), 1);
  EXPECT_EQ(raw_at<double>(ply, body + vertex + 24 + 16), 1);
  EXPECT_EQ(raw_at<double>(ply, body + 2 * vertex + 24), 0);
  EXPECT_EQ(raw_at<double>(ply, body + 3 * vertex + 24 + 8), 0);
}

TEST(PointData, PlyIsReadAsItsSurface) {
  const std::string bytes = written(example(), MarkedFormat::ply);
  EXPECT_TRUE(contains(bytes, {"comment a line\ncomment another\n", "comment colours deviation from -0.5 (blue) by 0 (grey) to 0.5 (red)\n",
                               "property double deviation\nproperty double distance\nproperty uchar red\n"}));
  const std::size_t body = bytes.find("end_header\n") + 11, vertex = 24 + 16 + 3;
  EXPECT_EQ(bytes.size() - body, 4 * vertex + 2 * 13);
  EXPECT_EQ(raw_at<double>(bytes, body + 2 * vertex + 24), 0.25);
  EXPECT_EQ(static_cast<unsigned char>(bytes[body + 40 + 2]), 192) << "the least is blue";
  const MeshFile read = read_text(bytes, "x.ply");
  EXPECT_EQ(read.soup.points, kSurface.points);
  EXPECT_EQ(read.soup.facets, kSurface.facets);
}

TEST(PointData, ColoursRunFromBlueByGreyToRed) {
  EXPECT_EQ(diverging_color(-2, 2), color_of(59, 76, 192));
  EXPECT_EQ(diverging_color(-9, 2), color_of(59, 76, 192));
  EXPECT_EQ(diverging_color(0, 2), color_of(221, 221, 221));
  EXPECT_EQ(diverging_color(0, 0), color_of(221, 221, 221));
  EXPECT_EQ(diverging_color(2, 2), color_of(180, 4, 38));
  for (int i = 0; i < 3; ++i) {
    const double half = (channel(diverging_color(0, 1), i) + channel(diverging_color(1, 1), i)) / 2.0;
    EXPECT_NEAR(channel(diverging_color(0.5, 1), i), half, 0.5);
  }
}

}  // namespace
}  // namespace burnish
