// PolygonBuilder: the soup of a format with shared points and polygons (OBJ, PLY, OFF).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "burnish/io/mesh_io.h"
#include "source.h"

namespace burnish {

// Takes points and polygons in any order; a polygon may come before its points. Polygons are cut into
// fans from their first corner. Broken input (coordinates that are not finite, indices of points that
// do not exist) is an error, or in salvage leaves out the facets it touches. Polygons of fewer than
// three corners, which some programs write for points and edges, are left out with a warning.
class PolygonBuilder {
 public:
  explicit PolygonBuilder(const Source& source) : source_(source) {}

  // `at` is the point's place in the source, for messages.
  void add_point(const Vec3& point, const char* at);
  // Corners count from zero; negative ones are broken.
  void add_polygon(std::span<const std::int64_t> corners, const char* at);
  // A polygon of which not even the corners could be read. An error except in salvage.
  void add_broken_polygon(const char* at, const std::string& message);
  // Facets from here on belong to a group of this name.
  void begin_group(std::string name);
  // Takes all facets out of their groups.
  void forget_groups() { file_.soup.groups.clear(); }
  // Facets from here on have this colour; at first they have none.
  void set_color(Color color) { color_ = color; }
  void add_warning(std::string warning) { file_.warnings.push_back(std::move(warning)); }

  std::size_t point_count() const { return file_.soup.points.size(); }

  // Hands over the soup once everything was added.
  MeshFile finish(MeshFormat format);

 private:
  struct Forward {
    std::size_t facet;
    const char* at;
  };

  bool is_kept(const Facet& facet) const;
  std::string unknown_point(std::int64_t corner) const;
  void check_forward_references();
  void drop_broken_facets();
  void close_group();

  const Source& source_;
  MeshFile file_;
  Color color_ = kNoColor;
  std::vector<Forward> forward_;              // facets that were ahead of their points
  std::vector<std::uint32_t> broken_points_;  // ascending
  Tally dropped_, small_;
};

}  // namespace burnish
