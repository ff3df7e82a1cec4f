// The evaluation data, where they are: real files that are valid solids already come back as they are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "burnish/pipeline/clean.h"
#include "support/folder.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;
using namespace test;

fs::path data_folder() {
  const char* named = std::getenv("BURNISH_SHARED_DATA");
  return named && *named ? fs::path(named) : fs::path(BURNISH_SOURCE_DIR) / ".." / "shared" / "data";
}

using Row = std::map<std::string, std::string>;

// The manifest's rows, each by the names of the columns. Empty where there is no manifest.
std::vector<Row> manifest() {
  const auto cells = [](const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream in(line);
    for (std::string field; std::getline(in, field, '\t');) fields.push_back(field);
    return fields;
  };
  std::ifstream in(data_folder() / "MANIFEST.tsv");
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> names = cells(line);
  std::vector<Row> rows;
  while (std::getline(in, line)) {
    const std::vector<std::string> fields = cells(line);
    Row& row = rows.emplace_back();
    for (std::size_t i = 0; i < std::min(names.size(), fields.size()); ++i) row[names[i]] = fields[i];
  }
  return rows;
}

fs::path file_of(const Row& row) { return data_folder() / row.at("class") / (row.at("name") + ".stl"); }

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
