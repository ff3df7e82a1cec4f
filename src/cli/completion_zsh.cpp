#include <fmt/format.h>

#include "manual.h"

namespace burnish {
namespace {

// Inside of single quotes, as a description between brackets or colons of _arguments.
std::string described_text(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '\'') {
      result += "'\\''";
      continue;
    }
    if (c == '[' || c == ']' || c == ':' || c == '\\') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result;
}

std::string joined(const std::vector<std::string_view>& words, std::string_view separator, std::size_t skip = 0) {
  std::string result;
  for (const std::string_view word : words) result += fmt::format("{}{}", result.empty() ? "" : separator, word.substr(skip));
  return result;
}

// ":FILE:_files ...", what _arguments takes behind a description.
std::string action(const Value& value) {
  const std::string name = described_text(value.name);
  const auto& words = value.words;
  switch (value.kind) {
    case Value::Kind::file: return words.empty() ? fmt::format(":{}:_files", name) : fmt::format(":{}:_files -g \"*.(#i)({})(-.)\"", name, joined(words, "|", 1));
    case Value::Kind::folder: return fmt::format(":{}:_files -/", name);
    case Value::Kind::word_list: return fmt::format(":{}:_values -s , {} {}", name, name, joined(words, " "));
    case Value::Kind::word:
    case Value::Kind::length:
    case Value::Kind::number: return words.empty() ? fmt::format(":{}: ", name) : fmt::format(":{}:({})", name, joined(words, " "));
    default: return fmt::format(":{}: ", name);
  }
}

std::string option_specs(const Option& option) {
  const std::string text = described_text(option.help);
  const std::string more = option.repeatable ? "*" : "";
  if (option.value.empty()) {
    if (option.letter == 0) return fmt::format("        '{}[{}]' \\\n", option.name, text);
    return fmt::format("        '(-{0} {1})'{{-{0},{1}}}'[{2}]' \\\n", option.letter, option.name, text);
  }
  const std::string rest = fmt::format("[{}]{}", text, action(option.value));
  if (option.letter == 0) return fmt::format("        '{}{}={}' \\\n", more, option.name, rest);
  return fmt::format("        '(-{0} {1})'{{-{0}+,{1}=}}'{2}' \\\n", option.letter, option.name, rest);
}

std::string command_case(const DescribedCommand& described) {
  std::string text = fmt::format("    {})\n      _arguments -s -S \\\n", described.name);
  for (const Option& option : described.line.options) text += option_specs(option);
  for (const Operand& operand : described.line.operands) text += fmt::format("        '{}' \\\n", action(operand.value));
  text.resize(text.size() - 3);
  return text + "\n      ;;\n";
}

}  // namespace

std::string zsh_completion() {
  const std::vector<DescribedCommand> all = described_commands();
  std::string names, cases, table;
  for (const DescribedCommand& described : all) {
    names += fmt::format("{}{}", names.empty() ? "" : "|", described.name);
    table += fmt::format("    '{}:{}'\n", described.name, described_text(described.summary));
    cases += command_case(described);
  }
  return fmt::format(R"zsh(#compdef burnish
# Completion of burnish for zsh; made by 'burnish completion zsh'.

_burnish() {{
  local command={} ret=1
  local -a commands
  commands=(
{}    'help:print the help of a command'
  )
  # The first word is a command, or else the input of the one that needs no name.
  if (( CURRENT == 2 )) && [[ $words[2] != -* ]]; then
    _describe -t commands command commands && ret=0
    _files -g "*.(#i)({})(-.)" && ret=0
    return ret
  fi
  if [[ $words[2] == help ]]; then
    (( CURRENT == 3 )) && _describe -t commands command commands
    return
  fi
  if [[ $words[2] == ({}) ]]; then
    command=$words[2]
    shift words
    (( CURRENT-- ))
  fi
  case $command in
{}  esac
}}

# Loaded as a function of its own, or read as a script.
if [[ $funcstack[1] == _burnish ]]; then
  _burnish "$@"
else
  compdef _burnish burnish
fi
)zsh",
                     all.front().name, table, joined(all.front().line.operands.front().value.words, "|", 1), names, cases);
}

}  // namespace burnish
