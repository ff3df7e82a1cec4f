// OpenVDB's mean-curvature flow of a sphere (tools::LevelSetFilter, defaults: one Euler step of dt = dx^2/6 in our time, HJWENO5
// renormalisation three times), as one line of JSON: beside the line of burnish_flow it is a comparison.
//
//   openvdb_flow [radius in voxels] [steps]
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetFilter.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>

namespace {

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// Of the zero crossings of lattice edges.
double mean_radius(const openvdb::FloatGrid& grid, const openvdb::Vec3d& center) {
  const auto values = grid.getConstAccessor();
  double sum = 0;
  std::size_t count = 0;
  for (auto voxel = grid.cbeginValueOn(); voxel; ++voxel) {
    const openvdb::Coord at = voxel.getCoord();
    for (int axis = 0; axis < 3; ++axis) {
      openvdb::Coord next = at;
      next[axis] += 1;
      const double p = *voxel, q = values.getValue(next);
      if ((p < 0) == (q < 0)) continue;
      openvdb::Vec3d x = at.asVec3d();
      x[axis] += p / (p - q);
      sum += (x - center).length();
      ++count;
    }
  }
  return sum / static_cast<double>(count);
}

}  // namespace

int main(int argc, char** argv) {
  const double radius = argc > 1 ? std::atof(argv[1]) : 51.2;
  const int steps = argc > 2 ? std::atoi(argv[2]) : 10;
  openvdb::initialize();
  const openvdb::Vec3d center(0.31, 0.77, 0.13);
  const auto sphere = [&](double r) {
    return openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(static_cast<float>(r), openvdb::Vec3f(center), 1.0f, 3.0f);
  };
  const auto grid = sphere(radius);
  const std::size_t active = grid->activeVoxelCount();
  const double start = cpu_seconds();
  openvdb::tools::LevelSetFilter<openvdb::FloatGrid> filter(*grid);
  for (int i = 0; i < steps; ++i) filter.meanCurvature();
  const double seconds = cpu_seconds() - start;
  const double time = steps / 6.0, exact = std::sqrt(radius * radius - 4 * time);
  const double found = mean_radius(*grid, center);  // linear crossings of a sphere of the exact radius are off by 1e-5 themselves
  std::printf("{\"program\":\"openvdb\",\"version\":\"%s\",\"radius\":%g,\"time\":%.4f,\"steps\":%d,\"nodes_within_3\":%zu,\"cpu_s\":%.4f,\"ns_per_node\":%.0f,\"radius_error\":%.3e,\"error_of_flow\":%.3e}\n",
              openvdb::getLibraryVersionString(), radius, time, steps, active, seconds, 1e9 * seconds / static_cast<double>(active), found / exact - 1, found / mean_radius(*sphere(exact), center) - 1);
}
