// Denoises one file and says what it cost: for measuring the denoiser alone, without the repair around it.
//
//   burnish_denoise IN OUT [sigma=S] [length=L] [crease=DEGREES] [deviation=D] [threads=N]
//
// S, L and D in mean edges of the input. Prints one line: the noise that was estimated and what was removed, both in mean edges, outliers, rms and largest
// move in mean edges, CPU seconds and microseconds per facet.
#include <fmt/format.h>

#include <ctime>
#include <cstdlib>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>

#include "burnish/core/parallel.h"
#include "burnish/io/mesh_io.h"
#include "burnish/io/output_file.h"
#include "burnish/surface/denoise.h"
#include "burnish/surface/orient.h"
#include "burnish/surface/weld.h"

namespace {

struct Request {
  burnish::DenoiseOptions options;
  std::unique_ptr<burnish::ThreadLimit> threads;
};

Request parse(int argc, char** argv, double edge) {
  Request request;
  for (int i = 3; i < argc; ++i) {
    const std::string argument = argv[i];
    const std::size_t equals = argument.find('=');
    const std::string name = argument.substr(0, equals);
    const double value = equals == std::string::npos ? 0 : std::atof(argument.c_str() + equals + 1);
    if (name == "sigma") request.options.sigma = value * edge;
    else if (name == "length") request.options.length = value * edge;
    else if (name == "crease") request.options.crease_angle = value;
    else if (name == "deviation") request.options.deviation = value * edge;
    else if (name == "threads") request.threads = std::make_unique<burnish::ThreadLimit>(static_cast<int>(value));
    else throw std::invalid_argument("no option " + name);
  }
  return request;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) {
    fmt::print(stderr, "usage: burnish_denoise IN OUT [sigma=S] [length=L] [crease=DEGREES] [deviation=D] [threads=N]\n");
    return 2;
  }
  const burnish::TriangleSoup input = burnish::orient(burnish::weld(burnish::read_mesh(argv[1]).soup)).soup;
  const double edge = burnish::mean_edge_length(input);
  const Request request = parse(argc, argv, edge);
  const std::clock_t start = std::clock();
  const burnish::DenoiseResult result = burnish::denoise(input, request.options);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  burnish::OutputFile file(argv[2], true);
  burnish::write_mesh(file.fd(), argv[2], result.soup, {.format = burnish::format_for_writing(argv[2])});
  file.commit();
  fmt::print("estimate {:.3f} sigma {:.3f} outliers {} rms {:.3f} max {:.3f} cpu {:.2f} us/facet {:.1f}\n", result.noise.sigma / edge, result.sigma / edge,
             result.outliers, result.rms_moved / edge, result.max_moved / edge, seconds, 1e6 * seconds / static_cast<double>(input.facets.size()));
} catch (const std::exception& error) {
  fmt::print(stderr, "burnish_denoise: {}\n", error.what());
  return 1;
}
