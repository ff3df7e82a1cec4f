// What a cleaning run promises whatever the input: a solid that somebody else finds valid too, or a reason and no file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "burnish/pipeline/options.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish::test {

// A tiny model and what is asked of the run.
struct SmallJob {
  TriangleSoup soup;      // as read from bytes; may hold anything that a file may hold
  CleanOptions options;   // a coarse cell always, so that no run takes long
  bool double_precision = false;  // the output is PLY, not STL
};

// Any bytes make a job; few bytes make a small one: up to 40 facets between random points, or up to three boxes and tetrahedra
// with some facets turned over or left out. Points lie on a small lattice, so that touching, overlapping, one plane and no area
// abound; or anywhere. Bytes beyond a few hundred change nothing.
SmallJob small_job(const std::vector<std::uint8_t>& bytes);

// Runs the job from file to file in `folder`, which it leaves empty. Empty if all promises were kept, otherwise which was
// broken: errors are of the documented kinds, and never a bug of ours; what was verified and written reads back as a valid solid;
// what was not verified left no file.
std::string broken_promise(const SmallJob& job, const std::string& folder);

}  // namespace burnish::test
