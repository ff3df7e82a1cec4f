// Simplifies one file, or judges what another program made of it, and prints one line of JSON: what it cost, and what came out.
//
//   burnish_simplify IN OUT facets=N | deviation=D | edge=L | judge  [cell=H]
//
// Distances in H; in mean edges of the input if it is not given. D and L in the same. `judge`: OUT is there already. Normal errors are of samples of
// the input, within one H of its creases (edges over 40 degrees) and farther away. OUT is read back before it is judged.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "burnish/core/timer.h"
#include "burnish/io/mesh_io.h"
#include "burnish/io/output_file.h"
#include "burnish/surface/compare.h"
#include "burnish/surface/creases.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/remesh.h"
#include "burnish/surface/simplify.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/weld.h"
#include "support/facet_angles.h"

namespace {

using namespace burnish;

struct Request {
  SimplifyOptions simplify;
  std::optional<double> edge;
  bool judge = false;
  double cell = 0;
};

Request parse(int argc, char** argv, double mean_edge) {
  Request request;
  request.cell = mean_edge;
  for (int i = 3; i < argc; ++i)
    if (std::string(argv[i]).starts_with("cell=")) request.cell = std::atof(argv[i] + 5);
  for (int i = 3; i < argc; ++i) {
    const std::string argument = argv[i];
    const std::size_t equals = argument.find('=');
    const std::string name = argument.substr(0, equals);
    const double value = equals == std::string::npos ? 0 : std::atof(argument.c_str() + equals + 1);
    if (name == "facets") request.simplify.facets = static_cast<std::size_t>(value);
    else if (name == "deviation") request.simplify.deviation = value * request.cell;
    else if (name == "edge") request.edge = value * request.cell;
    else if (name == "judge") request.judge = true;
    else if (name != "cell") throw std::invalid_argument("no option " + name);
  }
  return request;
}

// The least angle of each facet, ascending, in degrees.
std::vector<double> least_angles(const TriangleSoup& soup) {
  std::vector<double> angles;
  for (std::size_t f = 0; f < soup.facets.size(); ++f) angles.push_back(test::least_angle(soup, f));
  std::sort(angles.begin(), angles.end());
  return angles;
}

struct NormalErrors {
  double at_creases = 0, elsewhere = 0;  // means, degrees
};

NormalErrors normal_errors(const TriangleSoup& input, const TriangleSoup& output, const TriangleIndex& index, double near) {
  TriangleSoup ribbon{input.points, {}, {}};  // creases as facets without area
  for (const CreaseEdge& e : find_creases(input).edges) ribbon.facets.push_back({e.points[0], e.points[1], e.points[1]});
  const TriangleIndex creases(ribbon);
  const auto closest = [&](const Vec3& p) {
    const TriangleIndex::Closest c = index.closest(p);
    return ClosestPoint{c.point, c.squared_distance, c.facet};
  };
  double sum[2] = {0, 0}, count[2] = {0, 0};
  for (const SampleError& s : sample_errors(input, output, closest, 200'000)) {
    if (!std::isfinite(s.angle)) continue;
    const bool far = ribbon.facets.empty() || creases.closest(s.at, near * near).facet == kNoFacet;
    sum[far] += s.angle;
    ++count[far];
  }
  return {sum[0] / std::max(1.0, count[0]), sum[1] / std::max(1.0, count[1])};
}

TriangleSoup written_and_read(const TriangleSoup& soup, const std::string& path) {
  OutputFile file(path, true);
  write_mesh(file.fd(), path, soup, {.format = format_for_writing(path)});
  file.commit();
  return weld(read_mesh(path).soup);
}

void print_judgement(const TriangleSoup& input, const TriangleSoup& output, double cell) {
  const TriangleIndex of_input(input), of_output(output);
  const OneSidedDistance to = one_sided_distance(input, of_output), from = one_sided_distance(output, of_input);
  const NormalErrors normals = normal_errors(input, output, of_output, cell);
  const std::vector<double> angles = least_angles(output);
  const auto at = [&](double share) { return angles[static_cast<std::size_t>(share * static_cast<double>(angles.size() - 1))]; };
  const Defects d = inspect(output).defects;
  fmt::print("\"facets\": {}, \"valid\": {}, \"intersecting\": {}, \"rms\": {:.4f}, \"max\": {:.3f}, \"normal_away\": {:.2f}, \"normal_creases\": {:.2f}, "
             "\"angle_least\": {:.2f}, \"angle_1\": {:.1f}, \"angle_5\": {:.1f}, \"angle_50\": {:.1f}, \"volume_percent\": {:.3f}}}\n",
             output.facets.size(), d.valid_solid() || d.valid_sheet(), d.self_intersecting_pairs, std::max(to.rms, from.rms) / cell,
             std::max(to.max, from.max) / cell, normals.elsewhere, normals.at_creases, at(0), at(0.01), at(0.05), at(0.5),
             100 * (signed_volume(output) / signed_volume(input) - 1));
}

void print_cost(double cpu, double wall) {
  fmt::print("\"cpu_seconds\": {:.2f}, \"wall_seconds\": {:.2f}, \"peak_mb\": {:.0f}, ", process_cpu_seconds() - cpu, monotonic_seconds() - wall,
             static_cast<double>(process_peak_bytes()) / 1e6);
}

TriangleSoup made(const TriangleSoup& input, const Request& request) {
  const double cpu = process_cpu_seconds(), wall = monotonic_seconds();
  if (request.edge) {
    RemeshedSurface r = remesh(input, {.edge = *request.edge});
    print_cost(cpu, wall);
    fmt::print("\"held\": {}, \"why_not\": \"{}\", ", r.held_facets, r.why_not);
    return std::move(r.soup);
  }
  SimplifiedSurface r = simplify(input, request.simplify);
  print_cost(cpu, wall);
  fmt::print("\"rounds\": {}, \"held\": {}, \"reached\": {}, \"why_not\": \"{}\", ", r.rounds, r.held_points, r.reached, r.why_not);
  return std::move(r.soup);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 4) {
    fmt::print(stderr, "usage: burnish_simplify IN OUT facets=N | deviation=D | edge=L | judge [cell=H]\n");
    return 2;
  }
  const TriangleSoup input = weld(read_mesh(argv[1]).soup);
  const Request request = parse(argc, argv, mean_edge_length(input));
  fmt::print("{{\"input_facets\": {}, ", input.facets.size());
  print_judgement(input, request.judge ? weld(read_mesh(argv[2]).soup) : written_and_read(made(input, request), argv[2]), request.cell);
  return 0;
} catch (const std::exception& e) {
  fmt::print(stderr, "burnish_simplify: {}\n", e.what());
  return 1;
}
