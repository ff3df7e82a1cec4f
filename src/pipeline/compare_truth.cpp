#include "compare_truth.h"

namespace burnish {
namespace {

// V less V', in percent of V'.
std::optional<double> percent_more(const ComparedFile& v, const ComparedFile& reference) {
  if (!v.volume || !reference.volume || *reference.volume == 0) return {};
  return 100 * (*v.volume / *reference.volume - 1);
}

// What all surfaces that are compared with one truth share.
class TruthMeasure {
 public:
  TruthMeasure(const CompareJob& job, const ComparedSide& truth, double diagonal, TruthComparison& found, Progress& progress)
      : truth_(truth), progress_(progress), creases_(truth.soup, job.truth->crease_angle),
        options_{job.samples, job.truth->crease_width ? job.truth->crease_width->in_model_units(diagonal, 0)
                                                      : mean_edge_length(truth.soup)} {
    found.mean_edge = mean_edge_length(truth.soup);
    found.crease_angle = job.truth->crease_angle;
    found.crease_width = options_.near_crease;
    found.creases = creases_.count();
    found.crease_length = creases_.length();
  }

  TruthFigures of(const ComparedSide& side, std::string_view stage) const {
    QueryCounter counter(progress_, stage, 2 * options_.samples);
    return {truth_error(side.soup, side.query(counter), truth_.soup, truth_.query(counter), creases_, options_),
            percent_more(side.file, truth_.file)};
  }

 private:
  const ComparedSide& truth_;
  Progress& progress_;
  CreaseEdges creases_;
  TruthErrorOptions options_;
};

PointData errors_of(const ComparedSide& result, const ComparedSide& truth, Progress& progress) {
  QueryCounter counter(progress, "mapping", result.soup.facets.size());
  FacetErrors errors = facet_errors(result.soup, truth.soup, truth.query(counter));
  return {.surface = result.soup, .facet_arrays = {{"angle_error", std::move(errors.angle)}, {"distance_error", std::move(errors.distance)}}};
}

}  // namespace

const std::string& checked_map(const std::string& path) {
  if (marked_format_for_writing(path) != MarkedFormat::vtp)
    throw Error(ErrorCode::usage, fmt::format("{}: a map has numbers at its facets, which this format cannot hold", path),
                "use .vtp (ParaView, scripts/render)");
  return path;
}

TruthComparison compare_with_truth(const CompareJob& job, const ComparedSide& result, const ComparedSide& truth, ViewerFile* map,
                                   Progress& progress) {
  TruthComparison found;
  const TruthMeasure measure(job, truth, result.file.measures.box.diagonal(), found, progress);
  found.result = measure.of(result, "comparing normals");
  if (!job.truth->input.empty()) {
    const ComparedSide input(job.truth->input, job.salvage, progress);
    found.input = {input.file, percent_more(result.file, input.file)};
  }
  if (!job.truth->floor.empty()) {
    ComparedSide floor(job.truth->floor, job.salvage, progress);
    floor.make_ready(job.exact);
    found.floor = {floor.file, measure.of(floor, "comparing the floor")};
  }
  if (map) map->write(errors_of(result, truth, progress));
  return found;
}

}  // namespace burnish
