// The page of --html: what is encoded comes back, pictures have no more facets than they may, and names are data.
#include "burnish/pipeline/html_report.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "burnish/core/parallel.h"
#include "burnish/surface/weld.h"
#include "html_encode.h"
#include "html_reduce.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;
using nlohmann::json;

Bytes from_base64(const std::string& text) {
  static const std::string kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  Bytes bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(kDigits.find(c));
    if ((count += 6) >= 8) bytes.push_back(static_cast<std::uint8_t>(bits >> (count -= 8)));
  }
  return bytes;
}

Bytes inflated(const std::string& text) {
  const Bytes packed = from_base64(text);
  Bytes bytes(std::size_t{1} << 26);
  uLongf length = bytes.size();
  EXPECT_EQ(uncompress(bytes.data(), &length, packed.data(), packed.size()), Z_OK);
  bytes.resize(length);
  return bytes;
}

// As src/html/decode.js does it.
std::vector<std::uint16_t> unpacked_tuples(const Bytes& bytes, std::size_t channels) {
  const std::size_t n = bytes.size() / (2 * channels);
  std::vector<std::uint16_t> values(n * channels);
  for (std::size_t c = 0; c < channels; ++c) {
    int value = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const int code = bytes[2 * c * n + i] | bytes[(2 * c + 1) * n + i] << 8;
      value += (code >> 1) ^ -(code & 1);
      values[i * channels + c] = static_cast<std::uint16_t>(value);
    }
  }
  return values;
}

std::vector<std::uint32_t> unpacked_indices(const Bytes& bytes) {
  std::vector<std::uint32_t> indices;
  std::uint32_t next = 0;
  for (std::size_t at = 0; at < bytes.size();) {
    std::uint32_t below = 0;
    for (int shift = 0;; shift += 7) {
      below |= (bytes[at] & 127u) << shift;
      if ((bytes[at++] & 128) == 0) break;
    }
    indices.push_back(next - below);
    next += below == 0;
  }
  return indices;
}

CleanSurfaces surfaces_of(const TriangleSoup& before, const TriangleSoup& after) { return {weld(before), weld(after)}; }

RepairReport report_of(const CleanSurfaces& surfaces) {
  RepairReport report;
  report.input = "a.stl";
  report.output = "b.stl";
  report.before = inspect(surfaces.before).defects;
  report.after = inspect(surfaces.after).defects;
  return report;
}

json data_of(const std::string& page, const std::string& id) {
  const std::string mark = "id=\"" + id + "\">";
  const std::size_t at = page.find(mark) + mark.size();
  return json::parse(page.substr(at, page.find("</script>", at) - at));
}

TEST(HtmlEncode, PointsComeBackWithinHalfAStep) {
  const TriangleSoup soup = mapped(icosphere(4), [](const Vec3& p) { return Vec3{1e6 + 3 * p.x, p.y, 1e-3 * p.z}; });
  const Quantisation q = Quantisation::of(bounding_box(soup));
  const auto values = unpacked_tuples(inflated(encoded_points(soup.points, q)), 3);
  ASSERT_EQ(values.size(), 3 * soup.points.size());
  for (std::size_t p = 0; p < soup.points.size(); ++p)
    for (int a = 0; a < 3; ++a)
      EXPECT_LE(std::abs(q.lower[a] + values[3 * p + static_cast<std::size_t>(a)] * q.step[a] - soup.points[p][a]), (0.5 + 1e-4) * q.step[a]) << p;
  EXPECT_DOUBLE_EQ(q.step.x, 6.0 / 65535);
}

TEST(HtmlEncode, FlatAndEmptyBoxes) {
  const std::vector<Vec3> flat = {{0, 0, 5}, {1, 0, 5}};
  Box3 box;
  for (const Vec3& p : flat) box.extend(p);
  const Quantisation q = Quantisation::of(box);
  EXPECT_EQ(q.step.z, 0);
  EXPECT_EQ(unpacked_tuples(inflated(encoded_points(flat, q)), 3), (std::vector<std::uint16_t>{0, 0, 0, 65535, 0, 0}));
  EXPECT_EQ(Quantisation::of({}).step, Vec3{});
  EXPECT_TRUE(inflated(encoded_points({}, {})).empty());
}

TEST(HtmlEncode, DifferencesWrapAround) {
  const std::vector<std::uint16_t> values = {0, 65535, 1, 32768, 0, 32767, 65535, 65535};
  for (const std::size_t channels : {1u, 2u, 4u}) EXPECT_EQ(unpacked_tuples(packed_tuples(values, channels), channels), values);
}

