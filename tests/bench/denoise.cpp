// Denoises one file and says what it cost: for measuring the denoiser alone, without the repair around it.
//
//   burnish_denoise IN OUT
//
// Prints one line: sigma, mean edge, correlation, outlier share, crease share, outliers, rms and largest move, CPU seconds.
#include <fmt/format.h>

#include <ctime>
#include <exception>

#include "burnish/io/mesh_io.h"
#include "burnish/io/output_file.h"
#include "burnish/surface/denoise.h"
#include "burnish/surface/orient.h"
#include "burnish/surface/weld.h"

int main(int argc, char** argv) try {
  if (argc != 3) {
    fmt::print(stderr, "usage: burnish_denoise IN OUT\n");
    return 2;
  }
  const burnish::TriangleSoup input = burnish::orient(burnish::weld(burnish::read_mesh(argv[1]).soup)).soup;
  const std::clock_t start = std::clock();
  const burnish::DenoiseResult result = burnish::denoise(input);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  burnish::OutputFile file(argv[2], true);
  burnish::write_mesh(file.fd(), argv[2], result.soup, {.format = burnish::format_for_writing(argv[2])});
  file.commit();
  const burnish::NoiseEstimate& n = result.noise;
  fmt::print("sigma {:.5g} edge {:.5g} ratio {:.3f} correlation {:.3f} outlier_share {:.4f} crease_share {:.4f} outliers {} rms {:.5g} max {:.5g} cpu {:.2f}\n",
             n.sigma, n.mean_edge, n.sigma / n.mean_edge, n.correlation, n.outlier_share, n.crease_share, result.outliers, result.rms_moved, result.max_moved, seconds);
} catch (const std::exception& error) {
  fmt::print(stderr, "burnish_denoise: {}\n", error.what());
  return 1;
}
