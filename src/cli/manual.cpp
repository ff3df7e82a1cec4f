#include "manual.h"

#include <algorithm>

namespace burnish {

std::vector<DescribedCommand> described_commands() {
  std::vector<DescribedCommand> all;
  for (const CommandEntry& entry : commands()) {
    DescribedCommand one{entry.name, entry.summary, entry.make(), {}};
    one.line = full_command_line(*one.command);
    all.push_back(std::move(one));
  }
  return all;
}

std::vector<std::string_view> groups_of(const CommandLine& line) {
  std::vector<std::string_view> groups;
  for (const Option& option : line.options)
    if (std::find(groups.begin(), groups.end(), option.group) == groups.end()) groups.push_back(option.group);
  return groups;
}

const std::vector<ExitStatus>& exit_statuses() {
  static const std::vector<ExitStatus> table = {
      {0, "Done; what was written is verified."},
      {1, "The answer is no: not a valid solid (check), farther apart than --max (compare), or nodes are off by more than allowed (field)."},
      {2, "The command line makes no sense; nothing was read or written."},
      {3, "The input is missing, broken, or holds no facets."},
      {4, "The output exists already, or cannot be written."},
      {5, "A guarantee could not be met, or the input bounds no solid; nothing was written unless --allow-invalid was given."},
      {6, "The resolution asked for needs more memory than is allowed or present."},
      {7, "The run took longer than --time-limit."},
      {70, "A bug of Burnish."},
      {130, "Interrupted; nothing is left behind."},
  };
  return table;
}

}  // namespace burnish
