// Meshes of hexahedra, and polyMesh folders in every format that OpenFOAM writes them in.
#pragma once

#include <fmt/format.h>
#include <zlib.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "burnish/io/foam_case.h"
#include "burnish/volume/polyhedral_mesh.h"

namespace burnish::test {

// nx x ny x nz cells in a box, x fastest, faces in OpenFOAM's upper triangular order; patches "walls" (x and y) and "ends" (z).
inline PolyhedralMesh hexahedra(std::uint32_t nx, std::uint32_t ny, std::uint32_t nz, const Box3& box = {{0, 0, 0}, {1, 1, 1}}) {
  PolyhedralMesh m;
  const auto point = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) { return i + (nx + 1) * (j + (ny + 1) * k); };
  const auto cell = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) { return i + nx * (j + ny * k); };
  const Vec3 e = box.extent();
  for (std::uint32_t k = 0; k <= nz; ++k)
    for (std::uint32_t j = 0; j <= ny; ++j)
      for (std::uint32_t i = 0; i <= nx; ++i) m.points.push_back({box.lower.x + e.x * i / nx, box.lower.y + e.y * j / ny, box.lower.z + e.z * k / nz});
  m.cells = nx * ny * nz;
  m.face_start = {0};
  const auto add = [&](std::vector<std::uint32_t> points, std::uint32_t owner) {
    m.face_points.insert(m.face_points.end(), points.begin(), points.end());
    m.face_start.push_back(m.face_points.size());
    m.owner.push_back(owner);
  };
  // The face of a cell towards +axis, or towards -axis, outwards.
  const auto face = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k, int axis, bool up) {
    std::vector<std::uint32_t> p;
    for (int c = 0; c < 4; ++c) {
      std::uint32_t at[3] = {i, j, k};
      at[axis] += up;
      at[(axis + 1) % 3] += c == 1 || c == 2;
      at[(axis + 2) % 3] += c >= 2;
      p.push_back(point(at[0], at[1], at[2]));
    }
    return up ? p : std::vector<std::uint32_t>(p.rbegin(), p.rend());
  };
  const auto cells = [&](auto&& visit) {
    for (std::uint32_t k = 0; k < nz; ++k)
      for (std::uint32_t j = 0; j < ny; ++j)
        for (std::uint32_t i = 0; i < nx; ++i) visit(i, j, k);
  };
  cells([&](auto i, auto j, auto k) {
    if (i + 1 < nx) add(face(i, j, k, 0, true), cell(i, j, k)), m.neighbour.push_back(cell(i + 1, j, k));
    if (j + 1 < ny) add(face(i, j, k, 1, true), cell(i, j, k)), m.neighbour.push_back(cell(i, j + 1, k));
    if (k + 1 < nz) add(face(i, j, k, 2, true), cell(i, j, k)), m.neighbour.push_back(cell(i, j, k + 1));
  });
  const auto patch = [&](const char* name, const char* type, auto&& faces) {
    const auto first = static_cast<std::uint32_t>(m.faces());
    faces();
    m.patches.push_back({name, type, first, static_cast<std::uint32_t>(m.faces()) - first});
  };
  const std::uint32_t last[3] = {nx - 1, ny - 1, nz - 1};
  const auto sides = [&](int axis) {
    cells([&](auto i, auto j, auto k) {
      const std::uint32_t at[3] = {i, j, k};
      if (at[axis] == 0) add(face(i, j, k, axis, false), cell(i, j, k));
      if (at[axis] == last[axis]) add(face(i, j, k, axis, true), cell(i, j, k));
    });
  };
  patch("walls", "wall", [&] { sides(0), sides(1); });
  patch("ends", "patch", [&] { sides(2); });
  return m;
}

class PolyMeshWriter {
 public:
  PolyMeshWriter(std::string folder, FoamFormat format) : folder_(std::move(folder)), format_(format) { std::filesystem::create_directories(folder_); }

  void write(const PolyhedralMesh& m) const {
    std::string points = header("vectorField", "points") + fmt::format("\n\n{}\n(", m.points.size());
    for (const Vec3& p : m.points) points += format_.binary ? scalar(p.x) + scalar(p.y) + scalar(p.z) : fmt::format("\n({} {} {})", p.x, p.y, p.z);
    store("points", points + ")\n");
    std::string faces = header(format_.binary ? "faceCompactList" : "faceList", "faces");
    if (format_.binary) {
      faces += list(std::vector<std::uint64_t>(m.face_start.begin(), m.face_start.end())) + list(m.face_points);
    } else {
      faces += fmt::format("\n{}\n(\n", m.faces());
      for (std::size_t f = 0; f < m.faces(); ++f) {
        faces += fmt::format("{}(", m.face(f).size());
        for (const std::uint32_t p : m.face(f)) faces += fmt::format("{}{}", p == m.face(f).front() ? "" : " ", p);
        faces += ")\n";
      }
      faces += ")\n";
    }
    store("faces", faces);
    store("owner", header("labelList", "owner") + list(m.owner));
    store("neighbour", header("labelList", "neighbour") + list(m.neighbour));
    std::string boundary = header("polyBoundaryMesh", "boundary") + fmt::format("\n{}\n(\n", m.patches.size());
    for (const MeshPatch& p : m.patches)
      boundary += fmt::format("    {}\n    {{\n        type            {};\n        inGroups        List<word> 1({});\n        nFaces          {};\n        startFace       {};\n    }}\n", p.name, p.type,
                              p.type, p.faces, p.first_face);
    store("boundary", boundary + ")\n\n// ***** //\n");
  }

  // As it stands in memory, gzipped if the format says so.
  void store(const std::string& name, const std::string& text) const {
    if (format_.compressed) {
      const gzFile file = gzopen((folder_ + "/" + name + ".gz").c_str(), "wb");
      gzwrite(file, text.data(), static_cast<unsigned>(text.size()));
      gzclose(file);
    } else {
      std::ofstream(folder_ + "/" + name, std::ios::binary) << text;
    }
  }

  std::string header(const std::string& class_name, const std::string& object) const {
    const std::string arch = format_.binary ? fmt::format("    arch        \"LSB;label={};scalar={}\";\n", 8 * format_.label_bytes, 8 * format_.scalar_bytes) : "";
    return fmt::format("/*-- C++ --*\\\n| written by a test |\n\\*--*/\nFoamFile\n{{\n    version     2.0;\n    format      {};\n{}    class       {};\n    object      {};\n}}\n// * * * //\n",
                       format_.binary ? "binary" : "ascii", arch, class_name, object);
  }

 private:
  template <class T>
  static std::string raw(T value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    return bytes;
  }
  std::string scalar(double v) const { return format_.scalar_bytes == 8 ? raw(v) : raw(static_cast<float>(v)); }

  template <class Label>
  std::string list(const std::vector<Label>& values) const {
    std::string text = fmt::format("\n{}\n(", values.size());
    for (const Label v : values) {
      if (!format_.binary)
        text += fmt::format("\n{}", v);
      else
        text += format_.label_bytes == 8 ? raw(static_cast<std::int64_t>(v)) : raw(static_cast<std::int32_t>(v));
    }
    return text + ")\n";
  }

  std::string folder_;
  FoamFormat format_;
};

}  // namespace burnish::test
