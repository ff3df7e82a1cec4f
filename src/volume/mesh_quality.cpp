#include "burnish/volume/mesh_quality.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "assemble.h"
#include "burnish/core/parallel.h"
#include "mesh_quality_measures.h"
#include "mesh_quality_shapes.h"
#include "mesh_quality_topology.h"

namespace burnish {
namespace {

using namespace quality;

// What many values of one check come to.
struct Tally {
  double least = std::numeric_limits<double>::infinity(), greatest = -std::numeric_limits<double>::infinity(), sum = 0;
  std::uint64_t measured = 0, failing = 0;

  void add(double value, bool failed) {
    least = std::min(least, value);
    greatest = std::max(greatest, value);
    sum += value;
    ++measured;
    failing += failed ? 1 : 0;
  }
};

struct Tallies {
  std::array<Tally, kChecks> of;

  void add(const Measures& m, std::span<const Check> checks, const Limits& limits) {
    for (const Check check : checks) {
      const double value = m.value[static_cast<std::size_t>(check)];
      if (!std::isnan(value)) of[static_cast<std::size_t>(check)].add(value, fails(check, value, limits));
    }
  }
  static Tallies combined(Tallies a, const Tallies& b) {
    for (std::size_t check = 0; check < kChecks; ++check) {
      Tally& into = a.of[check];
      const Tally& from = b.of[check];
      into.least = std::min(into.least, from.least);
      into.greatest = std::max(into.greatest, from.greatest);
      into.sum += from.sum;
      into.measured += from.measured;
      into.failing += from.failing;
    }
    return a;
  }
};

// measure(i, scratch, m) for all i < n, which gives values for `checks`.
template <class Measure>
Tallies tallied(std::size_t n, std::span<const Check> checks, const Limits& limits, Progress& progress, Measure&& measure) {
  return parallel_reduce(
      n, kDefaultGrain, Tallies{},
      [&](std::size_t begin, std::size_t end) {
        progress.check();
        Tallies tallies;
        Scratch scratch;
        for (std::size_t i = begin; i < end; ++i) {
          Measures m;
          measure(i, scratch, m);
          tallies.add(m, checks, limits);
        }
        return tallies;
      },
      Tallies::combined);
}

// The length of the sum of all boundary areas, along each axis, over the sum of their sizes: the greatest.
double openness_of_boundary(const StoredGeometry& g) {
  struct Sum {
    Vec3 areas;
    double sizes = 0;
  };
  const std::size_t inner = g.mesh.internal_faces();
  const Sum all = parallel_reduce(
      g.mesh.faces() - inner, kDefaultGrain, Sum{},
      [&](std::size_t begin, std::size_t end) {
        Sum sum;
        for (std::size_t f = inner + begin; f < inner + end; ++f) {
          const Vec3 area = g.face(f).area;
          sum.areas += area;
          sum.sizes += norm(area);
        }
        return sum;
      },
      [](const Sum& a, const Sum& b) { return Sum{a.areas + b.areas, a.sizes + b.sizes}; });
  return std::max({std::fabs(all.areas.x), std::fabs(all.areas.y), std::fabs(all.areas.z)}) / (all.sizes + foam::kVerySmall);
}

// Computes the geometry of the cells on the way.
Tallies measured(StoredGeometry& g, const Limits& limits, Progress& progress) {
  progress.begin_stage("mesh quality");
  g.cell_geometry.resize(g.mesh.cells);
  const Tallies of_cells = tallied(g.mesh.cells, kOfCells, limits, progress,
                                   [&](std::size_t c, Scratch& scratch, Measures& m) { g.cell_geometry[c] = measure_cell(g.mesh, g.faces, c, scratch.sides, m); });
  progress.update(0.5);
  const Tallies of_faces = tallied(g.mesh.faces(), kOfFaces, limits, progress,
                                   [&](std::size_t f, Scratch& scratch, Measures& m) { measure_face(g, f, limits[concave_faces], scratch, m); });
  Tallies all = Tallies::combined(of_faces, of_cells);
  Measures of_mesh;
  of_mesh[unused_points] = static_cast<double>(unused_point_count(g.mesh));
  of_mesh[face_order] = static_cast<double>(misordered_face_count(g.mesh, g.faces));
  of_mesh[boundary_openness] = openness_of_boundary(g);
  all.add(of_mesh, kOfMesh, limits);
  return all;
}

// checkMesh tells angles above 70 degrees, and takes 90 for an error.
bool passes(int check, const Tally& tally) {
  if (kRows[static_cast<std::size_t>(check)].warns || tally.failing == 0) return true;
  return check == non_orthogonality && tally.least > foam::kSmall;
}

MeshCheck check_of(int check, const Tally& tally, double limit) {
  const Row& row = kRows[static_cast<std::size_t>(check)];
  MeshCheck result{.name = row.name, .all_geometry = row.all, .warns = row.warns, .limit = shown(check, limit), .measured = tally.measured, .failing = tally.failing};
  if (tally.measured == 0) return result;
  result.worst = shown(check, row.greater_is_worse ? tally.greatest : tally.least);
  result.best = shown(check, row.greater_is_worse ? tally.least : tally.greatest);
  if (row.has_mean) result.mean = shown(check, tally.sum / static_cast<double>(tally.measured));
  result.passed = passes(check, tally);
  return result;
}

// Rows of one number are one check.
int failed_checks(const std::vector<MeshCheck>& checks, bool all) {
  int failed = 0, last = -1;
  for (std::size_t i = 0; i < checks.size(); ++i) {
    if (checks[i].passed || (checks[i].all_geometry && !all) || kRows[i].counted_as == last) continue;
    last = kRows[i].counted_as;
    ++failed;
  }
  return failed;
}

MeshQuality judged(const Tallies& tallies, const Limits& limits) {
  MeshQuality result;
  for (int check = 0; check < kChecks; ++check) result.checks.push_back(check_of(check, tallies.of[static_cast<std::size_t>(check)], limits[static_cast<std::size_t>(check)]));
  result.volume = tallies.of[cell_volume].sum;
  result.failed = failed_checks(result.checks, true);
  result.plain_failed = failed_checks(result.checks, false);
  result.ok = result.failed == 0;
  result.plain_ok = result.plain_failed == 0;
  return result;
}

MeshQuality quality_of(StoredGeometry& g, const MeshQualityLimits& limits, Progress& progress) {
  const Limits values = limits_of(limits, g.mesh);
  MeshQuality result = judged(measured(g, values, progress), values);
  result.cells = g.mesh.cells;
  result.points = g.mesh.points.size();
  result.faces = g.mesh.faces();
  result.internal_faces = g.mesh.internal_faces();
  std::vector<std::uint32_t> region;
  result.regions = connected_parts(g.mesh, region);
  return result;
}

void add_shapes(MeshQuality& quality, const VolumeMesh& mesh, const StoredGeometry& g) {
  for (std::size_t c = 0; c < mesh.cells(); ++c) {
    ++quality.cells_of_shape[static_cast<std::size_t>(mesh.shape[c])];
    quality.volume_of_shape[static_cast<std::size_t>(mesh.shape[c])] += g.cell_geometry[c].volume;
  }
  const auto angles = dihedral_angles(mesh);
  for (std::size_t s = 0; s < kCellShapes; ++s) {
    quality.least_dihedral_of_shape[s] = angles[s].least;
    quality.greatest_dihedral_of_shape[s] = angles[s].greatest;
  }
  quality.least_dihedral = angles[0].least;
  quality.greatest_dihedral = angles[0].greatest;
}

// The first check of the table that a cell fails, by itself or by a face; boundary openness and the like are nobody's.
template <class Geometry>
std::optional<BadCell> verdict(const Geometry& g, std::uint32_t cell, const Limits& limits, Scratch& scratch) {
  std::optional<BadCell> worst;
  int first = kChecks;
  const auto look = [&](const Measures& m) {
    for (int check = 0; check < first; ++check) {
      const double value = m.value[static_cast<std::size_t>(check)];
      if (std::isnan(value) || !fails(check, value, limits)) continue;
      first = check;
      worst = BadCell{cell, kRows[static_cast<std::size_t>(check)].name, shown(check, value), shown(check, limits[static_cast<std::size_t>(check)])};
    }
  };
  g.keep(cell, scratch);
  Measures own;
  measure_cell(g.mesh, g.faces, cell, scratch.sides, own);
  look(own);
  for (const std::uint32_t f : g.faces[cell]) {
    Measures m;
    measure_face(g, f, limits[concave_faces], scratch, m);
    look(m);
  }
  return worst;
}

// Of cell_of(i), i < n, in that order.
template <class Geometry, class CellOf>
std::vector<BadCell> verdicts(const Geometry& g, std::size_t n, const Limits& limits, CellOf&& cell_of) {
  return parallel_reduce(
      n, std::size_t{256}, std::vector<BadCell>{},
      [&](std::size_t begin, std::size_t end) {
        std::vector<BadCell> bad;
        Scratch scratch;
        for (std::size_t i = begin; i < end; ++i)
          if (const auto found = verdict(g, cell_of(i), limits, scratch)) bad.push_back(*found);
        return bad;
      },
      [](std::vector<BadCell> a, const std::vector<BadCell>& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
      });
}

}  // namespace

const MeshCheck& MeshQuality::check(std::string_view name) const {
  const auto found = std::find_if(checks.begin(), checks.end(), [&](const MeshCheck& c) { return c.name == name; });
  if (found == checks.end()) throw std::out_of_range("no check of a mesh has the name " + std::string(name));
  return *found;
}

MeshQuality mesh_quality(const PolyhedralMesh& mesh, const MeshQualityLimits& limits, Progress& progress) {
  const CellFaces faces = cell_faces(mesh);
  StoredGeometry g{mesh, faces, {}};
  return quality_of(g, limits, progress);
}

MeshQuality mesh_quality(const VolumeMesh& mesh, const MeshQualityLimits& limits, Progress& progress) {
  const CellFaces faces = cell_faces(mesh.mesh);
  StoredGeometry g{mesh.mesh, faces, {}};
  MeshQuality result = quality_of(g, limits, progress);
  add_shapes(result, mesh, g);
  return result;
}

std::vector<BadCell> bad_cells(const PolyhedralMesh& mesh, const MeshQualityLimits& limits, Progress& progress) {
  const CellFaces faces = cell_faces(mesh);
  const StoredGeometry g = stored_geometry(mesh, faces);
  progress.check();
  return verdicts(g, mesh.cells, limits_of(limits, mesh), [](std::size_t i) { return static_cast<std::uint32_t>(i); });
}

std::vector<BadCell> bad_cells_among(const PolyhedralMesh& mesh, const CellFaces& faces, std::span<const std::uint32_t> cells, const MeshQualityLimits& limits) {
  return verdicts(LocalGeometry{mesh, faces}, cells.size(), limits_of(limits), [&](std::size_t i) { return cells[i]; });
}

}  // namespace burnish
