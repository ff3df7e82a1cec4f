// One command over several inputs: each in a process of its own, then a table.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "burnish/core/model_unit.h"
#include "command_line.h"
#include "console.h"
#include "workers.h"

namespace burnish {

// What --jobs asks for.
struct Jobs {
  int count = 1;  // 0: as many as the machine has threads
  // At most one for each run, and for each of `threads` (0: as many as there are).
  int of(std::size_t runs, int threads) const;
};

// Adds an input that is not empty.
Setter add_input(std::vector<std::string>& inputs);
Option jobs_row(std::string_view group, Jobs& jobs);

struct BatchPlan {
  std::string command;                // "clean"
  std::vector<std::string> inputs;
  std::vector<std::string> outputs;   // one for each, or none at all
  std::string summary;                // file for the summary as JSON; empty: none
  bool overwrite = false;             // of that file
  Jobs jobs;
  int threads = 0;                    // of all together
  Verbosity verbosity = Verbosity::normal;
  bool json = false;                  // print results, not the table
  std::optional<ModelUnit> unit;
  // Does one of them in a process of its own; fills in what the run tells as JSON and returns its exit code. May throw Error and anything else.
  std::function<int(std::size_t run, const Share& share, std::string& told)> work;
};

// Runs and tells: progress and messages on standard error, at the end a table or JSON on standard output. Returns the highest exit code of all.
// Throws Error{interrupted} once the user has asked to stop.
int run_batch(const BatchPlan& plan);

}  // namespace burnish
