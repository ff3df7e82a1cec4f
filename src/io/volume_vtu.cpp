// A volume mesh as VTK's XML UnstructuredGrid.
#include "burnish/core/parallel.h"
#include "burnish/io/volume_files.h"
#include "cell_stream.h"

namespace burnish {
namespace {

using detail::kPortion;
using detail::kRange;
using detail::put_array;

constexpr std::array<std::uint8_t, kCellShapes> kType{10, 14, 13, 12, 42};

// `value(i)` of the range, as bytes.
template <class T, class Value>
void put_values(VtkAppended& out, std::size_t count, Progress& progress, Value&& value) {
  put_array(out, count, sizeof(T), progress, [&](std::size_t begin, std::size_t end, char* to) {
    for (std::size_t i = begin; i < end; ++i, to += sizeof(T)) {
      const T v = value(i);
      std::memcpy(to, &v, sizeof v);
    }
  });
}

class VolumeVtu {
 public:
  VolumeVtu(const OutputFile& file, const VolumeMesh& mesh, Progress& progress) : out_(file.fd(), file.destination()), mesh_(mesh), progress_(progress) { count_faces(); }

  void write() {
    out_.text(detail::vtu_opening(mesh_.mesh.points.size(), mesh_.cells()));
    out_.text("      <CellData>\n");
    out_.announce("UInt8", "shape", mesh_.cells());
    out_.text("      </CellData>\n      <Points>\n");
    out_.announce("Float64", "Points", mesh_.mesh.points.size(), 3);
    out_.text("      </Points>\n      <Cells>\n");
    out_.announce("Int64", "connectivity", mesh_.corners.size());
    out_.announce("Int64", "offsets", mesh_.cells());
    out_.announce("UInt8", "types", mesh_.cells());
    if (has_polyhedra()) {
      out_.announce("Int64", "faces", end_.back());
      out_.announce("Int64", "faceoffsets", mesh_.cells());
    }
    out_.text("      </Cells>\n    </Piece>\n  </UnstructuredGrid>\n");
    out_.begin_data();
    put_arrays();
    out_.finish();
  }

 private:
  bool has_polyhedra() const { return !end_.empty(); }

  // Numbers that a polyhedron's faces take: how many, then of each its points, how many and which.
  void count_faces() {
    if (std::find(mesh_.shape.begin(), mesh_.shape.end(), CellShape::polyhedron) == mesh_.shape.end()) return;
    faces_ = cell_faces(mesh_.mesh);
    end_.assign(mesh_.cells(), 0);
    parallel_for(mesh_.cells(), [&](std::size_t c) {
      if (mesh_.shape[c] != CellShape::polyhedron) return;
      end_[c] = 1;
      for (const std::uint32_t f : faces_[c]) end_[c] += 1 + mesh_.mesh.face(f).size();
    });
    for (std::size_t c = 1; c < end_.size(); ++c) end_[c] += end_[c - 1];
  }

  void put_arrays() {
    put_values<std::uint8_t>(out_, mesh_.cells(), progress_, [&](std::size_t c) { return static_cast<std::uint8_t>(mesh_.shape[c]); });
    put_values<Vec3>(out_, mesh_.mesh.points.size(), progress_, [&](std::size_t p) { return mesh_.mesh.points[p]; });
    progress_.update(0.3);
    put_values<std::int64_t>(out_, mesh_.corners.size(), progress_, [&](std::size_t i) { return std::int64_t{mesh_.corners[i]}; });
    put_values<std::int64_t>(out_, mesh_.cells(), progress_, [&](std::size_t c) { return static_cast<std::int64_t>(mesh_.first[c + 1]); });
    put_values<std::uint8_t>(out_, mesh_.cells(), progress_, [&](std::size_t c) { return kType[static_cast<std::size_t>(mesh_.shape[c])]; });
    if (!has_polyhedra()) return;
    progress_.update(0.7);
    put_faces();
    put_values<std::int64_t>(out_, mesh_.cells(), progress_, [&](std::size_t c) { return mesh_.shape[c] == CellShape::polyhedron ? static_cast<std::int64_t>(end_[c]) : -1; });
  }

  void put_faces() {
    out_.begin_array(end_.back() * sizeof(std::int64_t));
    for (std::size_t first = 0; first < mesh_.cells(); first += kPortion) {
      progress_.check();
      const std::size_t n = std::min(kPortion, mesh_.cells() - first);
      std::vector<std::vector<std::int64_t>> parts((n + kRange - 1) / kRange);
      parallel_ranges(n, kRange, [&](std::size_t begin, std::size_t end) { parts[begin / kRange] = faces_of(first + begin, first + end); });
      for (const auto& part : parts) out_.put(part.data(), part.size() * sizeof(std::int64_t));
    }
    out_.end_array();
  }

  // Normals outwards, of each cell.
  std::vector<std::int64_t> faces_of(std::size_t begin, std::size_t end) const {
    std::vector<std::int64_t> numbers;
    for (std::size_t c = begin; c < end; ++c) {
      if (mesh_.shape[c] != CellShape::polyhedron) continue;
      numbers.push_back(static_cast<std::int64_t>(faces_[c].size()));
      for (const std::uint32_t f : faces_[c]) {
        const auto face = mesh_.mesh.face(f);
        numbers.push_back(static_cast<std::int64_t>(face.size()));
        mesh_.mesh.owner[f] == c ? numbers.insert(numbers.end(), face.begin(), face.end()) : numbers.insert(numbers.end(), face.rbegin(), face.rend());
      }
    }
    return numbers;
  }

  VtkAppended out_;
  const VolumeMesh& mesh_;
  Progress& progress_;
  CellFaces faces_;                 // of a mesh with polyhedra
  std::vector<std::uint64_t> end_;  // per cell, where its numbers end
};

}  // namespace

void write_vtu(const std::string& path, const VolumeMesh& mesh, const VolumeWriteOptions& options, Progress& progress) {
  OutputFile file(path, options.overwrite);
  VolumeVtu(file, mesh, progress).write();
  file.commit();
}

}  // namespace burnish
