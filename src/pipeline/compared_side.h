// What comparing files has in common: a surface that was read, and how it is asked.
#pragma once

#include <fmt/format.h>

#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "burnish/core/progress.h"
#include "burnish/io/mesh_io.h"
#include "burnish/pipeline/compare_files.h"
#include "burnish/surface/exact_distance.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/weld.h"
#include "read_input.h"

namespace burnish {

// Counts queries, from any thread: draws their progress, and ends the run when that is asked for.
class QueryCounter {
 public:
  QueryCounter(Progress& progress, std::string_view stage, std::size_t total) : progress_(progress), total_(total) {
    progress_.begin_stage(stage);
  }

  void count() {
    const std::size_t done = done_.fetch_add(1, std::memory_order_relaxed);
    if (done % 256 != 0) return;
    progress_.check();
    progress_.update(static_cast<double>(done) / static_cast<double>(total_));
  }

 private:
  Progress& progress_;
  const std::size_t total_;
  std::atomic<std::size_t> done_{0};
};

// The closest point of the indexed surface; exactly, if there is an `exact` one. All three have to outlive the query.
inline ClosestQuery closest_query(const TriangleIndex& index, const ExactDistance* exact, QueryCounter& counter) {
  return [&index, exact, &counter](const Vec3& p) -> ClosestPoint {
    counter.count();
    if (exact != nullptr) {
      const ExactDistance::Closest c = exact->closest(p);
      return {c.point, c.squared_distance, c.facet};
    }
    const TriangleIndex::Closest c = index.closest(p);
    return {c.point, c.squared_distance, c.facet};
  };
}

// One of the surfaces that are compared.
class ComparedSide {
 public:
  ComparedSide(const std::string& path, bool salvage, Progress& progress) {
    progress.begin_stage(fmt::format("reading {}", path == "-" ? "standard input" : path));
    MeshFile mesh = read_mesh(path, {.salvage = salvage});
    file.file = path;
    file.format = name(mesh.format);
    file.warnings = std::move(mesh.warnings);
    unit = mesh.unit;
    progress.check();
    take(std::move(mesh.soup), progress);
  }

  // A surface in memory, welded or not.
  ComparedSide(TriangleSoup surface, Progress& progress) {
    progress.begin_stage("welding");
    file.file = file.format = kInMemory;
    take(std::move(surface), progress);
  }

  void make_ready(bool exactly) {
    index = std::make_unique<TriangleIndex>(soup);
    if (exactly) exact = std::make_unique<ExactDistance>(soup, *index);
  }

  ClosestQuery query(QueryCounter& counter) const { return closest_query(*index, exact.get(), counter); }

  ComparedFile file;
  std::optional<ModelUnit> unit;  // as the file says
  TriangleSoup soup;
  SideRule rule = SideRule::winding_number;
  std::unique_ptr<TriangleIndex> index;
  std::unique_ptr<ExactDistance> exact;

 private:
  void take(TriangleSoup surface, Progress& progress) {
    soup = weld(std::move(surface));
    require_measurable(file.file, bounding_box(soup).diagonal());
    progress.check();
    file.measures = inspect(soup, {.self_intersections = false}, progress).defects;
    rule = side_rule(soup);
    if (rule == SideRule::winding_number)
      file.volume = file.measures.volume;
    else
      file.no_volume_reason = reason_without_volume(file.measures);
  }

  static std::string reason_without_volume(const Defects& d) {
    if (d.open_edges > 0) return fmt::format("the surface is open: {} open edges", d.open_edges);
    return "the facets do not agree on what is outside";
  }
};

}  // namespace burnish
