#include "band_request.h"

#include <fmt/format.h>
#include <malloc.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string_view>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/io/mesh_io.h"
#include "burnish/io/output_file.h"
#include "burnish/surface/edge_table.h"
#include "burnish/surface/weld.h"

namespace burnish::bench {
namespace {

constexpr std::string_view kUsage =
    "MODEL (--resolution CELLS | --diagonal CELLS | --write FILE.stl) [--band CELLS] [--threads N] [--unsigned] [--stages] "
    "[--subdivide TIMES] [--jitter EDGES] [--sample NODES] [--label TEXT]";
constexpr std::uint64_t kSeed = 20200229;

double number(std::string_view option, const char* text) {
  char* end = nullptr;
  const double value = text ? std::strtod(text, &end) : 0;
  if (!text || end == text || *end != 0 || !(value >= 0) || std::isinf(value))
    throw Error(ErrorCode::usage, fmt::format("{}: expected a number that is not negative, found '{}'", option, text ? text : ""));
  return value;
}

double rounded(double value, double parts) { return std::round(value * parts) / parts; }

// Uniform in [-1, 1), the same on every machine: splitmix64 (Steele, Lea, Flood 2014) of seed and number.
double noise(std::uint64_t n) {
  std::uint64_t z = kSeed + (n + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1;
}

Vec3 in_float32(const Vec3& p) { return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}; }

// Every facet in four, new points in the middles of edges and then moved by up to `jitter` mean edges of the new facets along each
// axis. Facets that repeat a point are left out.
TriangleSoup subdivided(const TriangleSoup& soup, double jitter) {
  const EdgeTable table(soup);
  const double reach = jitter * 0.5 * mean_edge_length(soup);
  TriangleSoup finer{soup.points, {}, {}};
  finer.points.reserve(soup.points.size() + table.size());
  for (std::size_t e = 0; e < table.size(); ++e) {
    const auto [a, b] = table.edge(e);
    const Vec3 moved{noise(3 * e), noise(3 * e + 1), noise(3 * e + 2)};
    finer.points.push_back(in_float32((soup.points[a] + soup.points[b]) * 0.5 + reach * moved));
  }
  finer.facets.reserve(4 * soup.facets.size());
  const auto edges = table.edges_of_facets();
  for (std::size_t f = 0; f < soup.facets.size(); ++f) {
    if (edges[f][0] == EdgeTable::kNoEdge) continue;
    const auto [a, b, c] = soup.facets[f];
    const auto middle = [&](std::size_t side) { return static_cast<std::uint32_t>(soup.points.size() + edges[f][side]); };
    const std::uint32_t ab = middle(0), bc = middle(1), ca = middle(2);
    finer.facets.insert(finer.facets.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  return finer;
}

void write_stl(const std::string& path, const TriangleSoup& soup) {
  OutputFile file(path, true);
  write_mesh(file.fd(), path, soup, {});
  file.commit();
}

}  // namespace

BandRequest parse_band_request(int argc, const char* const* argv) {
  BandRequest request;
  for (int i = 1; i < argc; ++i) {
    const std::string_view option = argv[i];
    const char* const value = i + 1 < argc ? argv[i + 1] : nullptr;
    if (option == "--unsigned") request.is_signed = false;
    else if (option == "--stages") request.by_stages = true;
    else if (!option.starts_with("--")) request.model = option;
    else {
      ++i;
      if (option == "--resolution" || option == "--diagonal") {
        request.cells = number(option, value);
        request.along_diagonal = option == "--diagonal";
      } else if (option == "--band") request.band = number(option, value);
      else if (option == "--threads") request.threads = static_cast<int>(number(option, value));
      else if (option == "--subdivide") request.subdivide = static_cast<int>(number(option, value));
      else if (option == "--jitter") request.jitter = number(option, value);
      else if (option == "--sample") request.sample = static_cast<std::size_t>(number(option, value));
      else if (option == "--write" && value) request.write = value;
      else if (option == "--label" && value) request.label = value;
      else throw Error(ErrorCode::usage, fmt::format("'{}' is no option, or has no value", option), std::string(kUsage));
    }
  }
  if (request.model.empty() || (request.cells <= 0 && request.write.empty()))
    throw Error(ErrorCode::usage, "a model and a resolution are needed", std::string(kUsage));
  return request;
}

TriangleSoup read_model(const BandRequest& request) {
  TriangleSoup soup = weld(read_mesh(request.model).soup);
  for (int i = 0; i < request.subdivide; ++i) soup = subdivided(soup, request.jitter);
  return soup;
}

double cell_of(const BandRequest& request, const TriangleSoup& soup) {
  const Box3 box = bounding_box(soup);
  return (request.along_diagonal ? box.diagonal() : box.longest_side()) / request.cells;
}

void forget_peak() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << 5;
}

nlohmann::ordered_json line_of(const BandRequest& request, const std::string& program, const TriangleSoup& soup) {
  const Box3 box = bounding_box(soup);
  const std::size_t slash = request.model.rfind('/');
  return {{"program", program},
          {"model", request.model.substr(slash == std::string::npos ? 0 : slash + 1)},
          {"subdivide", request.subdivide},
          {"jitter", request.jitter},
          {"facets", soup.facets.size()},
          {request.along_diagonal ? "diagonal" : "resolution", request.cells},
          {"cells_per_side", rounded(box.longest_side() / cell_of(request, soup), 10)},
          {"band", request.band},
          {"signed", request.is_signed},
          {"threads", request.threads > 0 ? request.threads : thread_count()},
          {"label", request.label}};
}

void add_costs(nlohmann::ordered_json& line, const std::vector<StageCost>& stages, std::size_t active) {
  double cpu = 0, wall = 0;
  for (const StageCost& stage : stages) {
    cpu += stage.cpu_seconds;
    wall += stage.wall_seconds;
  }
  line["cpu_seconds"] = rounded(cpu, 1e4);
  line["wall_seconds"] = rounded(wall, 1e4);
  if (active > 0) line["ns_per_active"] = rounded(1e9 * cpu / static_cast<double>(active), 1);
  line["peak_mb"] = rounded(1e-6 * static_cast<double>(process_peak_bytes()), 10);
  if (stages.size() < 2) return;
  for (const StageCost& stage : stages)
    line["stages"][stage.name] = {{"cpu_seconds", rounded(stage.cpu_seconds, 1e4)},
                                  {"wall_seconds", rounded(stage.wall_seconds, 1e4)}};
}

int run_band_program(int argc, const char* const* argv,
                     nlohmann::ordered_json (*measure)(const BandRequest&, const TriangleSoup&)) {
  try {
    const BandRequest request = parse_band_request(argc, argv);
    const ThreadLimit limit(request.threads);
    const TriangleSoup soup = read_model(request);
    if (!request.write.empty()) {
      write_stl(request.write, soup);
    } else {
      forget_peak();
      std::puts(measure(request, soup).dump().c_str());
    }
    return 0;
  } catch (const Error& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    if (!error.hint().empty()) std::fprintf(stderr, "  hint: %s\n", error.hint().c_str());
    return exit_code(error.code());
  }
}

}  // namespace burnish::bench
