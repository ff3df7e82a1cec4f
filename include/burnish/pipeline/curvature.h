// Curvature of a model's surface: of the level set that stands for it, at points of the extracted surface or at the input's own.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/levelset/curvature.h"
#include "burnish/pipeline/options.h"
#include "burnish/pipeline/report.h"

namespace burnish {

// Where curvatures are taken: at the vertices of
enum class CurvaturePoints {
  surface,   // the surface that the level set encloses, by marching tetrahedra
  vertices,  // the input's facets, as far as they are part of the solid's surface
};

enum class CurvatureMethod {
  front,  // derivatives at the foot on the surface (levelset/curvature.h)
  nodal,  // the curvature of the level sets through the nodes, interpolated: of first order, for comparison; the mean curvature only
};

std::string_view name(CurvaturePoints points);  // "surface", "vertices"
std::string_view name(CurvatureMethod method);  // "front", "nodal"

struct CurvatureJob {
  std::string input;     // a path, or "-" for standard input
  std::string output;    // a .vtp or .ply; empty: nothing is written
  CleanOptions options;  // those of preparation, resolution and smoothing; without bound on the deviation, coarser cells or shells
  CurvatureOrder order = CurvatureOrder::fourth;
  CurvaturePoints at = CurvaturePoints::surface;
  CurvatureMethod method = CurvatureMethod::front;
  std::size_t check = 0;   // points at which curvatures are compared with those of a fit that shares nothing with them
  bool salvage = false;    // take what a broken input file holds
  bool overwrite = false;  // an existing output may be replaced
};

// How values are spread: over the extracted surface every point weighs a third of the area of its facets; of the input's vertices all weigh the same.
inline constexpr std::array<double, 5> kCurvaturePercentiles{1, 5, 50, 95, 99};
struct CurvatureSpread {
  double min = 0, max = 0, mean = 0;
  std::array<double, kCurvaturePercentiles.size()> percentiles{};
  double p50() const { return percentiles[2]; }
};

// A radius of curvature, and the point that has it.
struct CurvatureRadius {
  double radius = 0;
  Vec3 position;
};

// Of the points that have a curvature. Lengths in model units; positive where the solid is convex: a ball of radius R has a mean curvature of 1/R.
struct CurvatureSummary {
  std::size_t points = 0;
  std::size_t determined = 0;          // of them
  std::size_t lower_order = 0;         // of these, by stencils of a lower order than was asked for
  std::size_t facets = 0;
  double area = 0;                     // of these facets: with CurvaturePoints::vertices of the input's, whatever smoothing did
  CurvatureSpread mean;
  // Not at the input's vertices: samples of a surface whose area theirs is not.
  std::optional<double> determined_area, mean_integral;  // the integral is of a convex body 2 pi times its mean width
  // Not by the nodal method.
  std::optional<CurvatureSpread> gaussian, k1, k2;
  std::optional<double> gaussian_integral;           // nor at the input's vertices
  std::optional<CurvatureRadius> convex, concave;  // the smallest ones; unset: nothing is
  std::optional<std::int64_t> euler_characteristic;  // of a closed surface: 2 pi times that is the integral of the Gaussian curvature (Gauss, Bonnet)
  double mean_edge = 0;                // of the input
};

// Curvatures against those of polynomials fitted to the surface around the points (quadric_curvature), as |difference| of k1 and of k2 in 1 / model unit.
struct CurvatureCheck {
  std::size_t points = 0;  // that have both
  double rms = 0, median = 0, max = 0;
  double rms_curvature = 0;  // of what was compared, to judge the differences by
  Vec3 worst;
};

struct CurvatureFile {
  std::string file;  // empty: none was asked for
  std::string format;
  bool written = false;
  std::uint64_t bytes = 0;
};

struct CurvatureResult {
  std::string input;
  std::string input_format;
  std::optional<ModelUnit> unit;  // of the model's coordinates: as the job says, or else as the file does; empty: neither does
  std::vector<std::string> warnings;
  ResolvedOptions options;
  CurvatureOrder order = CurvatureOrder::fourth;
  CurvaturePoints at = CurvaturePoints::surface;
  CurvatureMethod method = CurvatureMethod::front;
  double band = 0;   // cells
  Defects before;    // of the input
  GridSummary grid;
  SmoothingSummary smoothing;
  CurvatureSummary curvature;
  std::optional<CurvatureCheck> check;
  CurvatureFile output;
  std::optional<Error> failure;  // the input bounds no solid, or nothing is left of it
  std::vector<StageCost> stages;
};

// Reads, inspects and prepares the input and builds its level set as `field` does, with a band as wide as curvatures need; smooths it if asked to, and
// takes curvatures. The surface of facets is flat but for its edges: unsmoothed, curvatures are those of edges rounded within cells. The input's
// vertices are projected to the surface first, however far smoothing has moved it within the room that it needs (room_for_smoothing).
//
// Warnings tell of components that the surface has nothing of, of points without a curvature, and of integrals that are far off.
//
// The file (io/point_data.h; docs/formats.md) holds the surface with mean_curvature, gaussian_curvature, k1, k2, direction1, direction2, normal and
// converged at its points; in a .ply the mean curvature is called quality.
//
// An input that bounds no solid comes back as `failure`. Throws Error as `field` does, and Error{usage} for nodal curvatures of sixth order.
// Same bytes for any number of threads.
CurvatureResult curvature(const CurvatureJob& job, Progress& progress = no_progress());

// The result as JSON text, as docs/curvature.schema.json says: what `burnish curvature --json` prints.
std::string to_json(const CurvatureResult& result);

}  // namespace burnish
