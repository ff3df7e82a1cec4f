// How far a surface is from the truth that it should be: the error of its normals and its distance, near creases and elsewhere.
//
// A remesher, such as a level set, gives facets that correspond to none of the truth's, so nothing is compared facet by facet: samples of
// either surface, spread by area, are compared with the closest facet of the other one. Both ways count: what the result lacks shows only
// from the truth, what it has too much only from the result.
//
//   const CreaseEdges creases(truth, 30);
//   const TruthError error = truth_error(result, result_query, truth, truth_query, creases, {.near_crease = mean_edge_length(truth)});
//   error.all.angle(), error.all.rms(), error.near_creases.angle()
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "burnish/surface/compare.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// The edges of a surface at which it has a crease, as `find_creases` finds them, with an index to ask how near one is.
class CreaseEdges {
 public:
  // `welded`: as `weld` returns it, oriented. `degrees`: 0 to 180.
  CreaseEdges(const TriangleSoup& welded, double degrees);

  std::size_t count() const { return count_; }
  double length() const { return length_; }  // of all of them, in model units
  bool within(const Vec3& p, double distance) const;

 private:
  std::size_t count_ = 0;
  double length_ = 0;
  TriangleIndex index_;  // of triangles that are folded to an edge
};

// Of the samples of one surface; not a number where there are none.
struct ErrorFigures {
  std::size_t samples = 0;
  double angle = std::numeric_limits<double>::quiet_NaN();  // mean, between the normals of both facets, in degrees. [T-COMP-3]
  double rms = std::numeric_limits<double>::quiet_NaN();    // distance, in model units. [T-COMP-3]
};

// Of the samples of both.
struct TwoWayError {
  ErrorFigures there;  // from the result to the truth
  ErrorFigures back;   // from the truth to the result

  // The mean of both ways, and the root of the mean of both squares; of the one that has samples if only one has.
  double angle() const;
  double rms() const;
  bool empty() const { return there.samples + back.samples == 0; }
};

struct TruthError {
  TwoWayError all, near_creases, elsewhere;
};

struct TruthErrorOptions {
  std::size_t samples = 60'000;  // by area, of either surface
  double near_crease = 0;        // a sample is near a crease if the truth's point, of the two that are compared, is within this of one. [T-COMP-4]
};

// The error of `result`. `ask_result` and `ask_truth` find the closest points on either.
// Accuracy: a mean over n samples of a quantity of standard deviation s is off by about s / sqrt n; strata make it less. Of the models of
// docs/denoising.md, 60,000 samples give the angle to 0.07 degrees and the rms to 0.3 %. Same bits for any number of threads.
TruthError truth_error(const TriangleSoup& result, const ClosestQuery& ask_result, const TriangleSoup& truth,
                       const ClosestQuery& ask_truth, const CreaseEdges& creases, const TruthErrorOptions& options);

// The errors of facets, at their centroids, for pictures.
struct FacetErrors {
  std::vector<double> angle;     // degrees; not a number where there is none
  std::vector<double> distance;  // model units
};
FacetErrors facet_errors(const TriangleSoup& result, const TriangleSoup& truth, const ClosestQuery& ask_truth);

}  // namespace burnish
