// gmsh's mesh files: 4.1 in binary, 2.2 in text.
#include <fmt/format.h>

#include "burnish/core/error.h"
#include "burnish/io/volume_files.h"
#include "element_corners.h"
#include "fd_writer.h"
#include "patch_names.h"

namespace burnish {
namespace {

constexpr std::array<int, kCellShapes> kType{4, 7, 6, 5, 0};
constexpr int kTriangle = 2, kQuadrilateral = 3;
constexpr int kVolume = 1;                            // the one entity of cells
constexpr std::size_t kRange = std::size_t{1} << 16;  // elements between looks at the progress

// Elements of one type in one entity, which is also their physical group's.
struct Block {
  int dimension, entity, type;
  std::size_t count;
};

// What both versions are made of: entities are patches, then the cells.
class MshWriter {
 public:
  MshWriter(const OutputFile& file, const VolumeMesh& mesh, Progress& progress) : out_(file.fd(), file.destination()), mesh_(mesh), progress_(progress) {
    std::vector<MeshPatch> groups = mesh.mesh.patches;
    groups.push_back({"fluid", ""});  // unless a patch has that name
    names_ = patch_names(groups);
    count_blocks();
  }

  void write_41() {
    out_.put("$MeshFormat\n4.1 1 8\n");
    out_.put_raw(1);
    out_.put("\n$EndMeshFormat\n");
    put_names();
    put_entities();
    put_nodes_41();
    progress_.update(0.4);
    put_elements_41();
    out_.flush();
  }

  void write_22() {
    out_.put("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n");
    put_names();
    put_nodes_22();
    progress_.update(0.4);
    put_elements_22();
    out_.flush();
  }

 private:
  const std::vector<MeshPatch>& patches() const { return mesh_.mesh.patches; }
  // Numbers of groups differ between patches and cells: readers of 2.2 tell names by them alone.
  int fluid() const { return static_cast<int>(patches().size()) + 1; }
  int group(const Block& b) const { return b.dimension == 3 ? fluid() : b.entity; }

  void count_blocks() {
    for (std::size_t i = 0; i < patches().size(); ++i) {
      std::array<std::size_t, 2> of{};
      for_each_face(i, [&](std::span<const std::uint32_t> face) { ++of[face.size() == 3 ? 0 : 1]; });
      for (const int k : {0, 1})
        if (const std::size_t n = of[static_cast<std::size_t>(k)]; n > 0) blocks_.push_back({2, static_cast<int>(i) + 1, k == 0 ? kTriangle : kQuadrilateral, n});
    }
    std::array<std::size_t, kCellShapes> of{};
    for (const CellShape shape : mesh_.shape) ++of[static_cast<std::size_t>(shape)];
    for (std::size_t s = 0; s < of.size(); ++s)
      if (of[s] > 0) blocks_.push_back({3, kVolume, kType[s], of[s]});
    for (const Block& b : blocks_) elements_ += b.count;
  }

  template <class Visit>
  void for_each_face(std::size_t patch, Visit&& visit) const {
    const MeshPatch& p = patches()[patch];
    for (std::size_t f = p.first_face; f < std::size_t{p.first_face} + p.faces; ++f) visit(mesh_.mesh.face(f));
  }

  template <class Visit>
  void for_each_element(const Block& b, Visit&& visit) const {
    if (b.dimension == 2) {
      const std::size_t corners = b.type == kTriangle ? 3 : 4;
      return for_each_face(static_cast<std::size_t>(b.entity) - 1, [&](std::span<const std::uint32_t> face) {
        if (face.size() == corners) visit(face);
      });
    }
    for (std::size_t c = 0; c < mesh_.cells(); ++c) {
      if (c % kRange == 0) progress_.check();
      if (kType[static_cast<std::size_t>(mesh_.shape[c])] == b.type) visit(element_corners(mesh_, c).span());
    }
  }

  void put_names() {
    out_.put(fmt::format("$PhysicalNames\n{}\n", names_.size()));
    for (std::size_t i = 0; i < patches().size(); ++i) out_.put(fmt::format("2 {} \"{}\"\n", i + 1, names_[i]));
    out_.put(fmt::format("3 {} \"{}\"\n$EndPhysicalNames\n", fluid(), names_.back()));
  }

  void put_size(std::size_t n) { out_.put_raw(std::uint64_t{n}); }

