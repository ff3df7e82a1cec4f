// What burnish_band and its peers have in common: their command line, the model they measure, the line they print.
//
// All of them read the same file and weld it with the same code, so they are given the same points and facets.
#pragma once

#include <nlohmann/json.hpp>

#include <cstddef>
#include <string>
#include <vector>

#include "burnish/core/timer.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish::bench {

struct BandRequest {
  std::string model;
  double cells = 0;             // along the longest side of the model's box, or along its diagonal
  bool along_diagonal = false;
  double band = 3;              // cells on both sides of the surface
  int threads = 0;              // 0: as many as the machine has
  bool is_signed = true;
  bool by_stages = false;
  int subdivide = 0;            // times that every facet is split into four
  double jitter = 0;            // how far the new points are moved at most along each axis, in mean edges of the new facets
  std::size_t sample = 100000;  // nodes that are asked for where asking for all would take too long
  std::string write;            // binary STL to write the model to, instead of measuring
  std::string label;            // carried into the line, e.g. a commit
};

// Throws Error{usage}.
BandRequest parse_band_request(int argc, const char* const* argv);

// The model, welded, and subdivided as asked for. New points are rounded to float32: the file that
// `--write` gives holds the same model.
TriangleSoup read_model(const BandRequest& request);

// The side of a cell in model units.
double cell_of(const BandRequest& request, const TriangleSoup& soup);

// From here on process_peak_bytes() tells the peak of what follows, with what is held now, and not that of reading the model
// (Linux; elsewhere it goes on telling the peak of the whole process).
void forget_peak();

// The line's beginning: who measured what, and with which settings.
nlohmann::ordered_json line_of(const BandRequest& request, const std::string& program, const TriangleSoup& soup);

// Adds CPU and wall seconds, over all stages and (if there are several) of each, nanoseconds of CPU per active node, and the peak.
void add_costs(nlohmann::ordered_json& line, const std::vector<StageCost>& stages, std::size_t active);

// Runs a program: prints the line that `measure` gives, or the error on standard error. Returns the exit code.
int run_band_program(int argc, const char* const* argv,
                     nlohmann::ordered_json (*measure)(const BandRequest&, const TriangleSoup&));

}  // namespace burnish::bench
