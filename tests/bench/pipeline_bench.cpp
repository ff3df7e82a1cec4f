// The main job from file to file, with default options.
#include <filesystem>

#include "burnish/io/mesh_io.h"
#include "burnish/io/output_file.h"
#include "burnish/pipeline/clean.h"
#include "burnish/surface/example_shapes.h"
#include "models.h"

namespace burnish::bench {
namespace {

void clean_example(benchmark::State& state, ExampleShape shape, const ExampleOptions& options, Length smooth) {
  const auto folder = std::filesystem::temp_directory_path();
  CleanJob job;
  job.input = (folder / "burnish-bench-in.stl").string();
  job.output = (folder / "burnish-bench-out.stl").string();
  job.options.smooth = smooth;
  job.overwrite = true;
  OutputFile input(job.input, true);
  write_mesh(input.fd(), job.input, make_example(shape, options).dirty, {});
  input.commit();
  for (auto _ : state)
    if (!clean(job).verified) state.SkipWithError("the result is no valid solid");
  std::filesystem::remove(job.input);
  std::filesystem::remove(job.output);
}

constexpr Length kNone{}, kFourCells{4, LengthUnit::cells};

void in_seconds(benchmark::internal::Benchmark* b) {
  b->Unit(benchmark::kSecond)->MeasureProcessCPUTime()->Iterations(1);
}

BENCHMARK_CAPTURE(clean_example, knot, ExampleShape::knot, {.noise = 0.2, .holes = 5}, kNone)->Apply(in_seconds);
BENCHMARK_CAPTURE(clean_example, knot_smoothed, ExampleShape::knot, {.noise = 0.2, .holes = 5}, kFourCells)->Apply(in_seconds);
BENCHMARK_CAPTURE(clean_example, nozzle, ExampleShape::nozzle, {.holes = 12}, kNone)->Apply(in_seconds);

}  // namespace
}  // namespace burnish::bench
