#include "burnish/core/error.h"

#include <array>

namespace burnish {
namespace {

struct Row {
  int exit_code;
  std::string_view name;
};

constexpr std::array<Row, 9> kTable{{
    {1, "answer_is_no"},
    {2, "usage"},
    {3, "unreadable_input"},
    {4, "unwritable_output"},
    {5, "guarantee_unmet"},
    {6, "memory_limit"},
    {7, "time_limit"},
    {70, "bug"},
    {130, "interrupted"},
}};

}  // namespace

int exit_code(ErrorCode code) { return kTable[static_cast<std::size_t>(code)].exit_code; }
std::string_view name(ErrorCode code) { return kTable[static_cast<std::size_t>(code)].name; }

}  // namespace burnish
