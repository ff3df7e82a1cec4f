// What the report says of the input's groups.
#include <gtest/gtest.h>

#include "burnish/pipeline/report.h"
#include "support/mesh_bytes.h"
#include "support/shapes.h"

namespace burnish {
namespace {

TEST(Report, GroupsHaveNamesFacetsAndArea) {
  TriangleSoup soup = test::merged(test::cube(), test::scaled(test::cube(), 2));
  soup.groups = {{"small", 0, 12}, {"large \xff", 12, 12}};
  RepairReport report;
  report.groups = summaries_of_groups(soup);
  ASSERT_EQ(report.groups.size(), 2u);
  EXPECT_EQ(report.groups[0].facets, 12u);
  EXPECT_NEAR(report.groups[0].area, 6, 1e-12);
  EXPECT_NEAR(report.groups[1].area, 24, 1e-12);
  EXPECT_TRUE(test::contains(to_json(report), {"\"name\": \"small\"", "\"large \xef\xbf\xbd\"", "\"facets\": 12"}));
}

TEST(Report, SoupsWithoutGroupsHaveNone) {
  EXPECT_TRUE(summaries_of_groups(test::cube()).empty());
  EXPECT_TRUE(test::contains(to_json(RepairReport{}), {"\"groups\": []"}));
}

}  // namespace
}  // namespace burnish
