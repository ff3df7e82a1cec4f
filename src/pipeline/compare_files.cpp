#include "burnish/pipeline/compare_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <string_view>
#include <utility>

#include "burnish/io/mesh_io.h"
#include "burnish/io/output_file.h"
#include "burnish/io/point_data.h"
#include "burnish/surface/exact_distance.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/weld.h"
#include "read_input.h"

namespace burnish {
namespace {

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

// One of the two surfaces, ready to be asked.
class Side {
 public:
  Side(const std::string& path, bool salvage, Progress& progress) {
    progress.begin_stage(fmt::format("reading {}", path == "-" ? "standard input" : path));
    MeshFile mesh = read_mesh(path, {.salvage = salvage});
    file.file = path;
    file.format = name(mesh.format);
    file.warnings = std::move(mesh.warnings);
    progress.check();
    soup = weld(std::move(mesh.soup));
    require_measurable(path, bounding_box(soup).diagonal());
    progress.check();
    file.measures = inspect(soup, {.self_intersections = false}, progress).defects;
    rule = side_rule(soup);
    if (rule == SideRule::winding_number)
      file.volume = file.measures.volume;
    else
      file.no_volume_reason = reason_without_volume(file.measures);
  }

  void make_ready(bool exactly) {
    index = std::make_unique<TriangleIndex>(soup);
    if (exactly) exact = std::make_unique<ExactDistance>(soup, *index);
  }

  ClosestQuery query(QueryCounter& counter) const {
    return [this, &counter](const Vec3& p) -> ClosestPoint {
      counter.count();
      if (exact) {
        const ExactDistance::Closest c = exact->closest(p);
        return {c.point, c.squared_distance, c.facet};
      }
      const TriangleIndex::Closest c = index->closest(p);
      return {c.point, c.squared_distance, c.facet};
    };
  }

  ComparedFile file;
  TriangleSoup soup;
  SideRule rule = SideRule::winding_number;
  std::unique_ptr<TriangleIndex> index;
  std::unique_ptr<ExactDistance> exact;

 private:
  static std::string reason_without_volume(const Defects& d) {
    if (d.open_edges > 0) return fmt::format("the surface is open: {} open edges", d.open_edges);
    return "the facets do not agree on what is outside";
  }
};

// Created before the work: a file that cannot be written is to be known before it, not after.
class DeviationOutput {
 public:
  DeviationOutput(const std::string& path, bool overwrite) : format_(marked_format_for_writing(path)), file_(path, overwrite) {}

  void write(const Side& a, const Side& b, Progress& progress) {
    QueryCounter counter(progress, "colouring", a.soup.points.size());
    PointArray deviation{"deviation", signed_deviation(a.soup.points, b.soup, *b.index, b.query(counter), b.rule)};
    PointArray distance{"distance", deviation.values};
    for (double& d : distance.values) d = std::abs(d);
    const bool closed = b.rule == SideRule::winding_number;
    const PointData data{a.soup,
                         {std::move(deviation), std::move(distance)},
                         {fmt::format("deviation in model units, positive outside, by {}",
                                      closed ? "the winding number" : "the side of the closest facet")}};
    write_point_data(file_.fd(), file_.destination(), data, format_);
    file_.commit();
  }

 private:
  MarkedFormat format_;
  OutputFile file_;
};

}  // namespace

CompareResult compare_files(const CompareJob& job, Progress& progress) {
  std::optional<DeviationOutput> output;
  if (!job.output.empty()) output.emplace(job.output, job.overwrite);
  Side a(job.a, job.salvage, progress), b(job.b, job.salvage, progress);
  CompareResult result;
  result.exact = job.exact;
  result.diagonal = a.file.measures.box.diagonal();
  if (job.max) result.limit = job.max->in_model_units(result.diagonal, 0);
  progress.begin_stage("indexing");
  a.make_ready(job.exact);
  progress.check();
  b.make_ready(job.exact);
  progress.check();

  const CompareOptions options{.area_samples = job.samples, .vertex_samples = job.samples};
  const auto queries = [&](const Side& side) { return job.samples + std::min(job.samples, side.soup.points.size()); };
  QueryCounter counter(progress, "measuring", queries(a) + queries(b));
  result.a_to_b = one_sided_comparison(a.soup, b.soup, b.query(counter), options);
  result.b_to_a = one_sided_comparison(b.soup, a.soup, a.query(counter), options);
  if (output) {
    output->write(a, b, progress);
    result.sign = b.rule;
  }
  result.a = std::move(a.file);
  result.b = std::move(b.file);
  return result;
}

}  // namespace burnish
