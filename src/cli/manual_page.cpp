#include <fmt/format.h>

#include "burnish/core/build_info.h"
#include "manual.h"

namespace burnish {
namespace {

// Text that roff prints as it is: hyphens that can be copied, no ligature of quotes, no control line.
std::string roff(std::string_view text) {
  std::string result;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) result += "\\&";
    line_begins = c == '\n';
    switch (c) {
      case '\\': result += "\\e"; break;
      case '-': result += "\\-"; break;
      case '\'': result += "\\(aq"; break;
      case '`': result += "\\(ga"; break;
      case '^': result += "\\(ha"; break;
      case '~': result += "\\(ti"; break;
      default: result += c;
    }
  }
  return result;
}

// `items` as they are typed, in bold, between commas.
std::string words_in_bold(const std::vector<std::string_view>& items) {
  std::string result;
  for (const std::string_view item : items) result += fmt::format("{}\\fB{}\\fR", result.empty() ? "" : ", ", roff(item));
  return result;
}

std::string value_sentence(const Value& value) {
  if (value.words.empty()) return "";
  const std::string words = words_in_bold(value.words);
  switch (value.kind) {
    case Value::Kind::word: return fmt::format("\n{} is one of {}.", roff(value.name), words);
    case Value::Kind::word_list: return fmt::format("\n{} is some of {}, between commas.", roff(value.name), words);
    case Value::Kind::named_word: return fmt::format("\nEach T is one of {}.", words);
    case Value::Kind::file: return fmt::format("\nSuffixes: {}.", words);
    default: return "";
  }
}

std::string option_entry(const Option& option) {
  std::string term = option.letter != 0 ? fmt::format("\\fB\\-{}\\fR, ", option.letter) : "";
  term += fmt::format("\\fB{}\\fR", roff(option.name));
  if (!option.value.empty()) term += fmt::format(" \\fI{}\\fR", roff(option.value.name));
  const std::string repeatable = option.repeatable && option.help.find("repeated") == option.help.npos ? "\nMay be repeated." : "";
  return fmt::format(".TP\n{}\n{}{}{}\n", term, roff(option.help), value_sentence(option.value), repeatable);
}

// Whether the paragraph is to stay in lines: a heading such as "Examples:", or what stands under one.
bool is_example(std::string_view paragraph) { return paragraph.starts_with("Example"); }

// The notes of a command's help: paragraphs between empty lines, examples with a line each.
std::string notes_text(std::string_view notes) {
  std::string result;
  while (!notes.empty()) {
    const std::size_t end = notes.find("\n\n");
    std::string_view paragraph = notes.substr(0, end);
    notes.remove_prefix(end == notes.npos ? notes.size() : end + 2);
    if (paragraph.ends_with('\n')) paragraph.remove_suffix(1);
    if (is_example(paragraph)) {
      const std::size_t line = paragraph.find('\n');
      result += fmt::format(".PP\n{}\n.PP\n.nf\n{}\n.fi\n", roff(paragraph.substr(0, line)), roff(paragraph.substr(line + 1)));
    } else {
      result += fmt::format(".PP\n{}\n", roff(paragraph));
    }
  }
  return result;
}

std::string command_section(const DescribedCommand& described) {
  const CommandLine& line = described.line;
  std::string text = fmt::format(".SS \"burnish {}\"\n{}\n", roff(described.name), roff(line.summary));
  for (const std::string_view usage : line.usage) text += fmt::format(".PP\n.B {}\n", roff(usage));
  for (const Operand& operand : line.operands) text += fmt::format(".TP\n\\fI{}\\fR\n{}{}\n", roff(operand.value.name), roff(operand.help), value_sentence(operand.value));
  for (const std::string_view group : groups_of(line)) {
    text += fmt::format(".PP\n{}:\n", roff(group));
    for (const Option& option : line.options)
      if (option.group == group) text += option_entry(option);
  }
  return text + notes_text(line.notes);
}

constexpr std::string_view kDescription = R"(.SH DESCRIPTION
Burnish turns a dirty triangle file (holes, cracks, flipped and overlapping
facets, noise) into one that is closed, oriented and free of
self\-intersections. The written file is read back and verified with exact
predicates before it gets its name. When that cannot be delivered, the program
says why, writes nothing, and exits with a code that tells so.
.PP
Files are STL (binary and ASCII), OBJ, PLY and OFF. What a file is gets decided
by its content, then by its name; what is written is decided by the name.
\(lq\-\(rq stands for standard input or standard output. Files that exist already
are replaced with
.B \-\-overwrite
only.
.PP
Lengths are in the model\(aqs units (0.5), in percent of the diagonal of its
bounding box (0.2%), or in cells (2h).
.PP
The word
.B clean
may be left out.
.B burnish help
.I command
and
.B burnish
.I command
.B \-\-help
print a command\(aqs options;
.B burnish \-\-version
prints the version and what it was built from and with, as JSON with
.BR \-\-json .
)";

constexpr std::string_view kEnd = R"(.SH ENVIRONMENT
.TP
.B TMPDIR
Where what goes to standard output is kept until it is verified; /tmp when not
set.
.SH FILES
Files appear under their names only when they are complete; until then they are
hidden temporaries beside them, which are removed when a run is interrupted.
There are no configuration files.
.SH EXAMPLES
.nf
burnish dirty.stl \-o clean.stl
burnish check part.stl && echo printable
burnish scan.stl \-o smooth.stl \-\-smooth auto
burnish compare part.stl clean.stl \-\-max 0.1%
burnish mesh dirty.stl \-o case \-\-outside
burnish example nozzle \-o \- | burnish \- \-o clean.stl
.fi
.SH SEE ALSO
.BR admesh (1),
.BR meshlab (1),
.BR gmsh (1)
)";

}  // namespace

std::string manual_page() {
  const std::vector<DescribedCommand> all = described_commands();
  std::string text = fmt::format(".\\\" Made by 'burnish man' of the option tables: changes belong there.\n.TH BURNISH 1 {} \"burnish {}\" \"User Commands\"\n", build_info().date,
                                 build_info().version);
  text += ".SH NAME\nburnish \\- repair and smoothing of triangle meshes\n.SH SYNOPSIS\n.nf\n";
  for (const DescribedCommand& described : all) text += fmt::format("{}\n", roff(described.line.usage.front()));
  text += fmt::format("burnish help [COMMAND]\nburnish {}\n.fi\n{}.SH COMMANDS\n", roff("--version [--json]"), kDescription);
  for (const DescribedCommand& described : all) text += command_section(described);
  text += ".SH EXIT STATUS\n";
  for (const ExitStatus& status : exit_statuses()) text += fmt::format(".TP\n.B {}\n{}\n", status.code, roff(status.meaning));
  return text + std::string(kEnd);
}

}  // namespace burnish
