// How fast the extractors are: one line of JSON each, facets per CPU second.
//
//   burnish_extraction [FILE] [cells=N] [edge=E] [rounds=R]
//
// FILE: a closed model; without it the example knot. N cells along the diagonal (256), distances exact in a band of 3 cells. E: length of Delaunay's edges, in
// cells (1). The fastest of R rounds (3) counts. Prints the octree's surface, its topology by signs (with what part of the extraction that costs), and Delaunay's.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <limits>
#include <stdexcept>
#include <string>

#include "burnish/core/timer.h"
#include "burnish/extract/delaunay.h"
#include "burnish/extract/marching_tetrahedra.h"
#include "burnish/io/mesh_io.h"
#include "burnish/levelset/from_triangles.h"
#include "burnish/levelset/topology.h"
#include "burnish/surface/example_shapes.h"
#include "burnish/surface/weld.h"

namespace {

using namespace burnish;

constexpr double kBand = 3, kMargin = 8;  // cells

struct Request {
  std::string file;
  double cells = 256, edge = 1;
  int rounds = 3;
};

Request parse(int argc, char** argv) {
  Request request;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const std::size_t equals = argument.find('=');
    const std::string name = argument.substr(0, equals);
    const double value = equals == std::string::npos ? 0 : std::atof(argument.c_str() + equals + 1);
    if (equals == std::string::npos) request.file = argument;
    else if (name == "cells") request.cells = value;
    else if (name == "edge") request.edge = value;
    else if (name == "rounds") request.rounds = static_cast<int>(value);
    else throw std::invalid_argument("no option " + name);
  }
  if (!(request.cells >= 1) || !(request.edge > 0) || request.rounds < 1) throw std::invalid_argument("cells, edge and rounds are positive");
  return request;
}

// CPU seconds of the fastest of some rounds.
template <class Body>
double fastest(int rounds, Body&& body) {
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds; ++round) {
    const double start = process_cpu_seconds();
    body();
    least = std::min(least, process_cpu_seconds() - start);
  }
  return least;
}

void print(const char* what, std::size_t facets, double seconds) {
  fmt::print("{{\"extractor\": \"{}\", \"facets\": {}, \"cpu_seconds\": {:.4f}, \"facets_per_cpu_second\": {:.0f}}}\n", what, facets, seconds,
             static_cast<double>(facets) / seconds);
  std::fflush(stdout);
}

void run(const Request& request) {
  const TriangleSoup model = weld(request.file.empty() ? make_example(ExampleShape::knot, {}).dirty : read_mesh(request.file).soup);
  const Box3 box = bounding_box(model);
  const GridFrame frame = make_frame(box, box.diagonal() / request.cells, kMargin);
  const LevelSet set = level_set_from_triangles(model, frame, {.band = kBand}).level_set;

  std::size_t facets = 0;
  const double octree = fastest(request.rounds, [&] { facets = extract_surface(set).soup.facets.size(); });
  print("tetrahedra", facets, octree);

  LevelSetTopology topology;
  const double signs = fastest(request.rounds, [&] { topology = level_set_topology(set); });
  fmt::print("{{\"topology\": {{\"components\": {}, \"genus\": {}}}, \"cpu_seconds\": {:.4f}, \"part_of_extraction\": {:.3f}}}\n", topology.surface_components,
             topology.genus, signs, signs / octree);

  DelaunaySurface surface;
  const double delaunay = fastest(request.rounds, [&] { surface = extract_delaunay(set, {.edge = request.edge}); });
  if (!surface.failure.empty()) throw std::runtime_error("delaunay: " + surface.failure);
  print("delaunay", surface.soup.facets.size(), delaunay);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(parse(argc, argv));
    return EXIT_SUCCESS;
  } catch (const std::exception& e) {
    fmt::print(stderr, "burnish_extraction: {}\n", e.what());
    return EXIT_FAILURE;
  }
}