TEST(HtmlEncode, FacetsComeBackInTheOrderOfFirstUse) {
  TriangleSoup soup = icosphere(5);
  soup.points.insert(soup.points.begin(), {9, 9, 9});  // no facet uses it
  for (Facet& f : soup.facets)
    for (std::uint32_t& p : f) ++p;
  const TriangleSoup ordered = ordered_by_first_use(soup);
  EXPECT_EQ(ordered.points.size(), soup.points.size() - 1);
  const Bytes bytes = packed_indices(ordered.facets);
  const std::vector<std::uint32_t> indices = unpacked_indices(bytes);
  ASSERT_EQ(indices.size(), 3 * soup.facets.size());
  for (std::size_t i = 0; i < indices.size(); ++i) ASSERT_EQ(ordered.points[indices[i]], soup.corner(i / 3, static_cast<int>(i % 3))) << i;
  EXPECT_LT(bytes.size(), 2 * indices.size());
}

TEST(HtmlEncode, ValuesComeBackWithinHalfOf32767ths) {
  const std::vector<double> values = {0, 0.25, -0.25, 0.1, -1e-9, 0.2499};
  const auto numbers = unpacked_tuples(inflated(encoded_values(values, 0.25)), 1);
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(static_cast<std::int16_t>(numbers[i]) * 0.25 / 32767, values[i], 0.25 / 65534 * (1 + 1e-9));
  EXPECT_EQ(unpacked_tuples(inflated(encoded_values(std::vector<double>{0, 0}, 0)), 1), (std::vector<std::uint16_t>{0, 0}));
}

TEST(HtmlReduce, KeepsTheShapeAndThePointsThatWereMarked) {
  const TriangleSoup sphere = without_facets(icosphere(6), {0, 1, 2, 3});  // 81,916 facets
  const Inspection found = inspect(sphere, {.elements = true});
  std::vector<bool> kept(sphere.points.size());
  for (const DefectiveEdge& e : found.elements.open_edges)
    for (const std::uint32_t p : e.points) kept[p] = true;
  const TriangleSoup small = reduced_for_drawing(sphere, 8000, kept);
  EXPECT_LE(small.facets.size(), 8000u);
  EXPECT_GE(small.facets.size(), 2500u);
  EXPECT_NEAR(signed_volume(small), signed_volume(sphere), 0.02 * signed_volume(sphere));
  for (std::size_t p = 0; p < kept.size(); ++p) {
    if (kept[p]) {
      EXPECT_NE(std::find(small.points.begin(), small.points.end(), sphere.points[p]), small.points.end()) << p;
    }
  }
  for (const Facet& f : small.facets) EXPECT_TRUE(f[0] != f[1] && f[1] != f[2] && f[2] != f[0]);
}

TEST(HtmlReduce, BothSidesOfAThinWallStayApart) {
  TriangleSoup top = height_field(100, [](int, int) { return 1e-4; });
  const TriangleSoup wall = merged(top, flipped(height_field(100, [](int, int) { return 0.0; })));
  const TriangleSoup small = reduced_for_drawing(wall, 4000, {});
  EXPECT_LE(small.facets.size(), 4000u);
  for (const Vec3& p : small.points) EXPECT_TRUE(p.z == 0 || std::abs(p.z - 1e-4) < 1e-15) << p.z;
  EXPECT_NEAR(area(small), 2, 0.1);
}

TEST(HtmlReduce, SmallOnesStayAndBrokenOnesEnd) {
  EXPECT_EQ(reduced_for_drawing(cube(), 12, {}).facets, cube().facets);
  EXPECT_TRUE(reduced_for_drawing({}, 10, {}).facets.empty());
  TriangleSoup copies{cube().points, {}, {}, {}};  // all the same: no grid but one cell thins them out
  copies.facets.assign(100, cube().facets[0]);
  EXPECT_LE(reduced_for_drawing(copies, 10, std::vector<bool>(8, true)).facets.size(), 10u);
}

TEST(HtmlReport, SignedDistancesOfASphereInASphere) {
  const CleanSurfaces surfaces = surfaces_of(icosphere(5), scaled(icosphere(4), 0.9));
  const json drawing = data_of(html_report(report_of(surfaces), surfaces), "drawing-data");
  const json& deviation = drawing["deviation"];
  EXPECT_NEAR(deviation["least"].get<double>(), -0.1, 1e-3);
  EXPECT_DOUBLE_EQ(deviation["scale"].get<double>(), 0.1);
  const double largest = deviation["largest"];
  const auto numbers = unpacked_tuples(inflated(deviation["values"]), 1);
  ASSERT_EQ(numbers.size(), surfaces.after.points.size());
  for (const std::uint16_t n : numbers) EXPECT_NEAR(static_cast<std::int16_t>(n) * largest / 32767, -0.1, 1e-3);
  EXPECT_EQ(drawing["before"]["facets"], surfaces.before.facets.size());
  EXPECT_EQ(drawing["before"]["facets_of_whole"], surfaces.before.facets.size());
}

