#include <fmt/format.h>

#include "manual.h"

namespace burnish {
namespace {

constexpr std::string_view kFunctions = R"fish(# Completion of burnish for fish; made by 'burnish completion fish'.

# The command that the line is of: the first one where no other is named.
function __burnish_command
    set -l words (commandline -opc)
    if set -q words[2]; and contains -- $words[2] %COMMANDS% help
        echo $words[2]
    else
        echo %FIRST%
    end
end

function __burnish_is
    test (__burnish_command) = $argv[1]
end

function __burnish_at_first
    test (count (commandline -opc)) -eq 1
end

# Folders, and files whose names end in one of the suffixes; all files when there are none.
function __burnish_files
    set -l token (commandline -ct | string replace -r -- '^(--[^=]*=|-[a-z])' '')
    set -l suffixes (string join '|' -- $argv)
    for entry in (complete -C "__burnish_no_such_command $token")
        set -l name (string split -m 1 \t -- $entry)[1]
        if string match -qir -- "(/|$suffixes)\$" $name; or test -z "$suffixes"
            echo $name
        end
    end
end

# Some of the words, between commas.
function __burnish_list
    set -l token (commandline -ct | string replace -r -- '^--[^=]*=' '')
    set -l before (string match -r -- '.*,' $token)
    for word in $argv
        echo $before$word
    end
end

complete -c burnish -f
)fish";

std::string quoted(std::string_view text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result + "'";
}

// Up to the end of the first sentence: lists of candidates are narrow.
std::string_view first_sentence(std::string_view text) {
  const std::size_t end = text.find(". ");
  return text.substr(0, end == text.npos ? text.size() : end + 1);
}

std::string joined(const std::vector<std::string_view>& words) {
  std::string result;
  for (const std::string_view word : words) result += fmt::format("{}{}", result.empty() ? "" : " ", word);
  return result;
}

// What stands behind -a; empty when there is nothing to offer.
std::string candidates(const Value& value) {
  std::string words = joined(value.words);
  switch (value.kind) {
    case Value::Kind::file: return words.empty() ? "(__burnish_files)" : fmt::format("(__burnish_files {})", words);
    case Value::Kind::folder: return "(__fish_complete_directories (commandline -ct | string replace -r -- \"^--[^=]*=\" \"\") \"\")";
    case Value::Kind::word_list: return fmt::format("(__burnish_list {})", words);
    case Value::Kind::word:
    case Value::Kind::length:
    case Value::Kind::number: return words;
    default: return "";
  }
}

std::string option_line(const DescribedCommand& described, const Option& option) {
  std::string text = fmt::format("complete -c burnish -n '__burnish_is {}' -l {}", described.name, option.name.substr(2));
  if (option.letter != 0) text += fmt::format(" -s {}", option.letter);
  if (!option.value.empty()) text += " -x";
  const std::string offered = candidates(option.value);
  if (!offered.empty()) text += fmt::format(" -a {}", quoted(offered));
  return text + fmt::format(" -d {}\n", quoted(first_sentence(option.help)));
}

std::string command_lines(const DescribedCommand& described) {
  std::string text = fmt::format("\n# {}\n", described.name);
  for (const Operand& operand : described.line.operands) {
    const std::string line = fmt::format("complete -c burnish -n '__burnish_is {}' -k -a {}\n", described.name, quoted(candidates(operand.value)));
    if (text.find(line) == text.npos) text += line;
  }
  for (const Option& option : described.line.options) text += option_line(described, option);
  return text;
}

std::string replaced(std::string text, std::string_view what, std::string_view with) {
  for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + with.size())) text.replace(at, what.size(), with);
  return text;
}

}  // namespace

std::string fish_completion() {
  const std::vector<DescribedCommand> all = described_commands();
  std::string names, first, lines;
  for (const DescribedCommand& described : all) {
    names += fmt::format("{}{}", names.empty() ? "" : " ", described.name);
    first += fmt::format("complete -c burnish -n __burnish_at_first -a {} -d {}\n", described.name, quoted(described.summary));
    lines += command_lines(described);
  }
  const std::string of_help = fmt::format("complete -c burnish -n __burnish_at_first -a help -d 'print the help of a command'\ncomplete -c burnish -n '__burnish_is help' -a {}\n", quoted(names));
  return replaced(replaced(std::string(kFunctions), "%COMMANDS%", names), "%FIRST%", all.front().name) + first + of_help + lines;
}

}  // namespace burnish
