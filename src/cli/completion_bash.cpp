#include <fmt/format.h>

#include "manual.h"

namespace burnish {
namespace {

constexpr std::string_view kFunctions = R"bash(
# Candidates among words.
_burnish_words() {
  mapfile -t COMPREPLY < <(compgen -W "$1" -- "$_burnish_cur")
}

# The same for the last part of a list between commas.
_burnish_list() {
  local before=
  [[ $_burnish_cur == *,* ]] && before=${_burnish_cur%,*},
  mapfile -t COMPREPLY < <(compgen -P "$before" -W "$1" -- "${_burnish_cur##*,}")
  compopt -o nospace 2>/dev/null
}

# Folders, and files whose names end in one of the suffixes between bars; all files when there are none.
_burnish_files() {
  local name
  mapfile -t COMPREPLY < <(compgen -d -- "$_burnish_cur")
  while read -r name; do
    [[ -d $name ]] && continue
    [[ -z $1 || ${name,,} =~ \.($1)$ ]] && COMPREPLY+=("$name")
  done < <(compgen -f -- "$_burnish_cur")
  compopt -o filenames 2>/dev/null
}

_burnish_offer() {
  case $1 in
    word) _burnish_words "$2" ;;
    list) _burnish_list "$2" ;;
    file) _burnish_files "$2" ;;
    folder) mapfile -t COMPREPLY < <(compgen -d -- "$_burnish_cur"); compopt -o filenames 2>/dev/null ;;
  esac
}

_burnish() {
  local _burnish_cur=${COMP_WORDS[COMP_CWORD]} command=%FIRST% begin=1 operands=0 only_operands= kind= list= i word
  COMPREPLY=()
  case " %COMMANDS% " in
    *" ${COMP_WORDS[1]} "*) ((COMP_CWORD > 1)) && command=${COMP_WORDS[1]} begin=2 ;;
  esac
  if [[ ${COMP_WORDS[1]} == help ]] && ((COMP_CWORD == 2)); then
    _burnish_words "%COMMANDS%"
    return
  fi
  # What stands before the word: an option that waits for its value, or operands. `--name=value` are three words.
  for ((i = begin; i < COMP_CWORD; ++i)); do
    word=${COMP_WORDS[i]} kind= list=
    if [[ $only_operands || $word == - || $word != -* ]]; then
      ((++operands))
    elif [[ $word == -- ]]; then
      only_operands=1
    else
      _burnish_option "$command $word"
      [[ $kind ]] || continue
      ((i + 1 < COMP_CWORD)) && [[ ${COMP_WORDS[i + 1]} == = ]] && ((++i))
      ((++i))
      ((i < COMP_CWORD)) && kind=
    fi
  done
  if [[ $kind ]]; then
    [[ $_burnish_cur == = ]] && _burnish_cur=
    _burnish_offer "$kind" "$list"
  elif [[ $_burnish_cur == -* && ! $only_operands ]]; then
    _burnish_options "$command"
    _burnish_words "$list"
  else
    _burnish_operand "$command $operands"
    _burnish_offer "$kind" "$list"
    if ((COMP_CWORD == 1)); then
      mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -W "%COMMANDS% help" -- "$_burnish_cur")
    fi
  fi
}

complete -F _burnish burnish
)bash";

// "kind=file list='stl|ply'": what _burnish_offer takes.
std::string assignments(const Value& value) {
  std::string list;
  const bool is_file = value.kind == Value::Kind::file;
  for (const std::string_view word : value.words) list += fmt::format("{}{}", list.empty() ? "" : is_file ? "|" : " ", is_file ? word.substr(1) : word);
  switch (value.kind) {
    case Value::Kind::file: return fmt::format("kind=file list='{}'", list);
    case Value::Kind::folder: return "kind=folder";
    case Value::Kind::word_list: return fmt::format("kind=list list='{}'", list);
    case Value::Kind::word:
    case Value::Kind::length:
    case Value::Kind::number: return list.empty() ? "kind=nothing" : fmt::format("kind=word list='{}'", list);
    default: return "kind=nothing";
  }
}

std::string option_cases(const DescribedCommand& described) {
  std::string text;
  for (const Option& option : described.line.options) {
    if (option.value.empty()) continue;
    const std::string letter = option.letter != 0 ? fmt::format(" | '{} -{}'", described.name, option.letter) : "";
    text += fmt::format("    '{} {}'{}) {} ;;\n", described.name, option.name, letter, assignments(option.value));
  }
  return text;
}

std::string operand_cases(const DescribedCommand& described) {
  std::string text;
  for (std::size_t i = 0; i < described.line.operands.size(); ++i) text += fmt::format("    '{} {}') {} ;;\n", described.name, i, assignments(described.line.operands[i].value));
  return text;
}

std::string names_of_options(const DescribedCommand& described) {
  std::string names;
  for (const Option& option : described.line.options) names += fmt::format("{}{}", names.empty() ? "" : " ", option.name);
  return fmt::format("    {}) list='{}' ;;\n", described.name, names);
}

std::string function(std::string_view name, const std::string& cases) { return fmt::format("\n{}() {{\n  case $1 in\n{}  esac\n}}\n", name, cases); }

std::string replaced(std::string text, std::string_view what, std::string_view with) {
  for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + with.size())) text.replace(at, what.size(), with);
  return text;
}

}  // namespace

std::string bash_completion() {
  const std::vector<DescribedCommand> all = described_commands();
  std::string names, options, operands, lists;
  for (const DescribedCommand& described : all) {
    names += fmt::format("{}{}", names.empty() ? "" : " ", described.name);
    options += option_cases(described), operands += operand_cases(described), lists += names_of_options(described);
  }
  const std::string text = "# Completion of burnish for bash; made by 'burnish completion bash'.\n\n# What the value of an option is, and what an operand is.\n" +
                           function("_burnish_option", options).substr(1) + function("_burnish_operand", operands) + function("_burnish_options", lists) +
                           std::string(kFunctions);
  return replaced(replaced(text, "%COMMANDS%", names), "%FIRST%", all.front().name);
}

}  // namespace burnish
