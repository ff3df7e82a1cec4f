// constant/polyMesh: points, faces, owner, neighbour, boundary, in text or in binary.
#include <fmt/format.h>

#include <functional>
#include <memory>

#include "burnish/core/error.h"
#include "counts.h"
#include "foam_case_files.h"
#include "foam_file.h"
#include "packed_writer.h"
#include "patch_names.h"

namespace burnish {
namespace {

constexpr std::string_view kLocation = "    location    \"constant/polyMesh\";\n";

// Values in OpenFOAM's formats.
class FoamWriter {
 public:
  FoamWriter(const OutputFile& file, const FoamFormat& format) : out_(file, format.compressed), format_(format) {}

  void text(std::string_view t) { out_.put(t); }
  void scalar(double v) {
    if (!format_.binary) out_.put_number(v);
    else if (format_.scalar_bytes == 8) out_.put_raw(v);
    else out_.put_raw(static_cast<float>(v));
  }
  void label(std::uint64_t v) {
    if (!format_.binary) out_.put_number(v);
    else if (format_.label_bytes == 8) out_.put_raw(v);
    else out_.put_raw(static_cast<std::uint32_t>(v));
  }
  // Of an empty list OpenFOAM's binary has the length alone.
  template <class Label>
  void labels(const std::vector<Label>& values) {
    list(values.size(), [&](std::size_t i) { label(values[i]); });
  }
  template <class Item>
  void list(std::size_t count, Item&& item) {
    out_.put("\n");
    out_.put_number(count);
    if (count == 0) return out_.put(format_.binary ? "\n" : "()\n");
    out_.put(format_.binary ? "\n(" : "\n(\n");
    for (std::size_t i = 0; i < count; ++i) {
      item(i);
      if (!format_.binary) out_.put("\n");
    }
    out_.put(")\n");
  }
  void finish() { out_.finish(); }

 private:
  PackedWriter out_;
  FoamFormat format_;
};

class PolyMeshFiles {
 public:
  PolyMeshFiles(std::string folder, const PolyhedralMesh& mesh, const FoamFormat& format) : folder_(std::move(folder)), mesh_(mesh), format_(format) {}

  void write(Progress& progress) {
    const std::pair<double, std::function<void()>> steps[] = {{0.25, [&] { points(); }}, {0.75, [&] { faces(); }}, {0.9, [&] { cells("owner", mesh_.owner); }},
                                                              {1.0, [&] { cells("neighbour", mesh_.neighbour); }}, {1.0, [&] { boundary(); }}};
    for (const auto& [done, step] : steps) {
      progress.check();
      step();
      progress.update(done);
    }
    // None has its name before all are whole: whoever is stopped earlier leaves no file.
    for (const auto& file : files_) file->commit();
  }

 private:
  template <class Body>
  void store(const std::string& name, std::string_view class_name, const FoamFormat& format, std::string_view entries, Body&& body) {
    files_.push_back(std::make_unique<OutputFile>(folder_ + "/" + name + (format.compressed ? ".gz" : ""), false));
    FoamWriter out(*files_.back(), format);
    out.text(foam_header_text(class_name, name, format, std::string(entries) + std::string(kLocation)));
    body(out);
    out.finish();
  }

  void points() {
    store("points", "vectorField", format_, "", [&](FoamWriter& out) {
      const bool text = !format_.binary;
      out.list(mesh_.points.size(), [&](std::size_t p) {
        if (text) out.text("(");
        for (int a = 0; a < 3; ++a) {
          if (text && a > 0) out.text(" ");
          out.scalar(mesh_.points[p][a]);
        }
        if (text) out.text(")");
      });
    });
  }

  void faces() {
    store("faces", format_.binary ? "faceCompactList" : "faceList", format_, "", [&](FoamWriter& out) {
      if (format_.binary) {
        out.labels(mesh_.face_start);
        return out.labels(mesh_.face_points);
      }
      out.list(mesh_.faces(), [&](std::size_t f) {
        const auto face = mesh_.face(f);
        out.label(face.size());
        for (std::size_t i = 0; i < face.size(); ++i) {
          out.text(i == 0 ? "(" : " ");
          out.label(face[i]);
        }
        out.text(")");
      });
    });
  }

  // Of the face's owners, or of their neighbours.
  void cells(const std::string& name, const std::vector<std::uint32_t>& of_face) {
    const std::string note =
        fmt::format("    note        \"nPoints:{}  nCells:{}  nFaces:{}  nInternalFaces:{}\";\n", mesh_.points.size(), mesh_.cells, mesh_.faces(), mesh_.internal_faces());
    store(name, "labelList", format_, note, [&](FoamWriter& out) { out.labels(of_face); });
  }

  void boundary() {
    const FoamFormat text;
    const std::vector<std::string> names = patch_names(mesh_.patches);
    store("boundary", "polyBoundaryMesh", text, "", [&](FoamWriter& out) {
      out.list(mesh_.patches.size(), [&](std::size_t i) {
        const MeshPatch& p = mesh_.patches[i];
        out.text(fmt::format("    {}\n    {{\n        type            {};\n{}        nFaces          {};\n        startFace       {};\n    }}", names[i], p.type,
                             p.type == "patch" ? "" : fmt::format("        inGroups        1({});\n", p.type), p.faces, p.first_face));
      });
    });
  }

  std::string folder_;
  const PolyhedralMesh& mesh_;
  FoamFormat format_;
  std::vector<std::unique_ptr<OutputFile>> files_;
};

// Lists longer than their labels can count cannot be read.
void require_labels(const std::string& folder, const PolyhedralMesh& mesh, const FoamFormat& format) {
  if (format.binary && format.label_bytes == 8) return;
  require_32_bit_labels(folder, std::max<std::uint64_t>(format.binary ? mesh.face_points.size() : mesh.points.size(), mesh.faces()));
}

}  // namespace

void write_poly_mesh(const std::string& folder, const PolyhedralMesh& mesh, const FoamFormat& format, Progress& progress) {
  require_labels(folder, mesh, format);
  PolyMeshFiles(folder, mesh, format).write(progress);
}

}  // namespace burnish
