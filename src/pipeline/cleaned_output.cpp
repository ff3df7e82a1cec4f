#include "cleaned_output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/surface/edge_table.h"
#include "burnish/surface/weld.h"
#include "read_input.h"

namespace burnish {
namespace {

constexpr int kMendingRounds = 12;
constexpr double kFloatStepShare = 0.05;  // of a cell: float32 steps beyond this deform the surface visibly

std::string temporary_folder() {
  const char* folder = std::getenv("TMPDIR");
  return folder && *folder ? folder : "/tmp";
}

// The facets of a welded soup that keep it from being a valid solid.
std::vector<std::uint32_t> broken_facets(const TriangleSoup& welded, const Inspection& inspection) {
  std::vector<std::uint32_t> broken;
  for (const auto& pair : inspection.self_intersections) broken.insert(broken.end(), pair.begin(), pair.end());
  for (std::uint32_t f = 0; f < welded.facets.size(); ++f)
    if (repeats_point(welded.facets[f]) || squared_norm(facet_normal_2a(welded, f)) == 0) broken.push_back(f);
  const EdgeTable table(welded);
  for (std::size_t e = 0; e < table.size(); ++e) {
    if (table.uses(e).size() == 2 && !table.is_misoriented(e)) continue;
    for (const EdgeUse& use : table.uses(e)) broken.push_back(use.facet);
  }
  const std::vector<std::uint32_t> pinched = non_manifold_points(welded);
  for (std::uint32_t f = 0; f < welded.facets.size() && !pinched.empty(); ++f)
    for (const std::uint32_t p : welded.facets[f])
      if (std::binary_search(pinched.begin(), pinched.end(), p)) broken.push_back(f);
  std::sort(broken.begin(), broken.end());
  broken.erase(std::unique(broken.begin(), broken.end()), broken.end());
  return broken;
}

TriangleSoup rounded_to_float32(TriangleSoup soup) {
  parallel_for(soup.points.size(), [&](std::size_t i) {
    Vec3& p = soup.points[i];
    p = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) return;
    throw Error(ErrorCode::unwritable_output, fmt::format("point {} of the result is beyond the range of float32", i), "take double precision");
  });
  return soup;
}

// Of a soup that is to be rounded, by the numbers of its own facets.
std::vector<std::uint32_t> broken_once_rounded(TriangleSoup soup, Progress& progress) {
  const TriangleSoup rounded = weld(rounded_to_float32(std::move(soup)));
  return broken_facets(rounded, inspect(rounded, {}, progress));
}

}  // namespace

CleanedOutput::CleanedOutput(const std::string& destination, bool overwrite) : destination_(destination) {
  const bool to_stdout = destination == "-";
  options_.format = to_stdout ? MeshFormat::stl_binary : format_for_writing(destination);
  file_ = std::make_unique<OutputFile>(to_stdout ? fmt::format("{}/burnish-output-{}.stl", temporary_folder(), getpid()) : destination,
                                       overwrite || to_stdout);
}

CleanedOutput::CleanedOutput(Precision precision, bool keeps_written) : keeps_written_(keeps_written) {
  options_.format = precision == Precision::float32 ? MeshFormat::stl_binary : MeshFormat::ply_binary;
}

std::string CleanedOutput::format_name() const { return is_in_memory() ? kInMemory : std::string(name(options_.format)); }

TriangleSoup CleanedOutput::as_read_back(const TriangleSoup& soup) const {
  if (is_in_memory()) return stores_float32() ? rounded_to_float32(soup) : soup;
  file_->truncate();
  write_mesh(file_->fd(), file_->destination(), soup, options_);
  return read_mesh(file_->temporary_path()).soup;
}

const TriangleSoup& CleanedOutput::write_and_read_back(const TriangleSoup& soup) {
  TriangleSoup read = as_read_back(soup);
  if (keeps_written_ && !stores_float32()) written_ = read;
  result_ = weld(std::move(read));
  if (keeps_written_ && stores_float32()) written_ = result_;
  return result_;
}

Inspection CleanedOutput::write_verified(SurfaceMaker& maker, const GridFrame& frame, const Finish& finish, Progress& progress) {
  // [T-MT-5]
  for (int round = 0;; ++round) {
    TriangleSoup model = maker.make();
    if (model.facets.empty()) return {};
    parallel_for(model.points.size(), [&](std::size_t i) { model.points[i] = frame.to_model(model.points[i]); });
    const Box3 box = bounding_box(model);
    const Vec3 largest = max(box.upper, box.lower * -1.0);
    const double step = std::max({largest.x, largest.y, largest.z}) * 0x1p-23;
    float_steps_too_coarse_ = stores_float32() && step > kFloatStepShare * frame.cell;
    const std::size_t facets = model.facets.size();
    if (finish) model = finish(std::move(model));
    const bool unfinished = model.facets.size() == facets;
    if (model.facets.empty()) return {};
    write_and_read_back(model);
    const bool keeps_numbers = result_.facets.size() == facets;  // a 3MF drops facets that rounding takes the area of
    if (keeps_numbers) model = {};
    Inspection inspection = inspect(result_, {}, progress);
    if (inspection.defects.valid_solid() || round == kMendingRounds || !unfinished) return inspection;
    if (!maker.mend(keeps_numbers ? broken_facets(result_, inspection) : broken_once_rounded(std::move(model), progress))) return inspection;
  }
}

Error CleanedOutput::reason_for_failure(const Defects& after, const ResolvedOptions& options) const {
  if (after.facets == 0 && options.moves_walls())
    return Error(ErrorCode::guarantee_unmet, "no solid: nothing of the model is left after --offset and --hollow", "it is thinner than twice that offset: choose a smaller one");
  if (after.facets == 0 && options.smooth > 0)
    return Error(ErrorCode::guarantee_unmet, "no solid: smoothing left nothing of the model", "choose a smaller --smooth, or bound it with --deviation");
  if (after.facets == 0)
    return Error(ErrorCode::guarantee_unmet, "no solid: nothing of the input bounds a volume that cells of this size can hold",
                 "choose a smaller --cell, or give sheets a thickness first");
  if (float_steps_too_coarse_)
    return Error(ErrorCode::guarantee_unmet,
                 fmt::format("the model lies too far from the origin: float32, which STL stores, has steps of more than {:g} cells there", kFloatStepShare),
                 "write .ply (double precision), move the model with --recentre, or choose a larger --cell");
  const std::string found = fmt::format("{} open edges, {} non-manifold edges, {} non-manifold points, {} degenerate facets, {} self-intersecting pairs",
                                        after.open_edges, after.non_manifold_edges, after.non_manifold_points,
                                        after.degenerate_facets, after.self_intersecting_pairs);
  return Error(ErrorCode::guarantee_unmet, "the result could not be verified as a valid solid: " + found,
               "try another --cell; --allow-invalid writes the result as it is");
}

void CleanedOutput::publish() {
  if (destination_ == "-") {
    file_->copy_to(STDOUT_FILENO, "standard output");
  } else {
    file_->commit();
  }
}

}  // namespace burnish
