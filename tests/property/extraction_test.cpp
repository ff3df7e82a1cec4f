// The promise of the extraction: whatever the field and the octree, the surface is closed, 2-manifold, oriented from
// inside to outside, and does not intersect itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/extract/marching_tetrahedra.h"
#include "burnish/levelset/volume.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/weld.h"
#include "support/level_sets.h"
#include "support/repetitions.h"

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

// `field` within the domain, outside near its walls: the surface stays two cells away from them.
template <class Value>
auto away_from_walls(Value field, int depth) {
  return [field, last = (kBlockSide << depth) - 1](const LatticeNode& n) {
    const int wall = std::min({n.x, n.y, n.z, last - n.x, last - n.y, last - n.z});
    return std::min(field(n), wall - 2.5);
  };
}

bool same_bits(const TriangleSoup& a, const TriangleSoup& b) {
  return a.points.size() == b.points.size() && a.facets == b.facets &&
         std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof(Vec3)) == 0;
}

TEST(Extraction, AnyNoiseOnAUniformOctree) {
  for (std::uint64_t seed = 1; seed <= repetitions(36, 12); ++seed) {
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
  for (std::uint64_t seed = 1; seed <= repetitions(18, 6); ++seed) {
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
  for (std::uint64_t seed = 1; seed <= repetitions(12, 4); ++seed) {
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
// the corner between them. All of these, at all eight corners of a leaf: bit (|dx| + 2 |dy| + 4 |dz|) - 1 of the mask
// says whether the neighbours in the directions (dx, dy, dz) are finer. Under sanitizers each with one of the two noises.
TEST(Extraction, EverySplitOfATransitionCell) {
  constexpr std::uint64_t kRounds = repetitions(2, 1);
  std::size_t transition_cells = 0;
  for (unsigned finer = 1; finer < 128; ++finer) {
    std::vector<std::uint64_t> finest;
    for (int dir = 0; dir < kDirections; ++dir) {
      const auto d = offset_of(dir);
      const auto octant = [&](std::size_t axis) { return static_cast<std::uint32_t>(1 + d[axis]); };
      if (dir != kSelf && finer >> (std::abs(d[0]) + 2 * std::abs(d[1]) + 4 * std::abs(d[2]) - 1) & 1)
        finest.push_back(morton::interleave({2 * octant(0), 2 * octant(1), 2 * octant(2)}));
    }
    const Octree tree = Octree::build(3, finest);
    ASSERT_EQ(tree.level(tree.find({2, 2, 2})), 1);
    for (std::uint64_t first = 0; first < kRounds; ++first) {
      const std::uint64_t round = kRounds == 2 ? first : finer % 2, seed = 2 * finer + round;
      Noise noise{Engine(seed), round ? 0.5 : 0.2, kMagnitudes[seed % kMagnitudes.size()]};
      // Around the corners of the leaf from 16 to 32.
      const auto near = [](int x) { return std::abs(x - 16) <= 2 || std::abs(x - 32) <= 2; };
      const auto near_corners = [&](const LatticeNode& n) { return near(n.x) && near(n.y) && near(n.z) ? noise(n) : -1.0; };
      const auto set = level_set_of<double>(tree, near_corners);
      SCOPED_TRACE(::testing::Message() << "finer " << finer << " seed " << seed);
      for (const bool snap : {false, true}) {
        const ExtractedSurface surface = extract_surface(set, {.snap = snap});
        EXPECT_EQ(flaws_of(surface.soup), "");
        transition_cells += surface.transition_cells;
      }
    }
  }
  EXPECT_GT(transition_cells, kRounds * 25'000u);
}

// The sides of a node's 14 neighbours in all 2^14 ways, the node itself close to all its crossings: all answers to
// whether the surface around a moved node is one disc. Under sanitizers a quarter of them.
TEST(Extraction, EveryStarOfANodeThatWantsToMove) {
  constexpr std::array<std::array<int, 3>, 14> kSteps{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1},
                                                       {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {-1, -1, 0}, {-1, 0, -1}, {0, -1, -1},
                                                       {-1, -1, -1}}};
  constexpr int kTiles = 7;  // a side, of 4 nodes each; the node at the middle of its tile
  const Octree tree = Octree::build(2, all_blocks(2));
  for (unsigned first = 0; first < 1u << 14; first += kTiles * kTiles * kTiles * static_cast<unsigned>(repetitions(1, 4))) {
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
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Engine engine(seed);
    const Octree tree = seed % 2 ? Octree::build(1, all_blocks(1)) : random_octree(engine, 3, 4);
    const auto set = closed_at_walls(level_set_of<float>(tree, away_from_walls(Waves(engine, 5), tree.depth())));
    const ExtractedSurface first = extract_surface(set);
    PlainNodes plain;
    ASSERT_EQ(first.origins.size(), first.soup.points.size());
    for (int round = 0; round < 10; ++round) mark_plain(tree, {first.origins[engine() % first.origins.size()]}, plain);
    if (seed % 4 < 2)  // and nodes at random
      for (std::uint8_t& mark : plain.marked.values()) mark |= engine() % 8 == 0;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    for (const bool snap : {false, true})
      EXPECT_EQ(flaws_of(extract_surface(set, {.snap = snap, .plain = &plain}).soup), "");
  }
}

// A marked vertex' surroundings are all midpoints of edges.
TEST(Extraction, PlainVerticesAreMidpoints) {
  Engine engine(3);
  const auto set = level_set_of<float>(Octree::build(1, all_blocks(1)), away_from_walls(Waves(engine, 6), 1));
  const ExtractedSurface first = extract_surface(set);
  ASSERT_FALSE(first.origins.empty());
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

// Volume with order 2, facet normals with order 1: a chord's. Vertices are off by the curvature along an edge, 3 / (8 R)
// cells, and where a crossing keeps from the end of its edge, by 2 % of the edge.
TEST(Extraction, SphereConverges) {
  for (const bool snap : {false, true}) {
    const SphereErrors coarse = sphere_errors(14, snap), fine = sphere_errors(28, snap);
    RecordProperty(snap ? "snapped" : "unsnapped", std::to_string(fine.volume));
    EXPECT_NEAR(std::log2(coarse.volume / fine.volume), 2, 0.2) << "snap " << snap;
    EXPECT_LT(coarse.distance, 3 / (8 * 14.0) + 0.02 * std::sqrt(3.0));
    EXPECT_NEAR(std::log2(coarse.normal / fine.normal), 1, 0.1) << "snap " << snap;
    EXPECT_LT(fine.volume, 1.5e-3);
    EXPECT_LT(fine.distance, 3 / (8 * 28.0) + 0.02 * std::sqrt(3.0));
    EXPECT_LT(fine.normal, 0.02);
  }
}

double smallest_angle(const TriangleSoup& soup, std::size_t f) {
  double least = 180;
  for (int i = 0; i < 3; ++i) {
    const Vec3 a = soup.corner(f, (i + 1) % 3) - soup.corner(f, i), b = soup.corner(f, (i + 2) % 3) - soup.corner(f, i);
    least = std::min(least, std::atan2(norm(cross(a, b)), dot(a, b)) * 180 / std::numbers::pi);
  }
  return least;
}

TEST(Extraction, MovedNodesLeaveNoSlivers) {
  const Vec3 c{32.371, 32.413, 32.297};
  const auto set = level_set_of<float>(Octree::build(3, all_blocks(3)), [&](const LatticeNode& n) { return 25 - norm(to_vec(n) - c); });
  const TriangleSoup soup = extract_surface(set).soup;
  std::vector<double> angles;
  for (std::size_t f = 0; f < soup.facets.size(); ++f) angles.push_back(smallest_angle(soup, f));
  std::sort(angles.begin(), angles.end());
  EXPECT_GT(angles.front(), 7);
  EXPECT_GT(angles[angles.size() / 100], 12);
  EXPECT_GT(angles[angles.size() / 2], 35);
}

// Moved nodes lie where the field, linear along an edge, is zero, and so do crossings in the inner 96 % of their edges.
TEST(Extraction, PlaneIsExactButForCrossingsKeptFromNodes) {
  const Vec3 n{0.36, 0.48, 0.8}, middle{7.51, 7.52, 7.53};
  const auto set = level_set_of<double>(Octree::build(1, all_blocks(1)),
                                        [&](const LatticeNode& at) { return dot(n, to_vec(at) - middle); });
  for (const bool snap : {false, true}) {
    double worst = 0;
    std::size_t exact = 0, seen = 0;
    for (const Vec3& p : extract_surface(set, {.snap = snap}).soup.points) {
      if (std::max({p.x, p.y, p.z}) > 13 || std::min({p.x, p.y, p.z}) < 2) continue;  // the plane ends at the walls
      const double off = std::abs(dot(n, p - middle));
      worst = std::max(worst, off);
      exact += off < 1e-14 * 16;
      ++seen;
    }
    EXPECT_GT(seen, 100u);
    EXPECT_LT(worst, 0.02 * std::sqrt(3.0));
    EXPECT_GT(static_cast<double>(exact), (snap ? 0.98 : 0.9) * static_cast<double>(seen)) << exact << " of " << seen;
  }
}

}  // namespace
}  // namespace burnish
