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

TEST(Extraction, AnyNoiseOnAUniformOctree) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Engine engine(seed);
    const Octree tree = Octree::build(1, all_blocks(1));
    const Magnitudes kind = kMagnitudes[seed % kMagnitudes.size()];
    const double inside = std::array{0.02, 0.1, 0.3, 0.5, 0.9}[seed % 5];
    Noise noise{Engine(seed), inside, kind};
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    if (seed % 2) {
      EXPECT_EQ(flaws_of(closed_at_walls(level_set_of<double>(tree, noise))), "");
    } else {
      EXPECT_EQ(flaws_of(closed_at_walls(level_set_of<float>(tree, noise))), "");
    }
  }
}

TEST(Extraction, AnyNoiseAcrossLevelJumps) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Engine engine(seed);
    const int depth = seed % 3 ? 2 : 3;
    const Octree tree = random_octree(engine, depth, 1 + engine() % 6);
    const Magnitudes kind = kMagnitudes[seed % kMagnitudes.size()];
    const double inside = std::array{0.01, 0.03, 0.1}[engine() % 3];
    Noise noise{Engine(seed), inside, kind};
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    if (seed % 2) {
      EXPECT_EQ(flaws_of(closed_at_walls(level_set_of<double>(tree, noise))), "");
    } else {
      EXPECT_EQ(flaws_of(closed_at_walls(level_set_of<float>(tree, noise))), "");
    }
  }
}

TEST(Extraction, SmoothFieldsOnAnyOctree) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Engine engine(seed);
    const Octree tree = seed % 2 ? Octree::build(1, all_blocks(1)) : random_octree(engine, 3, 1 + engine() % 8);
    const Waves waves(engine, uniform(engine, 3, 16));
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    EXPECT_EQ(flaws_of(closed_at_walls(level_set_of<double>(tree, waves))), "");
    // In steps of a quarter: exact zeros at nodes, crossings at equal distances, plateaus.
    const auto in_steps = [&](const LatticeNode& n) { return std::round(4 * waves(n)) / 4; };
    EXPECT_EQ(flaws_of(closed_at_walls(level_set_of<float>(tree, in_steps))), "");
  }
}

// A leaf has 8 cells a side, so a cell meets finer leaves through at most three faces, one an axis, and the edges and
// the corner between them. All of these: each corner of a leaf, each choice among the seven leaves around that corner.
TEST(Extraction, EverySplitOfATransitionCell) {
  std::size_t transition_cells = 0;
  for (int corner = 0; corner < 8; ++corner)
    for (unsigned finer = 1; finer < 128; ++finer) {
      const auto toward = [&](int axis) { return corner >> axis & 1 ? 1 : -1; };
      std::vector<std::uint64_t> finest;
      for (int k = 1; k < 8; ++k) {
        if (!(finer >> (k - 1) & 1)) continue;
        const auto octant = [&](int axis) { return static_cast<std::uint32_t>(1 + (k >> axis & 1 ? toward(axis) : 0)); };
        finest.push_back(morton::interleave({2 * octant(0), 2 * octant(1), 2 * octant(2)}));
      }
      const Octree tree = Octree::build(3, finest);
      const std::array<int, 3> at{corner & 1 ? 32 : 16, corner & 2 ? 32 : 16, corner & 4 ? 32 : 16};
      ASSERT_EQ(tree.level(tree.find({2, 2, 2})), 1);
      for (std::uint64_t round = 0; round < 4; ++round) {
        const std::uint64_t seed = round + 4 * (finer + 128 * static_cast<std::uint64_t>(corner));
        Noise noise{Engine(seed), round % 2 ? 0.5 : 0.2, kMagnitudes[seed % kMagnitudes.size()]};
        const auto near_corner = [&](const LatticeNode& n) {
          const bool near = std::abs(n.x - at[0]) <= 2 && std::abs(n.y - at[1]) <= 2 && std::abs(n.z - at[2]) <= 2;
          return near ? noise(n) : -1.0;
        };
        const auto set = level_set_of<double>(tree, near_corner);
        SCOPED_TRACE(::testing::Message() << "corner " << corner << " finer " << finer << " seed " << seed);
        for (const bool snap : {false, true}) {
          const ExtractedSurface surface = extract_surface(set, {.snap = snap});
          EXPECT_EQ(flaws_of(surface.soup), "");
          transition_cells += surface.transition_cells;
        }
      }
    }
  EXPECT_GT(transition_cells, 10'000u);
}

// The sides of a node's 14 neighbours in all 2^14 ways, the node itself close to all its crossings: all answers to
// whether the surface around a moved node is one disc.
TEST(Extraction, EveryStarOfANodeThatWantsToMove) {
  constexpr std::array<std::array<int, 3>, 14> kSteps{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1},
                                                       {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {-1, -1, 0}, {-1, 0, -1}, {0, -1, -1},
                                                       {-1, -1, -1}}};
  constexpr int kTiles = 7;  // a side, of 4 nodes each; the node at the middle of its tile
  const Octree tree = Octree::build(2, all_blocks(2));
  for (unsigned first = 0; first < 1u << 14; first += kTiles * kTiles * kTiles) {
    Engine engine(first);
    const auto value = [&](const LatticeNode& n) {
      const std::array<int, 3> tile{n.x / 4, n.y / 4, n.z / 4}, at{n.x % 4 - 2, n.y % 4 - 2, n.z % 4 - 2};
      if (std::max({tile[0], tile[1], tile[2]}) >= kTiles) return -1.0;
      const unsigned pattern = first + static_cast<unsigned>(tile[0] + kTiles * (tile[1] + kTiles * tile[2]));
      if (at == std::array{0, 0, 0}) return engine() % 2 ? 1e-3 : -1e-3;
      const auto step = std::find(kSteps.begin(), kSteps.end(), at);
      if (step == kSteps.end()) return -1.0;
      const double size = engine() % 4 ? 1 : 0.1;
      return pattern >> (step - kSteps.begin()) & 1 ? size : -size;
    };
    SCOPED_TRACE(::testing::Message() << "patterns from " << first);
    EXPECT_EQ(flaws_of(extract_surface(level_set_of<double>(tree, value)).soup), "");
  }
}

