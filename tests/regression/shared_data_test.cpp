// The evaluation data, where they are: real files that are valid solids already come back as they are.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "burnish/pipeline/clean.h"
#include "support/folder.h"
#include "support/shared_data.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;
using namespace test;

TEST(SharedData, ValidSolidsStayWhatTheyAre) {
  constexpr std::size_t kModels = 4;
  std::vector<Row> chosen;
  for (const Row& row : manifest())
    if (row.at("expect") == "valid solid" && row.contains("volume_ref") && std::stoul(row.at("triangles")) >= 500 && fs::exists(file_of(row)))
      chosen.push_back(row);
  if (chosen.empty()) GTEST_SKIP() << "no evaluation data at " << data_folder();
  std::sort(chosen.begin(), chosen.end(),
            [](const Row& a, const Row& b) { return std::stoul(a.at("triangles")) < std::stoul(b.at("triangles")); });
  chosen.resize(std::min(chosen.size(), kModels));
  const Folder folder;
  for (const Row& row : chosen) {
    SCOPED_TRACE(row.at("name"));
    CleanJob job;
    job.input = file_of(row);
    job.output = folder.path(row.at("name") + ".stl");
    const RepairReport report = clean(job);
    EXPECT_FALSE(report.failure) << report.failure->what();
    EXPECT_TRUE(report.verified);
    EXPECT_NEAR(report.after.volume / std::stod(row.at("volume_ref")), 1, 0.005);
    EXPECT_LE(report.deviation.output_to_input.rms, 0.1 * report.options.cell);
    EXPECT_LE(report.deviation.output_to_input.max, 1.0 * report.options.cell);
  }
}

// What the program says of small broken files is true, whether it could mend them or not.
TEST(SharedData, SmallDirtyFilesEndTruthfully) {
  std::size_t looked_at = 0;
  const Folder folder;
  for (const Row& row : manifest()) {
    if (row.at("class") != "a_dirty" || std::stoul(row.at("triangles")) > 1500 || !fs::exists(file_of(row))) continue;
    if (++looked_at > 12) break;
    SCOPED_TRACE(row.at("name"));
    CleanJob job;
    job.input = file_of(row);
    job.output = folder.path(row.at("name") + ".stl");
    job.options.resolution = 64;
    const RepairReport report = clean(job);
    EXPECT_EQ(report.verified, report.after.valid_solid());
    EXPECT_NE(report.verified, report.failure.has_value());
    EXPECT_EQ(report.written, report.verified);
    EXPECT_EQ(report.written, fs::exists(job.output));
  }
  if (looked_at == 0) GTEST_SKIP() << "no evaluation data at " << data_folder();
}

}  // namespace
}  // namespace burnish
