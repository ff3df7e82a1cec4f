// The promise of the extraction: whatever the field and the octree, the surface is closed, 2-manifold, oriented from
// inside to outside, and does not intersect itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <tuple>

#include "burnish/core/parallel.h"
#include "burnish/extract/marching_tetrahedra.h"
#include "burnish/levelset/volume.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/weld.h"
#include "support/level_sets.h"

namespace burnish {
namespace {

using namespace test;

// Everything that keeps a surface from being a valid solid, in words; empty for a valid solid or no surface at all.
std::string flaws_of(const TriangleSoup& extracted) {
  if (extracted.facets.empty()) return "";
  const TriangleSoup soup = weld(extracted);
  const Defects d = inspect(soup).defects;
  std::string flaws;
  const auto add = [&](const char* what, std::size_t count) {
    if (count > 0) flaws += std::to_string(count) + ' ' + what + "; ";
  };
  add("points welded away", extracted.points.size() > soup.points.size() ? extracted.points.size() - soup.points.size() : 0);
  add("degenerate facets", d.degenerate_facets);
  add("duplicate facets", d.duplicate_facets);
  add("open edges", d.open_edges);
  add("non-manifold edges", d.non_manifold_edges);
  add("non-manifold points", d.non_manifold_points);
  add("misoriented edges", d.misoriented_edges);
  add("self-intersecting pairs", d.self_intersecting_pairs);
  if (!(d.volume > 0)) flaws += "volume " + std::to_string(d.volume);
  return flaws;
}

template <class T>
std::string flaws_of(const BasicLevelSet<T>& set) {
  std::string flaws;
  for (const bool snap : {false, true}) {
    const std::string found = flaws_of(extract_surface(set, {.snap = snap}).soup);
    if (!found.empty()) flaws += (snap ? "snapped: " : "not snapped: ") + found;
  }
  return flaws;
}

using Engine = std::mt19937_64;

double uniform(Engine& engine, double low, double high) {
  return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
}

// Ways to draw a node's magnitude: from well-behaved to hostile.
enum class Magnitudes { even, wide, equal, half_zero, tiny, few };
constexpr std::array kMagnitudes{Magnitudes::even, Magnitudes::wide, Magnitudes::equal,
                                 Magnitudes::half_zero, Magnitudes::tiny, Magnitudes::few};

double magnitude(Engine& engine, Magnitudes kind) {
  switch (kind) {
    case Magnitudes::even: return uniform(engine, 0.05, 1);
    case Magnitudes::wide: return std::pow(10.0, uniform(engine, -30, 1));
    case Magnitudes::equal: return 1;
    case Magnitudes::half_zero: return engine() % 2 ? 0 : uniform(engine, 0, 1);
    case Magnitudes::tiny: return engine() % 2 ? 1e-30 : 1;
    case Magnitudes::few: return std::array{0.25, 0.5, 1.0, 3.0}[engine() % 4];
  }
  return 1;
}

struct Noise {
  Engine engine;
  double inside;  // the part of the nodes
  Magnitudes kind;
  double operator()(const LatticeNode&) {
    const bool in = uniform(engine, 0, 1) < inside;
    const double size = magnitude(engine, kind);
    return in ? size : -size;
  }
};

// A few random plane waves: smooth surfaces with handles, sheets and drops.
class Waves {
 public:
  Waves(Engine& engine, double shortest) {
    for (Wave& w : waves_) {
      const double k = 2 * std::numbers::pi / uniform(engine, shortest, 4 * shortest);
      const Vec3 d{uniform(engine, -1, 1), uniform(engine, -1, 1), uniform(engine, -1, 1)};
      w = {d * (k / norm(d)), uniform(engine, 0, 7), 1 / k};
    }
  }
  double operator()(const LatticeNode& n) const {
    double sum = 0;
    for (const Wave& w : waves_) sum += w.size * std::sin(dot(w.k, to_vec(n)) + w.phase);
    return sum;
  }

 private:
  struct Wave {
    Vec3 k;
    double phase, size;
  };
  std::array<Wave, 6> waves_;
};

Octree random_octree(Engine& engine, int depth, std::size_t finest_blocks) {
  std::vector<std::uint64_t> finest;
  for (std::size_t i = 0; i < finest_blocks; ++i) finest.push_back(engine() % (std::uint64_t{1} << (3 * depth)));
  return Octree::build(depth, finest);
}

bool same_bits(const TriangleSoup& a, const TriangleSoup& b) {
  return a.points.size() == b.points.size() && a.facets == b.facets &&
         std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof(Vec3)) == 0;
}
