// Small readers of meshes of elements (gmsh, SU2), and their sizes by the order of corners that gmsh's manual draws.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "burnish/core/vec.h"

namespace burnish::test {

struct Element {
  int type = 0;  // gmsh's: 2 triangle, 3 quadrilateral, 4 tetrahedron, 5 hexahedron, 6 prism, 7 pyramid
  std::string group;
  std::vector<std::size_t> corners;
};

struct ElementMesh {
  std::vector<Vec3> points;
  std::vector<Element> elements;
};

inline std::size_t corners_of_type(int type) {
  const std::map<int, std::size_t> corners{{2, 3}, {3, 4}, {4, 4}, {5, 8}, {6, 6}, {7, 5}};
  return corners.at(type);
}

// Of tetrahedra that fill an element.
inline std::vector<double> tetrahedra_volumes(const ElementMesh& mesh, const Element& e) {
  const std::map<int, std::vector<std::array<std::size_t, 4>>> parts{
      {4, {{0, 1, 2, 3}}},
      {5, {{0, 1, 3, 4}, {1, 3, 4, 5}, {3, 4, 5, 7}, {1, 2, 3, 5}, {2, 3, 5, 6}, {3, 5, 6, 7}}},
      {6, {{0, 1, 2, 3}, {1, 2, 3, 4}, {2, 3, 4, 5}}},
      {7, {{0, 1, 2, 4}, {0, 2, 3, 4}}}};
  std::vector<double> volumes;
  for (const auto& t : parts.at(e.type)) {
    const auto p = [&](std::size_t i) { return mesh.points.at(e.corners.at(t[i])); };
    volumes.push_back(dot(p(1) - p(0), cross(p(2) - p(0), p(3) - p(0))) / 6);
  }
  return volumes;
}

inline Vec3 area_vector(const ElementMesh& mesh, const Element& e) {
  Vec3 sum;
  const auto p = [&](std::size_t i) { return mesh.points.at(e.corners.at(i)); };
  for (std::size_t i = 1; i + 1 < e.corners.size(); ++i) sum += cross(p(i) - p(0), p(i + 1) - p(0)) * 0.5;
  return sum;
}

inline ElementMesh read_su2(const std::string& path) {
  const std::map<int, int> types{{5, 2}, {9, 3}, {10, 4}, {12, 5}, {13, 6}, {14, 7}};
  std::ifstream in(path);
  ElementMesh mesh;
  std::string key, group = "fluid";
  const auto elements = [&](std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
      int vtk = 0;
      in >> vtk;
      Element e{types.at(vtk), group, {}};
      e.corners.resize(corners_of_type(e.type));
      for (std::size_t& c : e.corners) in >> c;
      mesh.elements.push_back(e);
    }
  };
  std::size_t n = 0;
  while (in >> key) {
    if (key == "MARKER_TAG=") {
      in >> group;
    } else if (in >> n; key == "NELEM=" || key == "MARKER_ELEMS=") {
      elements(n);
    } else if (key == "NPOIN=") {
      mesh.points.resize(n);
      for (Vec3& p : mesh.points) in >> p.x >> p.y >> p.z;
    } else {
      EXPECT_TRUE(key == "NDIME=" || key == "NMARK=") << key;
    }
  }
  return mesh;
}

inline ElementMesh read_msh22(const std::string& path) {
  std::ifstream in(path);
  ElementMesh mesh;
  std::map<std::pair<int, int>, std::string> names;
  std::string word;
  std::size_t n = 0, tag = 0;
  while (in >> word) {
    if (word == "$MeshFormat") {
      in >> word;
      EXPECT_EQ(word, "2.2");
    } else if (word == "$PhysicalNames") {
      for (in >> n; n > 0; --n) {
        int dimension = 0, group = 0;
        in >> dimension >> group >> word;
        names[{dimension, group}] = word.substr(1, word.size() - 2);
      }
    } else if (word == "$Nodes") {
      in >> n;
      mesh.points.resize(n);
      for (Vec3& p : mesh.points) in >> tag >> p.x >> p.y >> p.z;
    } else if (word == "$Elements") {
      for (in >> n; n > 0; --n) {
        int type = 0, tags = 0, group = 0, entity = 0;
        in >> tag >> type >> tags >> group >> entity;
        EXPECT_EQ(tags, 2);
        Element e{type, names[{type < 4 ? 2 : 3, group}], {}};
        e.corners.resize(corners_of_type(type));
        for (std::size_t& c : e.corners) in >> c, --c;
        mesh.elements.push_back(e);
      }
    }
  }
  return mesh;
}

