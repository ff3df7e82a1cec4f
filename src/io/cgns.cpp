// CGNS files: one base, one unstructured zone, in HDF5. (CGNS Standard Interface Data Structures 3.4; the Mid-Level Library writes them.)
#include <cgnslib.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <set>
#include <span>
#include <string_view>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/io/output_file.h"
#include "burnish/io/volume_files.h"
#include "counts.h"
#include "element_corners.h"
#include "fd_writer.h"
#include "patch_names.h"

namespace burnish {
namespace {

constexpr std::size_t kLongestName = 27;  // of a node, 32, less what sections add
constexpr const char *kBase = "Base", *kZone = "Zone";
constexpr std::size_t kPiece = std::size_t{1} << 20;  // bytes copied at a time

struct Section {
  CellShape shape;
  ElementType_t type;
  const char* name;
};
constexpr std::array<Section, 4> kSections{{{CellShape::tetrahedron, TETRA_4, "Tetrahedra"}, {CellShape::pyramid, PYRA_5, "Pyramids"}, {CellShape::wedge, PENTA_6, "Prisms"}, {CellShape::hexahedron, HEXA_8, "Hexahedra"}}};

// At most so many bytes of a name, and no part of a character of UTF-8.
std::string cut(const std::string& name, std::size_t bytes) {
  const auto continues = [&](std::size_t i) { return (static_cast<unsigned char>(name[i]) & 0xc0) == 0x80; };
  std::size_t end = std::min(bytes, name.size());
  for (int i = 0; i < 3 && end > 0 && end < name.size() && continues(end); ++i) --end;
  return name.substr(0, end);
}

// Words that fit into the names of nodes, all different, and none that another node beside families, sections or conditions has.
std::vector<std::string> node_names(const std::vector<MeshPatch>& patches) {
  std::vector<std::string> names = patch_names(patches);
  std::set<std::string> taken{kBase, kZone, "ZoneType", "GridCoordinates", "ZoneBC", "FamBC", "FamilyName"};
  for (const Section& section : kSections) taken.insert(section.name);
  for (std::string& name : names) {
    const std::string whole = name;
    name = cut(whole, kLongestName);
    for (int i = 2; !taken.insert(name).second; ++i) {
      const std::string end = fmt::format("_{}", i);
      name = cut(whole, kLongestName - end.size()) + end;
    }
  }
  return names;
}

BCType_t condition_of(const MeshPatch& patch) { return patch.type == "wall" ? BCWall : patch.type == "symmetry" ? BCSymmetryPlane : BCTypeUserDefined; }

class CgnsFile {
 public:
  CgnsFile(const std::string& path, const std::string& label) : label_(label) {
    check(cg_set_file_type(CG_FILE_HDF5));
    check(cg_open(path.c_str(), CG_MODE_WRITE, &file_));
    open_ = true;
  }
  ~CgnsFile() {
    if (open_) cg_close(file_);
  }
  CgnsFile(const CgnsFile&) = delete;
  CgnsFile& operator=(const CgnsFile&) = delete;

  void write(const VolumeMesh& mesh, Progress& progress) {
    check(cg_base_write(file_, kBase, 3, 3, &base_));
    const std::array<cgsize_t, 3> size{number(mesh.mesh.points.size()), number(mesh.cells()), 0};
    check(cg_zone_write(file_, base_, kZone, size.data(), Unstructured, &zone_));
    write_points(mesh.mesh.points);
    progress.update(0.3);
    for (const Section& section : kSections) {
      progress.check();
      write_cells(mesh, section);
    }
    progress.update(0.8);
    const std::vector<std::string> names = node_names(mesh.mesh.patches);
    for (std::size_t i = 0; i < names.size(); ++i) write_patch(mesh.mesh, mesh.mesh.patches[i], names[i]);
    open_ = false;
    check(cg_close(file_));
  }

 private:
  void check(int status) const {
    if (status != CG_OK) throw Error(ErrorCode::unwritable_output, fmt::format("{}: {}", label_, cg_get_error()), "free some room, or write another format: .vtu, .msh, .su2 or an OpenFOAM case");
  }
  cgsize_t number(std::size_t n) const {
    require_signed(label_, n, 8 * static_cast<int>(sizeof(cgsize_t)));
    return static_cast<cgsize_t>(n);
  }

