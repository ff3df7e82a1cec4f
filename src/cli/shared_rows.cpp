#include "shared_rows.h"

#include "values.h"

namespace burnish {

Option nested_row(std::string_view group, CleanOptions& o) {
  return {"--nested", 0, word("N", {"auto", "solid", "cavity"}), group, "What a body inside a body is: 'solid', 'cavity', or 'auto' (default): a cavity if it is oriented so.",
          [&o](const GivenValue& v) { o.nesting = one_of<Nesting>(v); }};
}

Option gap_row(std::string_view group, CleanOptions& o) {
  return {"--gap", 0, length("L"), group, "Close cracks up to a width of L by joining the points on both sides.", [&o](const GivenValue& v) { o.gap = length_without_cells(v); }};
}

Option salvage_row(std::string_view group, bool& salvage) {
  return {"--salvage", 0, "", group, "Take what a truncated or malformed file holds.", switch_on(salvage)};
}

Option threads_row(std::string_view group, int& threads) {
  return {"--threads", 0, count("N"), group, "Use at most N threads. The result does not depend on it.",
          [&threads](const GivenValue& v) { threads = static_cast<int>(integer_within(v, 1, 4096)); }};
}

Option memory_row(std::string_view group, CleanOptions& o) {
  return {"--memory", 0, bytes("SIZE"), group, "Plan to stay below SIZE bytes, such as 800M or 16G. Default: 4G.", [&o](const GivenValue& v) { o.memory_bytes = byte_count(v); }};
}

Option help_row(std::string_view group) {
  return {"--help", 'h', "", group, "Print this help.", [](const GivenValue&) {}};
}

Option quiet_row(std::string_view group, bool& quiet, bool answers) {
  return {"--quiet", 'q', "", group, answers ? "Print errors only: the exit code is the answer." : "Print errors only.", switch_on(quiet)};
}

}  // namespace burnish