// One cell with its 8 corners in all 2^8 ways, zeros and near zeros among them.
TEST(Extraction, EveryCell) {
  constexpr int kTiles = 7;
  const Octree tree = Octree::build(2, all_blocks(2));
  for (std::uint64_t round = 0; round < 8; ++round) {
    Engine engine(round);
    const auto value = [&](const LatticeNode& n) {
      const std::array<int, 3> tile{n.x / 4, n.y / 4, n.z / 4}, at{n.x % 4 - 1, n.y % 4 - 1, n.z % 4 - 1};
      const int number = tile[0] + kTiles * (tile[1] + kTiles * tile[2]);
      const double size = round == 0 ? 1 : magnitude(engine, kMagnitudes[round % kMagnitudes.size()]);
      if (std::max({tile[0], tile[1], tile[2]}) >= kTiles) return -1.0;
      if (std::min({at[0], at[1], at[2]}) < 0 || std::max({at[0], at[1], at[2]}) > 1) return -1.0;
      return number >> (at[0] + 2 * at[1] + 4 * at[2]) & 1 ? size : -size;
    };
    SCOPED_TRACE(::testing::Message() << "round " << round);
    EXPECT_EQ(flaws_of(level_set_of<double>(tree, value)), "");
  }
}

TEST(Extraction, ThinSheetsOfOneNodeAndOfZero) {
  const Octree tree = Octree::build(1, all_blocks(1));
  for (const double value : {0.0, 1e-30, 1e-3, 1.0, 1e30}) {
    const auto sheet = [&](const LatticeNode& n) { return n.x == 7 ? value : -1.0; };
    const auto gap = [&](const LatticeNode& n) { return n.x == 7 ? -1.0 : value; };
    const auto slope = [&](const LatticeNode& n) { return n.x + n.y - n.z == 7 ? value : -1.0; };
    const auto grid = [&](const LatticeNode& n) { return n.x % 2 && n.y % 2 ? value : -1.0; };
    const auto chessboard = [&](const LatticeNode& n) { return (n.x + n.y + n.z) % 2 ? value : -1.0; };
    SCOPED_TRACE(::testing::Message() << "value " << value);
    EXPECT_EQ(flaws_of(closed_at_walls(level_set_of<double>(tree, sheet))), "");
    EXPECT_EQ(flaws_of(closed_at_walls(level_set_of<double>(tree, gap))), "");
    EXPECT_EQ(flaws_of(closed_at_walls(level_set_of<double>(tree, slope))), "");
    EXPECT_EQ(flaws_of(closed_at_walls(level_set_of<double>(tree, grid))), "");
    EXPECT_EQ(flaws_of(closed_at_walls(level_set_of<double>(tree, chessboard))), "");
  }
}

