// constant/polyMesh: points, faces, owner, neighbour, boundary.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <utility>

#include "burnish/io/foam_case.h"
#include "foam_file.h"
#include "text_scanner.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kAnyLabel = std::numeric_limits<std::uint32_t>::max();

// One file of a mesh, opened at the first byte behind its header.
class MeshFile {
 public:
  MeshFile(const std::string& path, std::string_view expected_class, std::string_view other_class = {}) : file_(path), source_{file_.bytes(), file_.path(), false, true} {
    header_ = foam_header(source_, file_.compressed());
    if (header_.class_name != expected_class && (other_class.empty() || header_.class_name != other_class))
      source_.fail(fmt::format("expected the class {}, found {}", expected_class, burnish::quoted(header_.class_name)), "another file stands under this name: write the mesh again");
    scanner_.emplace(source_, header_.format, header_.end);
  }
  FoamScanner& scan() { return *scanner_; }
  const Source& source() const { return source_; }
  const FoamHeader& header() const { return header_; }

 private:
  FoamFile file_;
  Source source_;
  FoamHeader header_;
  std::optional<FoamScanner> scanner_;
};

void require_case(const std::string& folder) {
  const auto fail = [&](const std::string& message, const std::string& hint) { throw Error(ErrorCode::unreadable_input, folder + ": " + message, hint); };
  std::error_code ignored;
  if (!fs::exists(folder, ignored)) fail("no such folder", "--case names the folder with constant/ and system/ in it");
  if (!fs::is_directory(folder, ignored)) fail("is no folder", "--case names the folder with constant/ and system/ in it");
  if (!fs::exists(folder + "/system/controlDict", ignored) && !fs::is_directory(folder + "/constant", ignored))
    fail("is not an OpenFOAM case: neither system/controlDict nor constant/ is there", "--case names the folder with constant/ and system/ in it");
}

[[noreturn]] void fail_without_mesh(const std::string& folder, const std::string& poly_mesh) {
  if (FoamFile::exists(folder + "/processor0/constant/polyMesh/faces") || FoamFile::exists(folder + "/processor0/constant/polyMesh/points"))
    throw Error(ErrorCode::unreadable_input, folder + ": its mesh is decomposed: it is in the folders processor0, ... alone",
                "put it together with reconstructParMesh -constant, or give each part as a case of its own, such as --case " + folder + "/processor0");
  throw Error(ErrorCode::unreadable_input, poly_mesh + ": there is no mesh", "make it first, for example with blockMesh; --region names one of several");
}

// Where the mesh file of that name is that counts at `time`: in the latest time folder up to it that has one, or in constant.
std::string mesh_file(const std::string& folder, const std::string& time, const std::string& region, const std::string& name) {
  const std::string sub = (region.empty() ? "" : "/" + region) + std::string("/polyMesh/") + name;
  std::string best = folder + "/constant" + sub;
  const std::optional<double> until = whole_number(time);
  if (!until) return best;
  double latest = -1;
  for (const std::string& t : time_folders(folder)) {
    const double value = *whole_number(t);
    if (std::string found = fmt::format("{}/{}{}", folder, t, sub); value <= *until && value > latest && FoamFile::exists(found))
      best = std::move(found), latest = value;
  }
  return best;
}

// Their first points, and those points. faceCompactList or a list of lists.
void read_faces(const std::string& path, PolyhedralMesh& mesh) {
  MeshFile file(path, "faceList", "faceCompactList");
  FoamScanner& scan = file.scan();
  if (file.header().class_name == "faceCompactList") {
    const std::vector<std::uint32_t> starts = scan.labels({}, kAnyLabel, "face");
    if (starts.empty() || starts.front() != 0 || !std::is_sorted(starts.begin(), starts.end())) scan.fail("the places where faces begin do not ascend from 0");
    mesh.face_start.assign(starts.begin(), starts.end());
    mesh.face_points = scan.labels(starts.back(), mesh.points.size(), "point");
  } else {
    const std::size_t n = scan.count("faces");
    scan.expect('(', "before the faces");
    mesh.face_start.reserve(n + 1);
    mesh.face_points.reserve(4 * n);
    mesh.face_start.push_back(0);
    for (std::size_t f = 0; f < n; ++f) {
      scan.face(mesh.face_points, mesh.points.size());
      mesh.face_start.push_back(mesh.face_points.size());
    }
    scan.expect(')', "behind the faces");
  }
  for (std::size_t f = 0; f + 1 < mesh.face_start.size(); ++f)
    if (mesh.face_start[f + 1] - mesh.face_start[f] < 3)
      file.source().fail(fmt::format("face {} has {} points", f, mesh.face_start[f + 1] - mesh.face_start[f]), "a face has three points at least: mend the mesh with collapseEdges, or write it again");
}

// One cell more than the highest number: cells are not counted anywhere.
void count_cells(PolyhedralMesh& mesh, const MeshFile& file) {
  std::uint32_t highest = 0;
  for (const auto* list : {&mesh.owner, &mesh.neighbour})
    for (const std::uint32_t c : *list) highest = std::max(highest, c);
  const std::uint64_t cells = mesh.owner.empty() ? 0 : std::uint64_t{highest} + 1;
  // A cell without faces is none, and memory is not spent on it.
  if (cells > 2 * mesh.faces()) file.source().fail(fmt::format("cell {} does not exist: {} faces do not bound as many", highest, mesh.faces()), "owner and neighbour are not of these faces: write the mesh again");
  mesh.cells = static_cast<std::uint32_t>(cells);
}