  void put_entity(int tag, const Box3& box, int physical, std::span<const int> boundary) {
    out_.put_raw(tag);
    out_.put_raw(box.lower);
    out_.put_raw(box.upper);
    put_size(1);
    out_.put_raw(physical);
    put_size(boundary.size());
    for (const int b : boundary) out_.put_raw(b);
  }

  // Patches without faces are none.
  void put_entities() {
    std::vector<int> surfaces;
    for (const Block& b : blocks_)
      if (b.dimension == 2 && (surfaces.empty() || surfaces.back() != b.entity)) surfaces.push_back(b.entity);
    out_.put("$Entities\n");
    for (const std::size_t n : {std::size_t{0}, std::size_t{0}, surfaces.size(), std::size_t{1}}) put_size(n);
    for (const int s : surfaces) {
      Box3 box;
      for_each_face(static_cast<std::size_t>(s) - 1, [&](std::span<const std::uint32_t> face) {
        for (const std::uint32_t p : face) box.extend(mesh_.mesh.points[p]);
      });
      put_entity(s, box, s, {});
    }
    Box3 box;
    for (const Vec3& p : mesh_.mesh.points) box.extend(p);
    put_entity(kVolume, box, fluid(), surfaces);
    out_.put("\n$EndEntities\n");
  }

  void put_nodes_41() {
    const std::size_t n = mesh_.mesh.points.size();
    out_.put("$Nodes\n");
    for (const std::size_t v : {std::size_t{1}, n, std::size_t{1}, n}) put_size(v);
    for (const int v : {3, kVolume, 0}) out_.put_raw(v);
    put_size(n);
    for (std::size_t p = 1; p <= n; ++p) put_size(p);
    for (const Vec3& p : mesh_.mesh.points) out_.put_raw(p);
    out_.put("\n$EndNodes\n");
  }

  void put_elements_41() {
    out_.put("$Elements\n");
    for (const std::size_t v : {blocks_.size(), elements_, std::size_t{1}, elements_}) put_size(v);
    std::size_t tag = 0;
    for (const Block& b : blocks_) {
      for (const int v : {b.dimension, b.entity, b.type}) out_.put_raw(v);
      put_size(b.count);
      for_each_element(b, [&](std::span<const std::uint32_t> corners) {
        put_size(++tag);
        for (const std::uint32_t c : corners) put_size(std::size_t{c} + 1);
      });
    }
    out_.put("\n$EndElements\n");
  }

  void put_number(std::size_t n, std::string_view behind) {
    out_.put(n);
    out_.put(behind);
  }

  void put_nodes_22() {
    out_.put(fmt::format("$Nodes\n{}\n", mesh_.mesh.points.size()));
    for (std::size_t p = 0; p < mesh_.mesh.points.size(); ++p) {
      put_number(p + 1, " ");
      for (int a = 0; a < 3; ++a) {
        out_.put(mesh_.mesh.points[p][a]);
        out_.put(a < 2 ? " " : "\n");
      }
    }
    out_.put("$EndNodes\n");
  }

  void put_elements_22() {
    out_.put(fmt::format("$Elements\n{}\n", elements_));
    std::size_t tag = 0;
    for (const Block& b : blocks_) {
      const std::string kind = fmt::format("{} 2 {} {}", b.type, group(b), b.entity);
      for_each_element(b, [&](std::span<const std::uint32_t> corners) {
        put_number(++tag, " ");
        out_.put(kind);
        for (const std::uint32_t c : corners) {
          out_.put(" ");
          out_.put(std::size_t{c} + 1);
        }
        out_.put("\n");
      });
    }
    out_.put("$EndElements\n");
  }

  FdWriter out_;
  const VolumeMesh& mesh_;
  Progress& progress_;
  std::vector<std::string> names_;  // of the patches, then of the cells
  std::vector<Block> blocks_;
  std::size_t elements_ = 0;
};

}  // namespace

void write_msh(const std::string& path, const VolumeMesh& mesh, const VolumeWriteOptions& options, Progress& progress) {
  require_elements(path, mesh);
  if (options.msh_version != 41 && options.msh_version != 22)
    throw Error(ErrorCode::usage, fmt::format("{}: version {} of gmsh's format is not written", path, options.msh_version), "41 (in binary) and 22 (in text) are");
  OutputFile file(path, options.overwrite);
  MshWriter writer(file, mesh, progress);
  options.msh_version == 41 ? writer.write_41() : writer.write_22();
  file.commit();
}

}  // namespace burnish