// Lattice coordinates of a million: rounding of the crossings is 2^20 times as coarse as near the origin.
TEST(Extraction, FarFromTheLatticesOrigin) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Engine engine(seed);
    const auto block = [&] { return static_cast<std::uint32_t>((1u << 17) - 9 + engine() % 4); };
    const morton::Position p{block(), block(), block()};
    const Octree tree = Octree::build(17, {morton::interleave(p)});
    const auto at = [](std::uint32_t b) { return static_cast<int>(b) * kBlockSide; };
    Noise noise{Engine(seed), 0.2, kMagnitudes[seed % kMagnitudes.size()]};
    const auto near_block = [&](const LatticeNode& n) {
      const bool near = std::abs(n.x - at(p.x) - 4) < 8 && std::abs(n.y - at(p.y) - 4) < 8 && std::abs(n.z - at(p.z) - 4) < 8;
      return near ? noise(n) : -1.0;
    };
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    EXPECT_EQ(flaws_of(level_set_of<double>(tree, near_block)), "");
  }
}

TEST(Extraction, PlainNodesKeepTheSurfaceClosed) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Engine engine(seed);
    const Octree tree = seed % 2 ? Octree::build(1, all_blocks(1)) : random_octree(engine, 3, 4);
    const auto set = closed_at_walls(level_set_of<float>(tree, Waves(engine, 5)));
    const ExtractedSurface first = extract_surface(set);
    PlainNodes plain;
    if (first.origins.empty()) {  // transition cells: mark nodes at random instead
      plain.marked = Field<std::uint8_t>(tree.size(), 0);
      for (std::uint8_t& mark : plain.marked.values) mark = engine() % 8 == 0;
    } else {
      ASSERT_EQ(first.origins.size(), first.soup.points.size());
      for (int round = 0; round < 10; ++round) mark_plain(tree, {first.origins[engine() % first.origins.size()]}, plain);
    }
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    for (const bool snap : {false, true})
      EXPECT_EQ(flaws_of(extract_surface(set, {.snap = snap, .plain = &plain}).soup), "");
  }
}

// A marked vertex' surroundings are all midpoints of edges.
TEST(Extraction, PlainVerticesAreMidpoints) {
  Engine engine(3);
  const auto set = closed_at_walls(level_set_of<float>(Octree::build(1, all_blocks(1)), Waves(engine, 6)));
  const ExtractedSurface first = extract_surface(set);
  PlainNodes plain;
  mark_plain(set.octree(), first.origins, plain);
  const ExtractedSurface second = extract_surface(set, {.snap = true, .plain = &plain});
  ASSERT_FALSE(second.soup.points.empty());
  for (const Vec3& p : second.soup.points)
    for (const double x : {p.x, p.y, p.z}) EXPECT_EQ(2 * x, std::floor(2 * x));
}

TEST(Extraction, UnsnappedSurfaceEnclosesTheVolumeOfTheField) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Engine engine(seed);
    const Octree tree = Octree::build(1, all_blocks(1));
    Noise noise{Engine(seed), uniform(engine, 0.05, 0.95), Magnitudes::even};
    const auto check = [&](const auto& set) {
      const double volume = enclosed_volume(set);
      EXPECT_NEAR(signed_volume(extract_surface(set, {.snap = false}).soup), volume, 1e-9 * volume);
    };
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    check(closed_at_walls(level_set_of<double>(tree, noise)));
    check(closed_at_walls(level_set_of<float>(tree, noise)));
  }
}

