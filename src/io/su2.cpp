// SU2's native mesh: text, numbers from 0, VTK's numbers of shapes.
#include <fmt/format.h>

#include <algorithm>

#include "burnish/core/error.h"
#include "burnish/io/volume_files.h"
#include "element_corners.h"
#include "fd_writer.h"
#include "patch_names.h"

namespace burnish {
namespace {

constexpr std::array<std::size_t, kCellShapes> kType{10, 14, 13, 12, 42};
constexpr std::size_t kTriangle = 5, kQuadrilateral = 9;
constexpr std::size_t kRange = std::size_t{1} << 16;  // items between looks at the progress

void put_element(FdWriter& out, std::size_t type, std::span<const std::uint32_t> corners) {
  out.put(type);
  for (const std::uint32_t c : corners) {
    out.put(" ");
    out.put(std::size_t{c});
  }
  out.put("\n");
}

void put_cells(FdWriter& out, const VolumeMesh& mesh, Progress& progress) {
  out.put(fmt::format("NDIME= 3\nNELEM= {}\n", mesh.cells()));
  for (std::size_t c = 0; c < mesh.cells(); ++c) {
    if (c % kRange == 0) progress.check();
    put_element(out, kType[static_cast<std::size_t>(mesh.shape[c])], element_corners(mesh, c).span());
  }
}

void put_points(FdWriter& out, const std::vector<Vec3>& points, Progress& progress) {
  out.put(fmt::format("NPOIN= {}\n", points.size()));
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (p % kRange == 0) progress.check();
    for (int a = 0; a < 3; ++a) {
      out.put(points[p][a]);
      out.put(a < 2 ? " " : "\n");
    }
  }
}

void put_markers(FdWriter& out, const PolyhedralMesh& mesh) {
  const std::vector<std::string> names = patch_names(mesh.patches);
  out.put(fmt::format("NMARK= {}\n", names.size()));
  for (std::size_t i = 0; i < names.size(); ++i) {
    const MeshPatch& p = mesh.patches[i];
    out.put(fmt::format("MARKER_TAG= {}\nMARKER_ELEMS= {}\n", names[i], p.faces));
    for (std::size_t f = p.first_face; f < std::size_t{p.first_face} + p.faces; ++f) put_element(out, mesh.face(f).size() == 3 ? kTriangle : kQuadrilateral, mesh.face(f));
  }
}

}  // namespace

void require_elements(const std::string& path, const VolumeMesh& mesh) {
  const auto polyhedra = std::count(mesh.shape.begin(), mesh.shape.end(), CellShape::polyhedron);
  if (polyhedra > 0)
    throw Error(ErrorCode::usage, fmt::format("{}: the format has no cells for the {} polyhedra of the mesh", path, polyhedra), "make a conforming mesh, or write an OpenFOAM case or a .vtu");
}

void write_su2(const std::string& path, const VolumeMesh& mesh, const VolumeWriteOptions& options, Progress& progress) {
  require_elements(path, mesh);
  OutputFile file(path, options.overwrite);
  FdWriter out(file.fd(), path);
  put_cells(out, mesh, progress);
  progress.update(0.5);
  put_points(out, mesh.mesh.points, progress);
  put_markers(out, mesh.mesh);
  out.flush();
  file.commit();
}

}  // namespace burnish