// In binary, one block of nodes, entities with one physical group each.
class Msh41Reader {
 public:
  explicit Msh41Reader(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(in), {});
  }

  ElementMesh read() {
    text("$MeshFormat\n4.1 1 8\n");
    EXPECT_EQ(take<int>(), 1);
    text("\n$EndMeshFormat\n");
    read_names();
    read_entities();
    read_nodes();
    read_elements();
    EXPECT_EQ(at_, bytes_.size());
    return mesh_;
  }

 private:
  template <class T>
  T take() {
    T value{};
    EXPECT_LE(at_ + sizeof value, bytes_.size());
    if (at_ + sizeof value <= bytes_.size()) std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  std::size_t size() { return take<std::uint64_t>(); }
  void text(const std::string& expected) {
    EXPECT_EQ(bytes_.substr(std::min(at_, bytes_.size()), expected.size()), expected);
    at_ += expected.size();
  }
  void read_names() {
    const std::size_t end = bytes_.find("$EndPhysicalNames\n", at_);
    std::istringstream in(bytes_.substr(at_, end - at_));
    std::string word;
    std::size_t n = 0;
    int dimension = 0, group = 0;
    for (in >> word >> n; n > 0; --n) {
      in >> dimension >> group >> word;
      names_[{dimension, group}] = word.substr(1, word.size() - 2);
    }
    at_ = end + std::string("$EndPhysicalNames\n").size();
  }
  void read_entities() {
    text("$Entities\n");
    EXPECT_EQ(size(), 0u);
    EXPECT_EQ(size(), 0u);
    const std::size_t counts[] = {size(), size()};
    for (const int dimension : {2, 3})
      for (std::size_t i = 0; i < counts[dimension - 2]; ++i) {
        const int tag = take<int>();
        const Vec3 lower = take<Vec3>(), upper = take<Vec3>();
        for (int a = 0; a < 3; ++a) EXPECT_LE(lower[a], upper[a]);
        EXPECT_EQ(size(), 1u);
        groups_[{dimension, tag}] = names_.at({dimension, take<int>()});
        for (std::size_t n = size(); n > 0; --n) EXPECT_EQ(groups_.count({2, take<int>()}), 1u);
      }
    text("\n$EndEntities\n");
  }
  void read_nodes() {
    text("$Nodes\n");
    EXPECT_EQ(size(), 1u);
    const std::size_t n = size();
    EXPECT_EQ(size(), 1u);
    EXPECT_EQ(size(), n);
    for (const int expected : {3, 1, 0}) EXPECT_EQ(take<int>(), expected);
    EXPECT_EQ(size(), n);
    for (std::size_t p = 1; p <= n; ++p) EXPECT_EQ(size(), p);
    for (std::size_t p = 0; p < n; ++p) mesh_.points.push_back(take<Vec3>());
    text("\n$EndNodes\n");
  }
  void read_elements() {
    text("$Elements\n");
    const std::size_t blocks = size(), n = size();
    EXPECT_EQ(size(), 1u);
    EXPECT_EQ(size(), n);
    for (std::size_t b = 0; b < blocks; ++b) {
      const int dimension = take<int>(), entity = take<int>(), type = take<int>();
      for (std::size_t i = size(); i > 0; --i) {
        EXPECT_EQ(size(), mesh_.elements.size() + 1);
        Element e{type, groups_.at({dimension, entity}), {}};
        for (std::size_t c = 0; c < corners_of_type(type); ++c) e.corners.push_back(size() - 1);
        mesh_.elements.push_back(e);
      }
    }
    EXPECT_EQ(mesh_.elements.size(), n);
    text("\n$EndElements\n");
  }

  std::string bytes_;
  std::size_t at_ = 0;
  ElementMesh mesh_;
  std::map<std::pair<int, int>, std::string> names_, groups_;
};
inline ElementMesh read_msh41(const std::string& path) { return Msh41Reader(path).read(); }

}  // namespace burnish::test
