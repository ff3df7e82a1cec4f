// Several runs of one command: one line for each, and what they come to together.
//
// Runs hand over what they tell as JSON text (a report, a result of a check, or an error), for they may be processes of their own.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/core/model_unit.h"

namespace burnish {

// What came of one input. Figures are empty where the run did not get as far.
struct BatchFile {
  std::string input;
  std::string output;       // empty: the command writes none
  int exit_code = 0;
  std::string verdict;      // "valid", "sheet", "not valid", "not verified", or why there is no result: "unreadable", "no solid", "crashed", ...
  std::optional<std::uint64_t> facets;              // of the output; of a check, the input
  std::optional<std::uint64_t> open_edges;          // of the input
  std::optional<std::uint64_t> self_intersections;  // of the input, pairs
  std::optional<double> volume;                     // of the output; of a check, the input
  std::optional<double> max_deviation;              // between input and output, the larger way
  std::optional<ModelUnit> unit;                    // of its coordinates: as told for all, or as the file says
  double seconds = 0;                               // wall clock
  std::optional<Error> failure;                     // why the exit code is not 0; a check that finds defects has none
  std::string told;                                 // the JSON text that the run handed over
};

struct BatchResult {
  std::string command;             // "clean" or "check"
  std::optional<ModelUnit> unit;   // as told for all; empty: each file may have its own
  int jobs = 1;                    // runs at once
  double seconds = 0;
  std::vector<BatchFile> files;    // in the order of the inputs

  // The highest of the runs': 0 if all are done and well.
  int exit_code() const;
};

// Fills verdict, figures and failure from `told` and `exit_code`; a text that is no JSON counts as a crash.
void read_told(BatchFile& file);

// As JSON text: what --json prints, and the summary beside reports has it without the runs' own (`with_results` false).
// docs/batch.schema.json.
std::string to_json(const BatchResult& batch, bool with_results);

}  // namespace burnish
