// Deviation: how far two surfaces are from each other, measured at sample points.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

class TriangleIndex;

// Distances from samples of one surface to another surface, in model units.
struct OneSidedDistance {
  double max = 0;
  double mean = 0;
  double rms = 0;
  std::size_t samples = 0;
};

// Both directions. The symmetric Hausdorff distance of the samples is max(a_to_b.max, b_to_a.max).
struct Deviation {
  OneSidedDistance input_to_output;
  OneSidedDistance output_to_input;
};

struct CompareOptions {
  // Samples spread over the facets by area (stratified, deterministic), besides vertices.
  std::size_t area_samples = 60'000;
  // Vertices taken as samples, evenly spread over the point list; these find the extremes at corners.
  std::size_t vertex_samples = 60'000;
  // Samples farther away than this are listed, if a list is given.
  double far_beyond = std::numeric_limits<double>::infinity();
};

// A sample that the other surface is far from.
struct FarSample {
  Vec3 at;
  double distance = 0;
  std::uint32_t facet = 0;  // it lies on
  double area = 0;          // of the surface that it stands for; 0 for a vertex
};

// Samples `from` and measures each sample's exact distance to the surface behind `to`.
// mean and rms are over the area samples (so they do not depend on how finely `from` is cut into
// triangles), max over all samples. Same bits for any number of threads.
// `far`, if given, gets the samples beyond options.far_beyond. Of `progress`, only whether to stop is asked.
OneSidedDistance one_sided_distance(const TriangleSoup& from, const TriangleIndex& to, const CompareOptions& options = {},
                                    std::vector<FarSample>* far = nullptr, const Progress& progress = no_progress());

// A point of a surface, closest to some other point.
struct ClosestPoint {
  Vec3 point;
  double squared_distance = std::numeric_limits<double>::infinity();
  std::uint32_t facet = kNoFacet;
};

// Finds the closest point of a surface; called by several threads at once. What is behind it decides how exact a
// comparison is: a TriangleIndex, or an ExactDistance.
using ClosestQuery = std::function<ClosestPoint(const Vec3&)>;

// The percentiles that a Distribution tells.
inline constexpr std::array<double, 5> kPercentiles{50, 90, 95, 99, 99.9};

// How a quantity is distributed over samples.
struct Distribution {
  double max = 0;
  double mean = 0;
  double rms = 0;
  // percentiles[i]: the least value that kPercentiles[i] percent of the samples do not exceed.
  std::array<double, kPercentiles.size()> percentiles{};
  std::size_t samples = 0;
};

struct OneSidedComparison {
  // From samples to the other surface, in model units. As OneSidedDistance: the maximum is over all samples, everything
  // else over the area samples.
  Distribution distance;
  // Between the normal of a sample's facet and that of the closest facet, in degrees from 0 to 180; of area samples,
  // where both facets have an area. Near sharp edges either of two facets may be the closest.
  Distribution angle;
  Vec3 farthest;  // the first sample at the largest distance
  Vec3 opposite;  // the closest point to it
};

// The same samples as `one_sided_distance` takes, and more about them. `closest` asks `to`.
// Same bits for any number of threads. Memory: about 100 bytes a sample.
OneSidedComparison one_sided_comparison(const TriangleSoup& from, const TriangleSoup& to, const ClosestQuery& closest,
                                        const CompareOptions& options = {});

// What an area sample of one surface finds on another.
struct SampleError {
  Vec3 at;                    // the sample
  std::uint32_t facet = 0;    // it lies on
  ClosestPoint closest;       // on the other surface
  double angle = 0;           // between the normals of both facets, in degrees from 0 to 180; not a number where one of them has no area
};

// The area samples of `one_sided_comparison`, one by one. Same bits for any number of threads.
std::vector<SampleError> sample_errors(const TriangleSoup& from, const TriangleSoup& to, const ClosestQuery& closest,
                                       std::size_t samples);

// The same of the centroid of one facet.
SampleError error_at_centroid(const TriangleSoup& from, std::size_t facet, const TriangleSoup& to, const ClosestQuery& closest);

// The angle between two vectors in degrees, accurate near 0 and near 180. [T-COMP-3]
double angle_in_degrees(const Vec3& a, const Vec3& b);

// Components of one surface that another has nothing of.
struct MissingComponents {
  std::size_t count = 0;
  double area = 0;       // their facets' area together
  Vec3 largest_at;       // a point of the one with the largest area
};

// The components (of facets connected through shared points) of which no point is within `tolerance` of the other
// surface; up to 64 points of each are looked at. `welded`: as `weld` returns it.
MissingComponents missing_components(const TriangleSoup& welded, const TriangleIndex& other, double tolerance);

}  // namespace burnish
