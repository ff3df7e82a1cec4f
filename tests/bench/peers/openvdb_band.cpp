// The narrow band of OpenVDB (Museth 2013), made from the same points and facets at the same cell: tools::meshToLevelSet.
//
// Its distances are exact in the voxels that facets were scattered to, and spread from there by trying the nearest facets of
// neighbours; the sign comes of a flood fill, and what has a sign is renormalised at the end, by default. `rms_error` and `max_error`
// are how far distances are from exact ones, in cells, over a sample of the band (--sample), which is not part of the cost.
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "band_request.h"
#include "burnish/surface/triangle_index.h"

namespace burnish::bench {
namespace {

struct Mesh {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> facets;
};

Mesh mesh_of(const TriangleSoup& soup) {
  Mesh mesh;
  mesh.points.reserve(soup.points.size());
  mesh.facets.reserve(soup.facets.size());
  for (const Vec3& p : soup.points) mesh.points.emplace_back(openvdb::Vec3d(p.x, p.y, p.z));
  for (const Facet& f : soup.facets) mesh.facets.emplace_back(f[0], f[1], f[2]);
  return mesh;
}

struct DistanceError {
  double rms = 0, max = 0;
};

DistanceError error_of(const openvdb::FloatGrid& grid, const TriangleSoup& soup, double cell, std::size_t sample) {
  const TriangleIndex index(soup);
  const std::size_t every = std::max<std::size_t>(1, grid.activeVoxelCount() / std::max<std::size_t>(1, sample));
  std::size_t n = 0, taken = 0;
  DistanceError error;
  for (auto voxel = grid.cbeginValueOn(); voxel; ++voxel) {
    if (n++ % every != 0) continue;
    const openvdb::Vec3d p = grid.indexToWorld(voxel.getCoord());
    const double exact = std::sqrt(index.closest({p.x(), p.y(), p.z()}).squared_distance);
    const double off = std::abs(std::abs(static_cast<double>(*voxel)) - exact) / cell;
    error.max = std::max(error.max, off);
    error.rms += off * off;
    ++taken;
  }
  error.rms = std::sqrt(error.rms / static_cast<double>(std::max<std::size_t>(1, taken)));
  return error;
}

nlohmann::ordered_json measure(const BandRequest& request, const TriangleSoup& soup) {
  openvdb::initialize();
  const Mesh mesh = mesh_of(soup);
  const double cell = cell_of(request, soup);
  StageClock clock;
  clock.begin("band");
  const auto transform = openvdb::math::Transform::createLinearTransform(cell);
  const float width = static_cast<float>(request.band);
  using namespace openvdb::tools;
  const auto grid =
      request.is_signed ? meshToLevelSet<openvdb::FloatGrid>(*transform, mesh.points, mesh.facets, width)
                        : meshToUnsignedDistanceField<openvdb::FloatGrid>(*transform, mesh.points, mesh.facets, {}, width);
  clock.end();

  nlohmann::ordered_json line = line_of(request, "openvdb", soup);
  line["version"] = openvdb::getLibraryVersionString();
  line["blocks"] = grid->tree().leafCount();
  line["near_nodes"] = grid->tree().leafCount() * openvdb::FloatTree::LeafNodeType::SIZE;
  line["active"] = grid->activeVoxelCount();
  add_costs(line, clock.stages(), grid->activeVoxelCount());
  line["result_mb"] = std::round(1e-5 * static_cast<double>(grid->memUsage())) / 10;
  const DistanceError error = error_of(*grid, soup, cell, request.sample);
  line["rms_error"] = error.rms;
  line["max_error"] = error.max;
  return line;
}

}  // namespace
}  // namespace burnish::bench

int main(int argc, char** argv) { return burnish::bench::run_band_program(argc, argv, burnish::bench::measure); }
