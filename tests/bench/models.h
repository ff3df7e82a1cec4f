// The models that are measured, each made once.
#pragma once

#include <benchmark/benchmark.h>

#include "burnish/octree/grid_frame.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish::bench {

// As an STL file holds them: every facet with points of its own.
const TriangleSoup& nozzle_as_read();  // 496,658 facets
const TriangleSoup& knot_as_read();    // 76,428 facets

// Welded.
const TriangleSoup& nozzle();
const TriangleSoup& knot();

// A frame around the knot with 256 cells along its longest side, and the knot in its coordinates.
GridFrame knot_frame();
const TriangleSoup& lattice_knot();

inline constexpr double kBand = 3;

// What all have in common: milliseconds, CPU time over all threads.
inline void in_cpu_time(benchmark::internal::Benchmark* b) { b->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime(); }

}  // namespace burnish::bench
