// Any bytes at all in place of one file of an OpenFOAM case: the first byte says which. They give a mesh whose numbers all exist, or a field that is
// written with its other entries as they were, or a burnish::Error. Anything else is a bug.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "burnish/core/error.h"
#include "burnish/io/foam_case.h"
#include "support/foam_files.h"

namespace {

namespace fs = std::filesystem;

void require(bool promise) {
  if (!promise) std::abort();
}

// One case for all inputs: two hexahedra, of which one file is replaced and put back.
class Case {
 public:
  Case() {
    std::string folder = (fs::temp_directory_path() / "burnish_fuzz_XXXXXX").string();
    path_ = ::mkdtemp(folder.data());
    fs::create_directories(path_ + "/system");
    for (const bool binary : {false, true}) {
      const burnish::FoamFormat format{.binary = binary};
      burnish::test::PolyMeshWriter(mesh(binary), format).write(burnish::test::hexahedra(2, 1, 1));
    }
  }
  ~Case() { fs::remove_all(path_); }

  std::string mesh(bool binary) const { return path_ + (binary ? "/constant/water/polyMesh" : "/constant/polyMesh"); }
  std::string path(const std::string& name) const { return path_ + "/" + name; }
  const std::string& folder() const { return path_; }

 private:
  std::string path_;
};

void read_mesh_with(const Case& c, const std::string& name, const std::string& bytes, bool binary) {
  const std::string path = c.mesh(binary) + "/" + name, kept = path + ".kept";
  fs::rename(path, kept);
  std::ofstream(path, std::ios::binary) << bytes;
  try {
    const burnish::PolyhedralMesh mesh = burnish::read_foam_mesh(c.folder(), "0", binary ? "water" : "").mesh;
    require(mesh.face_start.size() == mesh.faces() + 1 && mesh.face_start.back() == mesh.face_points.size());
    for (const std::uint32_t p : mesh.face_points) require(p < mesh.points.size());
    for (const std::uint32_t o : mesh.owner) require(o < mesh.cells);
    for (const std::uint32_t n : mesh.neighbour) require(n < mesh.cells);
    std::size_t covered = mesh.internal_faces();
    for (const burnish::MeshPatch& p : mesh.patches) require(p.first_face == covered), covered += p.faces;
    require(covered == mesh.faces());
    static_cast<void>(burnish::cell_geometry(mesh, burnish::cell_faces(mesh)));
  } catch (const burnish::Error& error) {
    require(error.code() == burnish::ErrorCode::unreadable_input);
  }
  fs::rename(kept, path);
}

void read_field_with(const Case& c, const std::string& bytes) {
  std::ofstream(c.path("alpha"), std::ios::binary) << bytes;
  try {
    burnish::FoamField field = burnish::read_foam_field(c.path("alpha"));
    burnish::set_patch_value(field, "walls", {{"walls", "wall", 0, 1}}, 0.5);
    field.format.compressed = false;
    burnish::OutputFile file(c.path("written"), true);
    burnish::write_foam_field(file, field, {0, 0.5, 1});
    file.commit();
    static_cast<void>(burnish::read_foam_field(c.path("written")));
  } catch (const burnish::Error& error) {
    require(error.code() == burnish::ErrorCode::unreadable_input);
  }
}

void read_control_with(const Case& c, const std::string& bytes) {
  std::ofstream(c.path("system/controlDict"), std::ios::binary) << bytes;
  try {
    require(!burnish::start_time_folder(c.folder()).empty());
  } catch (const burnish::Error& error) {
    require(error.code() == burnish::ErrorCode::unreadable_input);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Case c;
  if (size == 0) return 0;
  constexpr const char* kFiles[] = {"points", "faces", "owner", "neighbour", "boundary"};
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const std::size_t which = data[0] % 7;  // letters: 'i' points, 'j' faces, 'k' owner, 'l' neighbour, 'm' boundary, 'n' a field, 'o' controlDict
  if (which < 5)
    for (const bool binary : {false, true}) read_mesh_with(c, kFiles[which], bytes, binary);
  else if (which == 5)
    read_field_with(c, bytes);
  else
    read_control_with(c, bytes);
  return 0;
}
