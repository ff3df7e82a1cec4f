#include <fmt/format.h>

#include "manual.h"

namespace burnish {
namespace {

// In a table's cell.
std::string cell(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '|' || c == '*' || c == '<') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result;
}

std::string list_of(const std::vector<std::string_view>& words) {
  std::string result;
  for (const std::string_view word : words) result += fmt::format("{}`{}`", result.empty() ? "" : ", ", word);
  return result;
}

std::string kind_of(const Value& value) {
  std::string words = list_of(value.words);
  const std::string or_words = words.empty() ? "" : fmt::format(", or {}", words);
  switch (value.kind) {
    case Value::Kind::text: return "";
    case Value::Kind::file: return words.empty() ? "a file" : fmt::format("a file: {}", words);
    case Value::Kind::folder: return "a folder";
    case Value::Kind::word: return words;
    case Value::Kind::word_list: return fmt::format("some of {}", words);
    case Value::Kind::named_word: return fmt::format("T: {}", words);
    case Value::Kind::length: return "a length" + or_words;
    case Value::Kind::number: return "a number" + or_words;
    case Value::Kind::count: return "a whole number";
    case Value::Kind::bytes: return "an amount of memory";
  }
  return "";
}

std::string option_row(const Option& option) {
  const std::string letter = option.letter != 0 ? fmt::format("`-{}`, ", option.letter) : "";
  const std::string value = option.value.empty() ? "" : fmt::format(" {}", option.value.name);
  return fmt::format("| {}`{}{}` | {} | {} |\n", letter, option.name, value, kind_of(option.value), cell(option.help));
}

std::string command_section(const DescribedCommand& described) {
  const CommandLine& line = described.line;
  std::string text = fmt::format("\n## {}\n\n{}\n\n```\n", described.name, cell(line.summary));
  for (const std::string_view usage : line.usage) text += fmt::format("{}\n", usage);
  text += "```\n";
  if (!line.operands.empty()) text += "\n| operand | value | |\n|---|---|---|\n";
  for (const Operand& operand : line.operands) text += fmt::format("| `{}` | {} | {} |\n", operand.value.name, kind_of(operand.value), cell(operand.help));
  for (const std::string_view group : groups_of(line)) {
    text += fmt::format("\n| {} | value | |\n|---|---|---|\n", group);
    for (const Option& option : line.options)
      if (option.group == group) text += option_row(option);
  }
  return text;
}

}  // namespace

std::string options_as_markdown() {
  std::string text =
      "# Options\n\nAll options of all commands, written by `scripts/generate_docs` from the program's own tables. What they are good for is told in\n"
      "[cli.md](cli.md). Lengths are `0.5` (the model's units), `0.2%` (of the diagonal) or, where there are cells, `2h`.\n\n| command | |\n|---|---|\n";
  const std::vector<DescribedCommand> all = described_commands();
  for (const DescribedCommand& described : all) text += fmt::format("| [`{0}`](#{0}) | {1} |\n", described.name, cell(described.summary));
  for (const DescribedCommand& described : all) text += command_section(described);
  return text;
}

}  // namespace burnish
