#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "burnish/io/mesh_io.h"
#include "models.h"

namespace burnish::bench {
namespace {

// The bytes of the nozzle in a format.
std::string written(MeshFormat format) {
  std::string path = (std::filesystem::temp_directory_path() / "burnish-bench-XXXXXX").string();
  const int fd = ::mkstemp(path.data());
  MeshWriteOptions options;
  options.format = format;
  write_mesh(fd, path, nozzle_as_read(), options);
  ::close(fd);
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  std::filesystem::remove(path);
  return bytes;
}

void read(benchmark::State& state, MeshFormat format) {
  const std::string bytes = written(format);
  for (auto _ : state) benchmark::DoNotOptimize(read_mesh(std::as_bytes(std::span(bytes)), "nozzle.stl"));
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * bytes.size()));
}

BENCHMARK_CAPTURE(read, binary_stl, MeshFormat::stl_binary)->Apply(in_cpu_time);
BENCHMARK_CAPTURE(read, ascii_stl, MeshFormat::stl_ascii)->Apply(in_cpu_time);

}  // namespace
}  // namespace burnish::bench
