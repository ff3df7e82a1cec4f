#include <fmt/format.h>

#include <algorithm>

#include "command_line.h"
#include "manual.h"

namespace burnish {
namespace {

constexpr std::size_t kWidth = 80;
constexpr std::size_t kTextColumn = 24;

// `text` broken at blanks so that it fits between kTextColumn and kWidth; the first line is unindented.
std::string wrapped(std::string_view text) {
  std::string result;
  std::size_t column = kTextColumn;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(word.size() + 1, text.size()));
    if (column + word.size() > kWidth) {
      result.back() = '\n';
      result.append(kTextColumn, ' ');
      column = kTextColumn;
    }
    result.append(word);
    result.push_back(' ');
    column += word.size() + 1;
  }
  result.back() = '\n';
  return result;
}

std::string entry(const std::string& term, std::string_view text) {
  if (term.size() + 2 > kTextColumn) return fmt::format("{}\n{:{}}{}", term, "", kTextColumn, wrapped(text));
  return fmt::format("{:<{}}{}", term, kTextColumn, wrapped(text));
}

std::string term_of(const Option& option) {
  const std::string letter = option.letter != 0 ? fmt::format("-{}, ", option.letter) : "    ";
  return fmt::format("  {}{}{}{}", letter, option.name, option.value.empty() ? "" : " ", option.value.name);
}

}  // namespace

std::string help_text(const CommandLine& line) {
  std::string text = fmt::format("{}\n\n", line.summary);
  for (std::size_t i = 0; i < line.usage.size(); ++i) {
    text += fmt::format("{:<7}{}\n", i == 0 ? "Usage:" : "", line.usage[i]);
  }
  if (!line.operands.empty()) text += '\n';
  for (const Operand& operand : line.operands) {
    text += entry(fmt::format("  {}", operand.value.name), operand.help);
  }
  for (const std::string_view group : groups_of(line)) {
    text += fmt::format("\n{}:\n", group);
    for (const Option& option : line.options)
      if (option.group == group) text += entry(term_of(option), option.help);
  }
  if (!line.notes.empty()) text += fmt::format("\n{}", line.notes);
  return text;
}

}  // namespace burnish
