// Runs of the whole program with one option or another, from file to file, and what is expected of their results.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <initializer_list>
#include <iterator>
#include <string>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/pipeline/clean.h"
#include "burnish/surface/weld.h"
#include "support/folder.h"
#include "support/shapes.h"

namespace burnish::test {

class PipelineOptions : public ::testing::Test {
 protected:
  RepairReport run(const TriangleSoup& soup, const CleanOptions& options = {}, const std::string& out = "out.stl", const std::string& in = "in.ply") {
    CleanJob job;
    job.input = folder_.write(in, soup);
    job.output = folder_.path(out);
    job.options = options;
    job.overwrite = true;
    return clean(job);
  }
  Folder folder_;
};

inline CleanOptions with_method(Method method) {
  CleanOptions options;
  options.method = method;
  return options;
}

// The same, with coarse cells where there are any.
inline CleanOptions quick(Method method) {
  CleanOptions options = with_method(method);
  if (method == Method::level_set) options.resolution = 40;
  return options;
}

inline CleanOptions keeping_openings() {
  CleanOptions options;
  options.keep_openings = true;
  return options;
}

inline Length model_length(double value) { return {value, LengthUnit::model}; }

inline void expect_solid(const RepairReport& report, double volume, std::size_t components = 1, double tolerance = 0.02) {
  ASSERT_FALSE(report.failure) << report.failure->what();
  EXPECT_TRUE(report.verified && report.written && !report.is_sheet);
  EXPECT_TRUE(report.after.valid_solid());
  EXPECT_EQ(report.after.components, components);
  EXPECT_NEAR(report.after.volume / volume, 1, tolerance);
}

inline void expect_sheet(const RepairReport& report, std::size_t loops) {
  ASSERT_FALSE(report.failure) << report.failure->what();
  EXPECT_TRUE(report.verified && report.written && report.is_sheet);
  EXPECT_TRUE(report.after.valid_sheet());
  EXPECT_EQ(report.after.open_loops, loops);
}

inline void expect_failure(const RepairReport& report, std::initializer_list<std::string> hints) {
  ASSERT_TRUE(report.failure);
  EXPECT_EQ(report.failure->code(), ErrorCode::guarantee_unmet);
  for (const std::string& hint : hints) EXPECT_NE(report.failure->hint().find(hint), std::string::npos) << hint << " is not in: " << report.failure->hint();
  EXPECT_FALSE(report.verified);
  EXPECT_FALSE(report.written);
}

inline TriangleSoup without_facets_where(const TriangleSoup& soup, const std::function<bool(const Vec3&)>& drop) {
  std::vector<std::size_t> facets;
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    if (drop((soup.corner(f, 0) + soup.corner(f, 1) + soup.corner(f, 2)) / 3)) facets.push_back(f);
  return weld(without_facets(soup, facets));
}

inline std::vector<ComponentFate> with_fate(const RepairReport& report, const std::string& fate) {
  std::vector<ComponentFate> found;
  std::copy_if(report.components.begin(), report.components.end(), std::back_inserter(found), [&](const ComponentFate& c) { return c.fate == fate; });
  return found;
}

}  // namespace burnish::test
