#include "burnish/pipeline/compare_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "burnish/io/output_file.h"
#include "compare_truth.h"
#include "compared_side.h"
#include "viewer_file.h"

namespace burnish {
namespace {

constexpr std::size_t kPointsPerPart = std::size_t{1} << 18;

PointData deviation_of(const ComparedSide& a, const ComparedSide& b, Progress& progress) {
  QueryCounter counter(progress, "colouring", a.soup.points.size());
  PointArray deviation{"deviation", signed_deviation(a.soup.points, b.soup, *b.index, b.query(counter), b.rule)};
  PointArray distance{"distance", deviation.values};
  for (double& d : distance.values) d = std::abs(d);
  const bool closed = b.rule == SideRule::winding_number;
  return {a.soup,
          {std::move(deviation), std::move(distance)},
          {fmt::format("deviation in model units, positive outside, by {}", closed ? "the winding number" : "the side of the closest facet")}};
}

// A at its new place. Named by what it is written from, with the unit that this had.
class AlignedOutput {
 public:
  AlignedOutput(const std::string& path, bool overwrite) : file_(path, overwrite) { options_.format = format_for_writing(path); }

  void write(const ComparedSide& a) {
    if (a.unit) options_.unit = *a.unit;
    write_mesh(file_.fd(), file_.destination(), a.soup, options_);
    file_.commit();
  }

 private:
  MeshWriteOptions options_;
  OutputFile file_;
};

Registration align(ComparedSide& a, const ComparedSide& b, Progress& progress) {
  progress.begin_stage("aligning");
  const Registration found = register_rigidly(a.soup, b.soup, progress);
  for (Vec3& p : a.soup.points) p = found.motion(p);
  a.file.measures.box = bounding_box(a.soup);
  return found;
}

// Files in different units are compared as they are, with a warning.
std::optional<ModelUnit> unit_of(const CompareJob& job, ComparedSide& a, ComparedSide& b) {
  if (a.unit && b.unit && *a.unit != *b.unit)
    b.file.warnings.push_back(fmt::format("its unit is {}, that of A is {}: coordinates are compared as they are", name(*b.unit), name(*a.unit)));
  static_cast<void>(unit_of(job.unit, b.unit, b.file.warnings));
  return unit_of(job.unit, a.unit, a.file.warnings);
}

// Both ways.
CompareResult measure(const CompareJob& job, ComparedSide& a, ComparedSide& b, Progress& progress) {
  CompareResult result;
  result.exact = job.exact;
  result.unit = unit_of(job, a, b);
  result.diagonal = a.file.measures.box.diagonal();
  if (job.max) result.limit = job.max->in_model_units(result.diagonal, 0);
  progress.begin_stage("indexing");
  a.make_ready(job.exact);
  progress.check();
  b.make_ready(job.exact);
  progress.check();

  const CompareOptions options{.area_samples = job.samples, .vertex_samples = job.samples};
  const auto queries = [&](const ComparedSide& side) { return job.samples + std::min(job.samples, side.soup.points.size()); };
  QueryCounter counter(progress, "measuring", queries(a) + queries(b));
  result.a_to_b = one_sided_comparison(a.soup, b.soup, b.query(counter), options);
  result.b_to_a = one_sided_comparison(b.soup, a.soup, a.query(counter), options);
  return result;
}

}  // namespace

CompareResult compare_surfaces(TriangleSoup a, TriangleSoup b, const CompareJob& job, Progress& progress) {
  ComparedSide first(std::move(a), progress), second(std::move(b), progress);
  std::optional<Registration> alignment;
  if (job.align) alignment = align(first, second, progress);
  CompareResult result = measure(job, first, second, progress);
  result.alignment = alignment;
  result.a = std::move(first.file);
  result.b = std::move(second.file);
  return result;
}

std::vector<double> signed_distances(TriangleSoup surface, const std::vector<Vec3>& points, bool exactly, Progress& progress) {
  const TriangleSoup soup = weld(std::move(surface));
  require_measurable(kInMemory, bounding_box(soup).diagonal());
  const TriangleIndex index(soup);
  progress.check();
  const ExactDistance exact(soup, index);
  QueryCounter counter(progress, "measuring", points.size());
  const ClosestQuery closest = closest_query(index, exactly ? &exact : nullptr, counter);
  const SideRule rule = side_rule(soup);
  std::vector<double> distances;
  distances.reserve(points.size());
  // In parts, since the pass for the sides cannot be stopped.
  for (std::size_t begin = 0; begin < points.size(); begin += kPointsPerPart) {
    const auto first = points.begin() + static_cast<std::ptrdiff_t>(begin);
    const std::vector<Vec3> part(first, first + static_cast<std::ptrdiff_t>(std::min(kPointsPerPart, points.size() - begin)));
    const std::vector<double> of_part = signed_deviation(part, soup, index, closest, rule);
    distances.insert(distances.end(), of_part.begin(), of_part.end());
    progress.check();
  }
  return distances;
}

CompareResult compare_files(const CompareJob& job, Progress& progress) {
  std::optional<ViewerFile> output, map;
  if (!job.output.empty()) output.emplace(job.output, job.overwrite);
  std::optional<AlignedOutput> aligned;
  if (!job.aligned.empty()) aligned.emplace(job.aligned, job.overwrite);
  if (job.truth && !job.truth->map.empty()) map.emplace(checked_map(job.truth->map), job.overwrite);
  ComparedSide a(job.a, job.salvage, progress), b(job.b, job.salvage, progress);
  std::optional<Registration> alignment;
  if (job.align) alignment = align(a, b, progress);
  if (aligned) aligned->write(a);
  CompareResult result = measure(job, a, b, progress);
  result.alignment = alignment;
  if (output) {
    output->write(deviation_of(a, b, progress));
    result.sign = b.rule;
  }
  if (job.truth) result.truth = compare_with_truth(job, a, b, map ? &*map : nullptr, progress);
  result.a = std::move(a.file);
  result.b = std::move(b.file);
  return result;
}

}  // namespace burnish