TEST(HtmlReport, AFilledHoleIsBeyondTheBorderAndTheRestIsNot) {
  const TriangleSoup sphere = icosphere(3);
  std::vector<std::size_t> cut;
  for (std::size_t f = 0; f < sphere.facets.size(); ++f)
    if (sphere.corner(f, 0).z > 0.8 && sphere.corner(f, 1).z > 0.8 && sphere.corner(f, 2).z > 0.8) cut.push_back(f);
  const CleanSurfaces surfaces = surfaces_of(without_facets(sphere, cut), sphere);
  const json drawing = data_of(html_report(report_of(surfaces), surfaces), "drawing-data");
  // The points that the cut facets alone use.
  const std::size_t gone = sphere.points.size() - ordered_by_first_use(surfaces.before).points.size();
  ASSERT_GT(gone, 10u);
  EXPECT_EQ(drawing["deviation"]["beyond_border"], gone);
  const json& loops = drawing["before"]["marks"]["open_loop"];
  EXPECT_EQ(loops["total"], 1);
  const auto normal = loops["listed"][0]["normal"].get<std::vector<double>>();
  EXPECT_GT(normal[2], 0.99);  // where to look from
  EXPECT_EQ(loops["lines"]["count"], report_of(surfaces).before.open_edges);
}

TEST(HtmlReport, IntersectionsThatARunHasFoundAreNotLookedForAgain) {
  CleanSurfaces surfaces = surfaces_of(merged(cube(), moved(scaled(cube(), 0.5), {0.75, 0.25, 0.25})), cube());
  const RepairReport report = report_of(surfaces);
  const auto pairs = inspect(surfaces.before).self_intersections;
  ASSERT_GT(pairs.size(), 1u);
  const std::string found = html_report(report, surfaces);
  surfaces.intersecting_before = pairs;
  EXPECT_EQ(html_report(report, surfaces), found);
  surfaces.intersecting_before.resize(1);  // what is told is believed
  EXPECT_EQ(data_of(html_report(report, surfaces), "drawing-data")["before"]["marks"]["self_intersection"]["triangles"]["count"], 2);
}

TEST(HtmlReport, UnchangedSurfacesHaveNoDistance) {
  const CleanSurfaces surfaces = surfaces_of(cube(), cube());
  const json deviation = data_of(html_report(report_of(surfaces), surfaces), "drawing-data")["deviation"];
  EXPECT_EQ(deviation["differs"], false);
  EXPECT_EQ(deviation["beyond_border"], 0);
}

TEST(HtmlReport, WithoutAResult) {
  const CleanSurfaces surfaces{weld(height_field(2, [](int, int) { return 0.0; })), {}};
  RepairReport report = report_of(surfaces);
  report.after = {};
  const json drawing = data_of(html_report(report, surfaces), "drawing-data");
  EXPECT_TRUE(drawing["deviation"].is_null());
  EXPECT_EQ(drawing["after"]["facets"], 0);
  EXPECT_EQ(data_of(html_report({}, {}), "drawing-data")["before"]["facets"], 0);
}

TEST(HtmlReport, NamesAreDataWhateverTheyAre) {
  RepairReport report;
  report.input = "</script><script>alert(1)</script><!--{{drawing}}\xff.stl";
  report.warnings = {"<b>"};
  const std::string page = html_report(report, {}), plain = html_report({}, {});
  const auto count = [](const std::string& text, std::string_view word) {
    std::size_t n = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
    return n;
  };
  for (const char* word : {"<script", "</script", "<!--", "<b>"}) EXPECT_EQ(count(page, word), count(plain, word)) << word;
  EXPECT_EQ(data_of(page, "report-data")["input"]["file"], "</script><script>alert(1)</script><!--{{drawing}}\xef\xbf\xbd.stl");
  EXPECT_EQ(data_of(page, "report-data").dump(), json::parse(to_json(report)).dump());
}

TEST(HtmlReport, HoldsItsPartsAndAsksForNothingElse) {
  const std::string page = html_report({}, {});
  EXPECT_EQ(page.find("{{"), std::string::npos);
  for (const char* part : {"THREE=", "class TwinView", "function unpackedTuples", "--accent:", "default-src 'none'"}) EXPECT_NE(page.find(part), std::string::npos) << part;
  for (const char* asks : {"<link", "src=\"", "import(", "@import", "url("}) EXPECT_EQ(page.substr(0, page.find("three.js")).find(asks), std::string::npos) << asks;
}

TEST(HtmlReport, SameBytesForAnyNumberOfThreads) {
  const TriangleSoup sphere = without_facets(icosphere(7), {5, 6, 7, 1000});  // 327,676 facets: drawn simplified
  const CleanSurfaces surfaces = surfaces_of(mapped(sphere, [](const Vec3& p) { return p * (1 + 0.01 * std::sin(40 * p.x)); }), icosphere(5));
  const RepairReport report = report_of(surfaces);
  std::string first;
  for (const int threads : {1, 2, 7}) {
    const ThreadLimit limit(threads);
    const std::string page = html_report(report, surfaces);
    if (first.empty()) first = page;
    EXPECT_TRUE(page == first) << threads;
  }
  const json before = data_of(first, "drawing-data")["before"];
  EXPECT_LE(before["facets"].get<std::size_t>(), kMostDrawnFacets);
  EXPECT_EQ(before["facets_of_whole"], sphere.facets.size());
}

}  // namespace
}  // namespace burnish