void read_owner(const std::string& path, PolyhedralMesh& mesh) {
  MeshFile file(path, "labelList");
  mesh.owner = file.scan().labels(mesh.face_start.size() - 1, kAnyLabel, "cell");
}

void read_neighbour(const std::string& path, PolyhedralMesh& mesh) {
  MeshFile file(path, "labelList");
  mesh.neighbour = file.scan().labels({}, kAnyLabel, "cell");
  if (mesh.neighbour.size() > mesh.faces())
    file.source().fail(fmt::format("expected a list of {} at most, as many as there are faces, found one of {}", mesh.faces(), mesh.neighbour.size()), "owner and neighbour are not of these faces: write the mesh again");
  for (std::size_t f = 0; f < mesh.internal_faces(); ++f)
    if (mesh.neighbour[f] == mesh.owner[f]) file.source().fail(fmt::format("face {} has the same cell {} on both sides", f, mesh.owner[f]), kMeshHint);
  count_cells(mesh, file);
}

std::uint32_t whole_entry(const MeshFile& file, const FoamEntry& patch, const std::vector<FoamEntry>& entries, std::string_view name) {
  const FoamEntry* entry = find_entry(entries, name);
  const std::optional<double> value = entry ? whole_number(entry->value) : std::nullopt;
  if (!value || !(*value >= 0) || *value >= static_cast<double>(kAnyLabel) || *value != static_cast<double>(static_cast<std::uint32_t>(*value)))
    file.source().fail_at(patch.name.data(), fmt::format("patch {}: expected a whole number {}, found {}", patch.name, name, entry ? quoted(entry->value) : "none"), fmt::format("correct {} of this patch in the file boundary, or write the mesh again", name));
  return static_cast<std::uint32_t>(*value);
}

void read_boundary(const std::string& path, PolyhedralMesh& mesh) {
  MeshFile file(path, "polyBoundaryMesh");
  FoamScanner& scan = file.scan();
  const Source& source = file.source();
  static_cast<void>(scan.count("patches"));
  scan.expect('(', "before the patches");
  const std::string_view rest(scan.position(), static_cast<std::size_t>(source.end() - scan.position()));
  const std::size_t close = rest.rfind(')');
  if (close == rest.npos) source.fail("the list of patches is not closed", kCutOffHint);
  const FoamFormat text;
  std::uint64_t next = mesh.internal_faces();
  for (const FoamEntry& patch : foam_entries(source, rest.substr(0, close), text)) {
    const std::vector<FoamEntry> entries = foam_entries(source, patch.value, text);
    const FoamEntry* type = find_entry(entries, "type");
    if (!patch.is_dictionary || !type) source.fail_at(patch.name.data(), fmt::format("{} is no patch: it has no type", quoted(patch.name)), "a patch is 'name { type ...; nFaces ...; startFace ...; }'");
    const std::uint32_t faces = whole_entry(file, patch, entries, "nFaces"), first = whole_entry(file, patch, entries, "startFace");
    if (first != next || next + faces > mesh.faces())
      source.fail_at(patch.name.data(), fmt::format("patch {}: expected its faces from {} on, among {}; found {} from {} on", patch.name, next, mesh.faces(), faces, first), "patches follow each other without gaps: correct nFaces and startFace, or write the mesh again");
    mesh.patches.push_back({std::string(patch.name), std::string(type->value), first, faces});
    next += faces;
  }
  if (next != mesh.faces()) source.fail(fmt::format("{} faces on the boundary belong to no patch", mesh.faces() - next), "a patch is missing, or its nFaces is too small: correct the file boundary, or write the mesh again");
}

}  // namespace

FoamMesh read_foam_mesh(const std::string& case_folder, const std::string& time, const std::string& region, Progress& progress) {
  require_case(case_folder);
  const auto at = [&](const std::string& name) { return mesh_file(case_folder, time, region, name); };
  const std::string faces = at("faces"), poly_mesh = fs::path(faces).parent_path().string();
  if (!FoamFile::exists(faces)) fail_without_mesh(case_folder, poly_mesh);
  FoamMesh result;
  result.folder = poly_mesh;
  PolyhedralMesh& mesh = result.mesh;
  {
    MeshFile file(at("points"), "vectorField");
    result.format = file.header().format;
    mesh.points = file.scan().points();
  }
  progress.update(0.3);
  progress.check();
  read_faces(faces, mesh);
  progress.update(0.7);
  progress.check();
  read_owner(poly_mesh + "/owner", mesh);
  read_neighbour(poly_mesh + "/neighbour", mesh);
  progress.check();
  read_boundary(poly_mesh + "/boundary", mesh);
  if (mesh.cells == 0) throw Error(ErrorCode::unreadable_input, poly_mesh + ": the mesh has no cells", "make it first, for example with blockMesh");
  return result;
}

}  // namespace burnish
