#include "burnish/pipeline/compare_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "burnish/io/output_file.h"
#include "burnish/io/point_data.h"
#include "compare_truth.h"
#include "compared_side.h"

namespace burnish {
namespace {

// Created before the work: a file that cannot be written is to be known before it, not after.
class DeviationOutput {
 public:
  DeviationOutput(const std::string& path, bool overwrite) : format_(marked_format_for_writing(path)), file_(path, overwrite) {}

  void write(const ComparedSide& a, const ComparedSide& b, Progress& progress) {
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

}  // namespace

CompareResult compare_files(const CompareJob& job, Progress& progress) {
  std::optional<DeviationOutput> output;
  if (!job.output.empty()) output.emplace(job.output, job.overwrite);
  std::optional<AlignedOutput> aligned;
  if (!job.aligned.empty()) aligned.emplace(job.aligned, job.overwrite);
  std::optional<ErrorMap> map;
  if (job.truth && !job.truth->map.empty()) map.emplace(job.truth->map, job.overwrite);
  ComparedSide a(job.a, job.salvage, progress), b(job.b, job.salvage, progress);
  CompareResult result;
  result.exact = job.exact;
  if (job.align) result.alignment = align(a, b, progress);
  if (aligned) aligned->write(a);
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
  if (output) {
    output->write(a, b, progress);
    result.sign = b.rule;
  }
  if (job.truth) result.truth = compare_with_truth(job, a, b, map ? &*map : nullptr, progress);
  result.a = std::move(a.file);
  result.b = std::move(b.file);
  return result;
}

}  // namespace burnish