TEST(Extraction, SameBitsForAnyNumberOfThreads) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Engine engine(seed);
    const Octree tree = seed % 2 ? Octree::build(2, all_blocks(2)) : random_octree(engine, 4, 20);
    const auto set = closed_at_walls(level_set_of<float>(tree, Waves(engine, 8)));
    const auto with_threads = [&](int threads) {
      const ThreadLimit limit(threads);
      return extract_surface(set);
    };
    const ExtractedSurface one = with_threads(1), four = with_threads(4);
    EXPECT_TRUE(same_bits(one.soup, four.soup)) << "seed " << seed;
    EXPECT_EQ(one.transition_cells, four.transition_cells);
  }
}

TEST(Extraction, NothingWithoutASignChange) {
  Engine engine(1);
  for (const double value : {-1.0, 1.0, 0.0, -1e-30}) {
    const auto constant = [&](const LatticeNode&) { return value; };
    for (const bool snap : {false, true}) {
      EXPECT_TRUE(extract_surface(level_set_of<float>(Octree(), constant), {.snap = snap}).soup.facets.empty());
      EXPECT_TRUE(extract_surface(level_set_of<double>(random_octree(engine, 3, 5), constant), {.snap = snap}).soup.facets.empty());
    }
  }
}

struct SphereErrors {
  double volume = 0, distance = 0, normal = 0;  // relative; worst in cells; mean in radians
};

SphereErrors sphere_errors(double radius, bool snap) {
  int depth = 0;
  while ((8 << depth) < 2 * radius + 6) ++depth;
  const Vec3 c{(4 << depth) + 0.371, (4 << depth) + 0.413, (4 << depth) + 0.297};
  const auto set = level_set_of<double>(Octree::build(depth, all_blocks(depth)),
                                        [&](const LatticeNode& n) { return radius - norm(to_vec(n) - c); });
  const TriangleSoup soup = extract_surface(set, {.snap = snap}).soup;
  SphereErrors errors;
  const double exact = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  errors.volume = std::abs(signed_volume(soup) / exact - 1);
  for (const Vec3& p : soup.points) errors.distance = std::max(errors.distance, std::abs(norm(p - c) - radius));
  double weight = 0;
  for (std::size_t f = 0; f < soup.facets.size(); ++f) {
    const Vec3 n = facet_normal_2a(soup, f), out = (soup.corner(f, 0) + soup.corner(f, 1) + soup.corner(f, 2)) / 3 - c;
    errors.normal += norm(n) * std::atan2(norm(cross(n, out)), dot(n, out));
    weight += norm(n);
  }
  errors.normal /= weight;
  return errors;
}

// Volume with order 2, in cells vertices with order 1 (h^2 in the unit of the radius), facet normals with order 1: a chord's.
TEST(Extraction, SphereConverges) {
  for (const bool snap : {false, true}) {
    const SphereErrors coarse = sphere_errors(14, snap), fine = sphere_errors(28, snap);
    RecordProperty(snap ? "snapped" : "unsnapped", std::to_string(fine.volume));
    EXPECT_NEAR(std::log2(coarse.volume / fine.volume), 2, 0.2) << "snap " << snap;
    EXPECT_NEAR(std::log2(coarse.distance / fine.distance), 1, 0.35) << "snap " << snap;
    EXPECT_NEAR(std::log2(coarse.normal / fine.normal), 1, 0.1) << "snap " << snap;
    EXPECT_LT(fine.volume, 1.5e-3);
    EXPECT_LT(fine.distance, 0.02);
    EXPECT_LT(fine.normal, 0.02);
  }
}

// The vertices that stay crossings lie where the field, linear along the edge, is zero; moved nodes too.
TEST(Extraction, PlaneIsExact) {
  const Vec3 n{0.36, 0.48, 0.8};
  const auto set = level_set_of<double>(Octree::build(1, all_blocks(1)),
                                        [&](const LatticeNode& at) { return dot(n, to_vec(at) - Vec3{7.5, 7.5, 7.5}); });
  for (const bool snap : {false, true}) {
    double worst = 0;
    for (const Vec3& p : extract_surface(set, {.snap = snap}).soup.points) worst = std::max(worst, std::abs(dot(n, p - Vec3{7.5, 7.5, 7.5})));
    EXPECT_LT(worst, 0.02 * std::sqrt(3.0));  // crossings keep 2 % of their edge from its ends
  }
}

}  // namespace
}  // namespace burnish
