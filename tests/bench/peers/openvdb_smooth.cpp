// Smoothing by OpenVDB (Museth 2013), for comparing results with: a mesh becomes a narrow band, is filtered, and becomes a mesh again.
//
//   openvdb_smooth IN OUT --voxel X --filter FILTER --iterations N [--width W]
//
// X is in mean edges of IN. FILTER is none, mean-curvature, laplacian, gaussian, mean or median, of tools::LevelSetFilter with its defaults;
// W, in voxels, is of the last three (1). The band is 3 voxels wide, the mesh is not thinned out (adaptivity 0), its quadrilaterals are halved.
// Prints one line of JSON.
#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetFilter.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <ctime>
#include <exception>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "burnish/io/mesh_io.h"
#include "burnish/io/output_file.h"
#include "burnish/surface/weld.h"

namespace burnish::bench {
namespace {

using Filter = openvdb::tools::LevelSetFilter<openvdb::FloatGrid>;
constexpr float kHalfWidth = 3;

struct Request {
  std::string in, out, filter = "mean-curvature";
  double voxel = 0.5;
  int iterations = 10, width = 1;
};

Request request_of(int argc, char** argv) {
  if (argc < 3 || argc % 2 == 0) throw std::invalid_argument("usage: openvdb_smooth IN OUT [--voxel X] [--filter F] [--iterations N] [--width W]");
  Request r;
  r.in = argv[1];
  r.out = argv[2];
  for (int i = 3; i + 1 < argc; i += 2) {
    const std::string option = argv[i], value = argv[i + 1];
    if (option == "--voxel") r.voxel = std::stod(value);
    else if (option == "--filter") r.filter = value;
    else if (option == "--iterations") r.iterations = std::stoi(value);
    else if (option == "--width") r.width = std::stoi(value);
    else throw std::invalid_argument("unknown option " + option);
  }
  return r;
}

openvdb::FloatGrid::Ptr band_of(const TriangleSoup& soup, double voxel) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> facets;
  for (const Vec3& p : soup.points) points.emplace_back(openvdb::Vec3d(p.x, p.y, p.z));
  for (const Facet& f : soup.facets) facets.emplace_back(f[0], f[1], f[2]);
  return openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*openvdb::math::Transform::createLinearTransform(voxel), points, facets, kHalfWidth);
}

void apply(Filter& filter, const Request& r) {
  const std::map<std::string, std::function<void()>> steps{
      {"none", [] {}},
      {"mean-curvature", [&] { filter.meanCurvature(); }},
      {"laplacian", [&] { filter.laplacian(); }},
      {"gaussian", [&] { filter.gaussian(r.width); }},
      {"mean", [&] { filter.mean(r.width); }},
      {"median", [&] { filter.median(r.width); }},
  };
  const auto step = steps.find(r.filter);
  if (step == steps.end()) throw std::invalid_argument("unknown filter " + r.filter);
  for (int i = 0; i < r.iterations; ++i) step->second();
}

// Its facets are oriented inwards; here they are turned.
TriangleSoup surface_of(const openvdb::FloatGrid& grid) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(grid, points, triangles, quads, 0, 0);
  TriangleSoup soup;
  for (const openvdb::Vec3s& p : points) soup.points.push_back({p.x(), p.y(), p.z()});
  for (const openvdb::Vec3I& t : triangles) soup.facets.push_back({t[2], t[1], t[0]});
  for (const openvdb::Vec4I& q : quads) {
    soup.facets.push_back({q[2], q[1], q[0]});
    soup.facets.push_back({q[3], q[2], q[0]});
  }
  return soup;
}

void write(const std::string& path, const TriangleSoup& soup) {
  OutputFile file(path, true);
  write_mesh(file.fd(), path, soup, {.format = format_for_writing(path)});
  file.commit();
}

void run(const Request& r) {
  openvdb::initialize();
  const TriangleSoup input = weld(read_mesh(r.in).soup);
  const std::clock_t start = std::clock();
  const openvdb::FloatGrid::Ptr grid = band_of(input, r.voxel * mean_edge_length(input));
  Filter filter(*grid);
  apply(filter, r);
  const TriangleSoup result = surface_of(*grid);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  write(r.out, result);
  fmt::print("{{\"version\": \"{}\", \"active\": {}, \"facets\": {}, \"cpu_seconds\": {:.3f}}}\n", openvdb::getLibraryVersionString(),
             grid->activeVoxelCount(), result.facets.size(), seconds);
}

}  // namespace
}  // namespace burnish::bench

int main(int argc, char** argv) try {
  burnish::bench::run(burnish::bench::request_of(argc, argv));
} catch (const std::exception& error) {
  fmt::print(stderr, "openvdb_smooth: {}\n", error.what());
  return 1;
}