  void write_points(const std::vector<Vec3>& points) {
    std::vector<double> along(points.size());
    constexpr std::array<const char*, 3> kNames{"CoordinateX", "CoordinateY", "CoordinateZ"};
    for (int a = 0; a < 3; ++a) {
      std::transform(points.begin(), points.end(), along.begin(), [&](const Vec3& p) { return p[a]; });
      int index = 0;
      check(cg_coord_write(file_, base_, zone_, RealDouble, kNames[static_cast<std::size_t>(a)], along.data(), &index));
    }
  }

  // Elements of one type with the numbers that come next; nothing for none.
  void write_section(const std::string& name, ElementType_t type, const std::vector<cgsize_t>& corners) {
    if (corners.empty()) return;
    int per_element = 0, index = 0;
    check(cg_npe(type, &per_element));
    const cgsize_t count = number(corners.size() / static_cast<std::size_t>(per_element));
    check(cg_section_write(file_, base_, zone_, name.c_str(), type, next_, number(static_cast<std::size_t>(next_) + static_cast<std::size_t>(count) - 1), 0, corners.data(), &index));
    next_ += count;
  }

  void append(std::vector<cgsize_t>& corners, std::span<const std::uint32_t> element) const {
    for (const std::uint32_t c : element) corners.push_back(static_cast<cgsize_t>(c + 1));
  }

  void write_cells(const VolumeMesh& mesh, const Section& section) {
    std::vector<cgsize_t> corners;
    for (std::size_t c = 0; c < mesh.cells(); ++c)
      if (mesh.shape[c] == section.shape) append(corners, element_corners(mesh, c).span());
    number(corners.size());
    write_section(section.name, section.type, corners);
  }

  // A family, its faces by their number of corners, and a boundary condition on both of these.
  void write_patch(const PolyhedralMesh& mesh, const MeshPatch& patch, const std::string& name) {
    std::array<std::vector<cgsize_t>, 2> corners;
    for (std::size_t f = patch.first_face; f < std::size_t{patch.first_face} + patch.faces; ++f) append(corners[mesh.face(f).size() == 3 ? 0 : 1], mesh.face(f));
    if (patch.faces == 0) return;
    const cgsize_t first = next_;
    write_section(name + "_Tri", TRI_3, corners[0]);
    write_section(name + "_Quad", QUAD_4, corners[1]);
    const std::array<cgsize_t, 2> range{first, next_ - 1};
    int family = 0, condition = 0, index = 0;
    check(cg_family_write(file_, base_, name.c_str(), &family));
    check(cg_fambc_write(file_, base_, family, "FamBC", condition_of(patch), &index));
    check(cg_boco_write(file_, base_, zone_, name.c_str(), FamilySpecified, PointRange, 2, range.data(), &condition));
    check(cg_boco_gridlocation_write(file_, base_, zone_, condition, FaceCenter));
    check(cg_goto(file_, base_, "Zone_t", zone_, "ZoneBC_t", 1, "BC_t", condition, "end"));
    check(cg_famname_write(name.c_str()));
  }

  const std::string label_;
  int file_ = 0, base_ = 0, zone_ = 0;
  bool open_ = false;
  cgsize_t next_ = 1;  // element
};

void copy(const std::string& from, OutputFile& to) {
  std::ifstream in(from, std::ios::binary);
  FdWriter out(to.fd(), to.destination());
  std::vector<char> piece(kPiece);
  while (in.read(piece.data(), static_cast<std::streamsize>(piece.size())), in.gcount() > 0) out.put(std::string_view(piece.data(), static_cast<std::size_t>(in.gcount())));
  if (!in.eof()) throw Error(ErrorCode::unwritable_output, to.destination() + ": cannot be read back", "look at the disk, or write another format: .vtu, .msh, .su2 or an OpenFOAM case");
  out.flush();
}

}  // namespace

bool has_cgns() { return true; }
void require_cgns(const std::string&) {}

// The library unlinks what it is given and makes a file of its own: that one is copied. It is named after the temporary file that is there, a name that nobody else has.
void write_cgns(const std::string& path, const VolumeMesh& mesh, const VolumeWriteOptions& options, Progress& progress) {
  require_elements(path, mesh);
  OutputFile file(path, options.overwrite);
  {
    const OutputFile scratch(file.temporary_path(), true);
    CgnsFile(scratch.temporary_path(), path).write(mesh, progress);
    copy(scratch.temporary_path(), file);
  }
  file.commit();
}

}  // namespace burnish
