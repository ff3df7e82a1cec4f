// Mean-curvature flow of a sphere, as one line of JSON a method: the stable steps of `smooth` and the explicit ones of
// `mean_curvature_flow`; beside the line of a peer (peers/openvdb_flow) it is a comparison.
//
//   burnish_flow [radius in cells] [time in sixths of a cell squared]
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "burnish/levelset/smooth/mean_curvature_flow.h"
#include "burnish/levelset/smooth/smoothing.h"
#include "support/analytic_level_set.h"

namespace burnish::bench {
namespace {

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

std::size_t nodes_within(const LevelSet& set, float distance) {
  const auto& phi = set.phi.values();
  return static_cast<std::size_t>(std::count_if(phi.begin(), phi.end(), [&](float v) { return std::abs(v) < distance; }));
}

// What linear crossings make of a ball of this radius.
double radius_by_crossings(double radius) {
  const test::Ball<float> ball = test::analytic_ball<float>(radius, {0.31, 0.77, 0.13}, kFlowBand);
  return test::mean_radius(ball.set, ball.center);
}

template <class Flow>
void measure(const char* method, double radius, double time, Flow&& flow) {
  const double exact = std::sqrt(radius * radius - 4 * time);
  test::Ball<float> ball = test::analytic_ball<float>(radius, {0.31, 0.77, 0.13}, kFlowBand + 1 + radius - exact);
  ball.set = test::stored_near_surface(ball.set, kFlowBand);
  const std::size_t within_3 = nodes_within(ball.set, 3), within_5 = nodes_within(ball.set, kFlowBand);
  const double start = cpu_seconds();
  const int steps = flow(ball.set);
  const double seconds = cpu_seconds() - start;
  const double found = test::mean_radius(ball.set, ball.center);
  std::printf("{\"program\":\"burnish\",\"method\":\"%s\",\"radius\":%g,\"time\":%.4f,\"steps\":%d,\"nodes_within_3\":%zu,\"nodes_within_5\":%zu,\"cpu_s\":%.4f,"
              "\"ns_per_node\":%.0f,\"ns_per_node_within_5\":%.0f,\"radius_error\":%.3e,\"error_of_flow\":%.3e}\n",
              method, radius, time, steps, within_3, within_5, seconds, 1e9 * seconds / static_cast<double>(within_3),
              1e9 * seconds / static_cast<double>(within_5), found / exact - 1, found / radius_by_crossings(exact) - 1);
}

}  // namespace
}  // namespace burnish::bench

int main(int argc, char** argv) {
  using namespace burnish;
  const double radius = argc > 1 ? std::atof(argv[1]) : 51.2, time = (argc > 2 ? std::atof(argv[2]) : 10) / 6;
  bench::measure("smooth", radius, time, [&](LevelSet& set) {
    SmoothingOptions options;
    options.mode = FlowMode::mcf;
    options.length = std::sqrt(time / flow_time_for(FlowMode::mcf, 1));
    options.keep_volume = false;
    return smooth(set, options).steps;
  });
  bench::measure("explicit", radius, time, [&](LevelSet& set) { return mean_curvature_flow(set, time).steps; });
}
